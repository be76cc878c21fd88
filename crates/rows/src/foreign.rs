//! Files that are no table of text, recognised by their first bytes, each with the way to one.

/// A known format: how it begins, what it is called, and how to make a CSV of it.
struct Format {
    begins: &'static [u8],
    name: &'static str,
    advice: &'static str,
}

const fn format(begins: &'static [u8], name: &'static str, advice: &'static str) -> Format {
    Format { begins, name, advice }
}

const MATLAB: Format = format(
    b"MATLAB 5.0 MAT-file",
    "a MATLAB file",
    "in MATLAB: writetable(table(t, u, y), 'log.csv') with its variables",
);
const JSON: Format = format(
    b"{",
    "JSON",
    "in Python: pandas.read_json(FILE).to_csv('log.csv', index=False), with lines=True if each line is an object",
);

/// In pandas, every reader ends alike.
const FORMATS: [Format; 19] = [
    MATLAB,
    format(
        b"\x89HDF\r\n\x1a\n",
        "an HDF5 file, as MATLAB 7.3 and h5py write",
        "in MATLAB: writetable(table(t, u, y), 'log.csv'); in Python: pandas.DataFrame of its data sets, then \
         .to_csv('log.csv', index=False)",
    ),
    format(
        b"PK\x03\x04",
        "a zip archive: an Excel workbook (.xlsx), or numpy's .npz",
        "save the sheet as CSV, or unpack it",
    ),
    format(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an old Excel workbook (.xls)", "save the sheet as CSV"),
    format(b"PAR1", "a Parquet file", "in Python: pandas.read_parquet(FILE).to_csv('log.csv', index=False)"),
    format(b"ARROW1", "an Arrow file (Feather)", "in Python: pandas.read_feather(FILE).to_csv('log.csv', index=False)"),
    format(
        b"\x93NUMPY",
        "a numpy array",
        "in Python: numpy.savetxt('log.csv', numpy.load(FILE), delimiter=',', header='t,u,y')",
    ),
    format(b"\x80\x04", "a Python pickle", "in Python: pandas.read_pickle(FILE).to_csv('log.csv', index=False)"),
    format(b"\x80\x05", "a Python pickle", "in Python: pandas.read_pickle(FILE).to_csv('log.csv', index=False)"),
    format(b"#ROSBAG V", "a ROS 1 bag", "rostopic echo -b FILE -p /TOPIC > log.csv"),
    format(
        b"SQLite format 3\0",
        "an SQLite data base, as ROS 2 bags (.db3) are",
        "ros2 bag convert to MCAP, and export its topic as CSV",
    ),
    format(b"ULog\x01\x12\x35", "a ULog of PX4", "ulog2csv FILE (of pyulog) writes a CSV for each topic"),
    format(b"TDSm", "a TDMS file of LabVIEW", "in Python: nptdms.TdmsFile(FILE).as_dataframe().to_csv('log.csv')"),
    format(b"%PDF", "a PDF", "ask for the numbers as CSV"),
    format(b"\x89PNG", "a picture (PNG)", "ask for the numbers as CSV"),
    format(b"BZh", "a file packed with bzip2", "unpack it: bunzip2 FILE"),
    format(b"\xfd7zXZ\0", "a file packed with xz", "unpack it: unxz FILE"),
    JSON,
    format(b"<", "HTML or XML, as pages and SVG pictures are", "ask for the numbers as CSV"),
];

/// Name of the format and advice, of a file that is no table.
pub(crate) fn foreign(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let known = FORMATS.iter().find(|format| bytes.starts_with(format.begins) || text.starts_with(format.begins));
    let known =
        known.or_else(|| is_json_array(text).then_some(&JSON)).or_else(|| is_matlab_4(bytes).then_some(&MATLAB));
    let of_format = known.map(|format| (format.name, format.advice));
    of_format.or_else(|| is_config(text).then_some(("a config (TOML)", "name the log, and the config with --config")))
}

/// Whether the text is an array of JSON: `[` before an object, or before numbers or text, at one level or at two. A
/// table of TOML has a name there.
fn is_json_array(text: &[u8]) -> bool {
    let Some(inner) = text.strip_prefix(b"[").map(<[u8]>::trim_ascii_start) else { return false };
    let second = inner.strip_prefix(b"[").map_or(inner, <[u8]>::trim_ascii_start);
    inner.starts_with(b"{") || second.first().is_some_and(|byte| byte.is_ascii_digit() || matches!(byte, b'-' | b'"'))
}

/// Whether the bytes begin as a matrix of MATLAB's format 4, which has no mark of its own: five numbers of four bytes,
/// then the name, ended by a 0. The numbers are a code of four digits whose hundreds are 0, rows, columns, whether it
/// is complex, and the length of the name.
fn is_matlab_4(bytes: &[u8]) -> bool {
    let number = |at: usize| bytes.get(4 * at..4 * at + 4)?.try_into().map(u32::from_le_bytes).ok();
    let big_endian = number(0).is_some_and(|code| code > 0xffff);
    let number = |at: usize| number(at).map(|value| if big_endian { value.swap_bytes() } else { value });
    let (Some(code), Some(complex), Some(length)) = (number(0), number(3), number(4)) else { return false };
    let digits = [code / 1000 % 10, code / 100 % 10, code / 10 % 10, code % 10];
    let is_code = code < 5000 && digits[1] == 0 && digits[2] <= 5 && digits[3] <= 2;
    let name = (2..=64).contains(&length).then(|| bytes.get(20..20 + length as usize)).flatten();
    let is_name = |name: &[u8]| {
        let (end, letters) = name.split_last().unwrap_or((&1, &[]));
        *end == 0 && letters.iter().all(|byte| byte.is_ascii_alphanumeric() || *byte == b'_')
    };
    is_code && complex <= 1 && name.is_some_and(is_name)
}

/// Whether the first line that is not a comment is the head of a table of TOML, or a key with its value before another
/// such line: instruments write one key above their tables.
fn is_config(text: &[u8]) -> bool {
    let lines = text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let mut lines = lines.filter(|line| !line.is_empty() && !line.starts_with(b"#"));
    let Some(first) = lines.next() else { return false };
    is_head(first) || is_key(first) && lines.next().is_none_or(|next| is_head(next) || is_key(next))
}

fn is_head(line: &[u8]) -> bool {
    line.starts_with(b"[") && line.contains(&b']') && !line.contains(&b',')
}

fn is_key(line: &[u8]) -> bool {
    line.split(|byte| *byte == b'=').next().is_some_and(|key| {
        key.len() < line.len()
            && key.ends_with(b" ")
            && key.trim_ascii().iter().all(|b| b.is_ascii_alphanumeric() || *b == b'_')
    })
}
