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

/// In pandas, every reader ends alike.
const FORMATS: [Format; 19] = [
    format(
        b"MATLAB 5.0 MAT-file",
        "a MATLAB file",
        "in MATLAB: writetable(table(t, u, y), 'log.csv') with its variables",
    ),
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
    format(b"{", "JSON", "in Python: pandas.read_json(FILE).to_csv('log.csv', index=False)"),
    format(b"<", "HTML or XML, as pages and SVG pictures are", "ask for the numbers as CSV"),
];

/// Name of the format and advice, of a file that is no table.
pub(crate) fn foreign(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let known = FORMATS.iter().find(|format| bytes.starts_with(format.begins) || text.starts_with(format.begins));
    let of_format = known.map(|format| (format.name, format.advice));
    of_format.or_else(|| is_config(text).then_some(("a config (TOML)", "name the log, and the config with --config")))
}

/// Whether the first line that is not a comment is the head of a table of TOML, or a key with its value.
fn is_config(text: &[u8]) -> bool {
    let mut lines = text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let Some(line) = lines.find(|line| !line.is_empty() && !line.starts_with(b"#")) else { return false };
    let head = line.starts_with(b"[") && line.contains(&b']') && !line.contains(&b',');
    head || line.split(|byte| *byte == b'=').next().is_some_and(|key| {
        key.len() < line.len()
            && key.ends_with(b" ")
            && key.trim_ascii().iter().all(|b| b.is_ascii_alphanumeric() || *b == b'_')
    })
}
