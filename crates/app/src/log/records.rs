//! The records of an MCAP file, as far as they can be had.
//!
//! ```text
//! file   = magic, record…, magic        record = opcode (1 byte), length (8 bytes, little endian), body
//! chunk  = a record whose body holds compressed records, with a checksum
//! ```
//!
//! A file that was cut short ends within a record. A chunk that does not match its checksum is left out, and so is a
//! compressed one that was cut and cannot be checked; the chunks after a damaged one are read. Lengths are never
//! believed beyond the end of the file: any bytes may come in.
//! Source: the MCAP format specification, <https://mcap.dev/spec>.

use mcap::{
    MAGIC, McapError, McapResult, parse_record,
    records::{Record, op},
    sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions},
};

/// Opcode and length in front of every body, bytes.
const FRAME: usize = 9;
/// Largest record in a chunk, and largest chunk, that is believed, bytes. Ours are a thousandth of it.
const LIMIT: usize = 16 << 20;

/// What could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Damage {
    /// Where the first unreadable record begins, bytes from the start of the file.
    pub(super) at_byte: usize,
    /// What is wrong there.
    pub(super) cause: String,
    /// Unreadable records in all.
    pub(super) records: usize,
}

/// Hands every channel, message and metadata record to `each`, in the order of the file, and says what was not readable.
pub(super) fn walk(file: &[u8], each: &mut dyn FnMut(Record<'_>)) -> Option<Damage> {
    let mut damage = None;
    let mut at_byte = MAGIC.len();
    loop {
        let rest = file.get(at_byte..).unwrap_or_default();
        let Some((opcode, body, whole)) = frame(rest) else {
            note(&mut damage, at_byte, "the file ends without a summary".into());
            return damage;
        };
        if whole && opcode == op::DATA_END {
            if !file.ends_with(MAGIC) {
                note(&mut damage, at_byte, "the summary at the end is incomplete".into());
            }
            return damage;
        }
        let taken = match opcode {
            op::CHUNK => chunk(&rest[..FRAME + body.len()], each),
            _ if whole => hand_over(opcode, body, each),
            _ => Ok(()),
        };
        if !whole {
            note(&mut damage, at_byte, "the file ends within this record".into());
            return damage;
        }
        if let Err(error) = taken {
            note(&mut damage, at_byte, error.to_string());
        }
        at_byte += FRAME + body.len();
    }
}

fn note(damage: &mut Option<Damage>, at_byte: usize, cause: String) {
    damage.get_or_insert(Damage { at_byte, cause, records: 0 }).records += 1;
}

/// The first record of `bytes`: opcode, as much of its body as there is, and whether that is all.
fn frame(bytes: &[u8]) -> Option<(u8, &[u8], bool)> {
    let (&opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
    let body = rest.get(..length);
    Some((opcode, body.unwrap_or(rest), body.is_some()))
}

/// Parses what a log is made of, and nothing else: the parser of attachments trusts their lengths.
fn hand_over(opcode: u8, body: &[u8], each: &mut dyn FnMut(Record<'_>)) -> McapResult<()> {
    if matches!(opcode, op::CHANNEL | op::MESSAGE | op::METADATA) {
        each(parse_record(opcode, body)?);
    }
    Ok(())
}

/// The records of a chunk, given with its frame; of a chunk that was cut, those that are stored before the cut.
fn chunk(framed: &[u8], each: &mut dyn FnMut(Record<'_>)) -> McapResult<()> {
    match stored(&framed[FRAME..]) {
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

/// The records of a chunk without compression; `None` if it has one. Found by hand, because the parser insists on a
/// whole chunk.
fn stored(body: &[u8]) -> Option<&[u8]> {
    /// Start, end, size and checksum, bytes.
    const FIXED: usize = 8 + 8 + 8 + 4;
    let (name_length, rest) = body.get(FIXED..)?.split_first_chunk::<4>()?;
    let (length, records) = rest.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
    (*name_length == [0; 4]).then(|| records.get(..length).unwrap_or(records))
}

/// Compares the chunk with its checksum before anything of it is handed over.
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
