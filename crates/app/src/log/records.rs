//! The readable records of an MCAP file.
//!
//! ```text
//! file   = magic, record…, magic        record = opcode (1 byte), length (8 bytes, little endian), body
//! chunk  = a record whose body holds compressed records, with a checksum
//! ```
//!
//! A file that was cut short ends within a record. A chunk that does not match its checksum is skipped, and so is a
//! compressed one that was cut and cannot be checked; the chunks after a damaged one are read. Lengths beyond the end
//! of the file are never accepted: the bytes may be arbitrary.
//! Source: the MCAP format specification, <https://mcap.dev/spec>.

use mcap::{
    MAGIC, McapError, McapResult, parse_record,
    records::{Record, op},
    sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

/// Opcode and length in front of every body, bytes.
const FRAME: usize = 9;
/// Largest accepted size of a record in a chunk, and of a chunk, bytes. Ours are a thousandth of it.
const LIMIT: usize = 16 << 20;

/// Content of a zstd chunk of ours at [`SIGN_AT`]: the length of its compression's name, and the name.
const SIGN: &[u8] = b"\x04\0\0\0zstd";
/// Position of it, bytes from the chunk's frame: after start, end, size and checksum.
const SIGN_AT: usize = FRAME + 8 + 8 + 8 + 4;

/// The unreadable parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Damage {
    /// Where the first unreadable record begins, bytes from the start of the file.
    pub(super) at_byte: usize,
    /// What is wrong there.
    pub(super) cause: String,
    /// Unreadable places in all.
    pub(super) records: usize,
    /// One of them held messages, or may have: it was a chunk, or it lay before one. What follows the last chunk is an
    /// index and holds none.
    pub(super) of_messages: bool,
}

/// Passes every schema, channel, message and metadata record to `each`, in the order of the file, and returns the
/// unreadable parts.
///
/// After an unreadable record it continues at the next complete chunk: a damaged length must not affect more than its
/// own record.
pub(super) fn walk(file: &[u8], each: &mut dyn FnMut(Record<'_>)) -> Option<Damage> {
    let mut damage = None;
    let mut at_byte = MAGIC.len();
    loop {
        match one(file, at_byte, each) {
            Ok(Some(length)) => at_byte += length,
            Ok(None) => return damage,
            Err(cause) => {
                let next = next_chunk(file, at_byte + 1);
                note(&mut damage, at_byte, cause, next.is_some() || is_chunk(file.get(at_byte..).unwrap_or_default()));
                let Some(next) = next else { return damage };
                at_byte = next;
            }
        }
    }
}

/// Reads the record at `at_byte`. Returns its length with its frame, or `None` at the end of the file.
fn one(file: &[u8], at_byte: usize, each: &mut dyn FnMut(Record<'_>)) -> Result<Option<usize>, String> {
    let rest = file.get(at_byte..).unwrap_or_default();
    let Some((opcode, body, whole)) = frame(rest) else { return Err("the file ends without a summary".into()) };
    let length = FRAME + body.len();
    if opcode != op::CHUNK && is_chunk(rest) {
        return Err("a chunk has the opcode of another record".into());
    }
    if opcode != op::CHUNK && next_chunk(&rest[..length], 1).is_some() {
        return Err("the length of this record is wrong".into());
    }
    if whole && opcode == op::DATA_END {
        return match (next_chunk(rest, 1), file.ends_with(MAGIC)) {
            (Some(_), _) => Err("the data do not end here".into()),
            (None, true) => Ok(None),
            (None, false) => Err("the summary at the end is incomplete".into()),
        };
    }
    let taken = match opcode {
        op::CHUNK => chunk(&rest[..length], each),
        _ if whole => hand_over(opcode, body, each),
        _ => Ok(()),
    };
    if !whole {
        return Err("the file ends within this record".into());
    }
    taken.map(|()| Some(length)).map_err(|error| error.to_string())
}

/// Whether there is a complete chunk of ours anywhere in the bytes.
pub(super) fn has_chunk(bytes: &[u8]) -> bool {
    next_chunk(bytes, 0).is_some()
}

/// Start of the first complete chunk of ours, at `from` or after it: found by its signature, accepted by its checksum.
fn next_chunk(bytes: &[u8], from: usize) -> Option<usize> {
    let signs = memchr::memmem::find_iter(bytes.get(from..)?, SIGN).map(|at| from + at);
    signs.filter_map(|sign| sign.checked_sub(SIGN_AT)).filter(|at| *at >= from).find(|at| {
        let rest = &bytes[*at..];
        let Some((op::CHUNK, body, true)) = frame(rest) else { return false };
        compressed(&rest[..FRAME + body.len()], &mut |_| {}).is_ok()
    })
}

/// Whether a record is a chunk, by its opcode or by what is in it.
fn is_chunk(record: &[u8]) -> bool {
    record.first() == Some(&op::CHUNK) || record.get(SIGN_AT..).is_some_and(|rest| rest.starts_with(SIGN))
}

fn note(damage: &mut Option<Damage>, at_byte: usize, cause: String, of_messages: bool) {
    let damage = damage.get_or_insert(Damage { at_byte, cause, records: 0, of_messages: false });
    damage.records += 1;
    damage.of_messages |= of_messages;
}

/// The first record of `bytes`: opcode, the available part of its body, and whether it is complete.
fn frame(bytes: &[u8]) -> Option<(u8, &[u8], bool)> {
    let (&opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
    let body = rest.get(..length);
    Some((opcode, body.unwrap_or(rest), body.is_some()))
}

/// Parses only the records of a log: the parser of attachments does not check their lengths.
fn hand_over(opcode: u8, body: &[u8], each: &mut dyn FnMut(Record<'_>)) -> McapResult<()> {
    if matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE | op::METADATA) {
        each(parse_record(opcode, body)?);
    }
    Ok(())
}

/// The records of a chunk, given with its frame; of a chunk that was cut, those before the cut.
fn chunk(framed: &[u8], each: &mut dyn FnMut(Record<'_>)) -> McapResult<()> {
    match stored(&framed[FRAME..])? {
        Some(mut records) => {
            while let Some((opcode, body, true)) = frame(records) {
                hand_over(opcode, body, each)?;
                records = &records[FRAME + body.len()..];
            }
            if records.is_empty() { Ok(()) } else { Err(McapError::UnexpectedEoc) }
        }
        None => compressed(framed, each),
    }
}

/// The records of a chunk without compression; `None` if it has one. Parsed here, because the library's parser needs a
/// complete chunk. A complete one is compared with its checksum, if it has any.
fn stored(body: &[u8]) -> McapResult<Option<&[u8]>> {
    /// Start, end and size, bytes.
    const FIXED: usize = 8 + 8 + 8;
    let parts = || {
        let (saved, rest) = body.get(FIXED..)?.split_first_chunk::<4>()?;
        let (name_length, rest) = rest.split_first_chunk::<4>()?;
        let (length, records) = rest.split_first_chunk()?;
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        (*name_length == [0; 4]).then_some((u32::from_le_bytes(*saved), length, records))
    };
    let Some((saved, length, records)) = parts() else { return Ok(None) };
    let Some(whole) = records.get(..length) else { return Ok(Some(records)) };
    let calculated = crc32fast::hash(whole);
    if saved != 0 && saved != calculated {
        return Err(McapError::BadChunkCrc { saved, calculated });
    }
    Ok(Some(whole))
}

/// Compares the chunk with its checksum before any record of it is passed on.
fn compressed(framed: &[u8], each: &mut dyn FnMut(Record<'_>)) -> McapResult<()> {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(LIMIT);
    let mut reader = LinearReader::new_with_options(options);
    let mut unread = framed;
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(wanted) => {
                let (now, later) = unread.split_at(wanted.min(unread.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                unread = later;
            }
            LinearReadEvent::Record { opcode, data } => hand_over(opcode, data, each)?,
        }
    }
    Ok(())
}
