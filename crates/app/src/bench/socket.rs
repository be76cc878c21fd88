//! An emulated bus that several processes share: I2C transactions over a Unix socket.
//!
//! ```text
//! request   address, n, then n operations: 0 length bytes… (write) or 1 length (read)     length: 2 bytes, low first
//! answer    0 and all bytes read, or the number of an error
//! ```
//!
//! When a program is killed, a bus within it is lost; this one remains, with the chips in the state that the program
//! left. So the behaviour after `kill -9` is tested with the same binary that flies a rig.

use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

/// Timeout of an answer: the kernel's drivers give up on a bus after a second as well.
const PATIENCE: Duration = Duration::from_secs(1);
const WRITE: u8 = 0;
const READ: u8 = 1;
const DONE: u8 = 0;
/// Errors by their number on the wire, from 1.
const ERRORS: [ErrorKind; 7] = [
    ErrorKind::Other,
    ErrorKind::Bus,
    ErrorKind::ArbitrationLoss,
    ErrorKind::Overrun,
    ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
    ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data),
    ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown),
];

/// A handle of a bus behind a socket.
pub struct SocketBus {
    stream: UnixStream,
    /// The latest request, kept as a buffer: a cycle must not allocate.
    request: Vec<u8>,
}

impl SocketBus {
    /// Connects to the bus that is served at `path`.
    ///
    /// # Errors
    /// What the system reported; mostly that no process serves there.
    pub fn open(path: &Path) -> io::Result<Self> {
        let stream = UnixStream::connect(path)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        Ok(Self { stream, request: Vec::new() })
    }

    fn exchange(&mut self, address: u8, operations: &mut [Operation<'_>]) -> io::Result<u8> {
        write_request(&mut self.request, address, operations)?;
        self.stream.write_all(&self.request)?;
        let answer = take::<1>(&mut self.stream)?[0];
        if answer == DONE {
            for operation in operations {
                if let Operation::Read(bytes) = operation {
                    self.stream.read_exact(bytes)?;
                }
            }
        }
        Ok(answer)
    }
}

impl ErrorType for SocketBus {
    type Error = ErrorKind;
}

impl I2c for SocketBus {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        match self.exchange(address, operations) {
            Ok(DONE) => Ok(()),
            Ok(number) => Err(ERRORS.get(usize::from(number) - 1).copied().unwrap_or(ErrorKind::Other)),
            Err(_) => {
                // A late answer would be taken for that of the next request.
                let _ = self.stream.shutdown(std::net::Shutdown::Both);
                Err(ErrorKind::Bus)
            }
        }
    }
}

/// Answers the requests of one handle from `bus`, calling `after` each, until the handle is closed.
///
/// # Errors
/// What the system reported, or that the other side breaks the protocol.
pub fn serve<I: I2c<Error = ErrorKind>>(mut stream: UnixStream, mut bus: I, after: impl Fn()) -> io::Result<()> {
    loop {
        let mut address = [0];
        if stream.read(&mut address)? == 0 {
            return Ok(());
        }
        let mut operations = read_operations(&mut stream)?;
        let mut borrowed: Vec<Operation<'_>> = operations
            .iter_mut()
            .map(|(direction, bytes)| match *direction {
                READ => Operation::Read(bytes),
                _ => Operation::Write(bytes),
            })
            .collect();
        let result = bus.transaction(address[0], &mut borrowed);
        after();
        let answer = match result {
            Ok(()) => {
                let read = operations.into_iter().filter(|(direction, _)| *direction == READ);
                [DONE].into_iter().chain(read.flat_map(|(_, bytes)| bytes)).collect()
            }
            Err(error) => vec![number(error)],
        };
        stream.write_all(&answer)?;
    }
}

fn number(error: ErrorKind) -> u8 {
    ERRORS.iter().zip(1..).find(|(known, _)| **known == error).map_or(1, |(_, number)| number)
}

fn write_request(request: &mut Vec<u8>, address: u8, operations: &[Operation<'_>]) -> io::Result<()> {
    let too_long = |_| io::Error::from(io::ErrorKind::InvalidInput);
    request.clear();
    request.extend([address, u8::try_from(operations.len()).map_err(too_long)?]);
    for operation in operations {
        let (direction, length) = match operation {
            Operation::Write(bytes) => (WRITE, bytes.len()),
            Operation::Read(bytes) => (READ, bytes.len()),
        };
        request.push(direction);
        request.extend(u16::try_from(length).map_err(too_long)?.to_le_bytes());
        if let Operation::Write(bytes) = operation {
            request.extend(*bytes);
        }
    }
    Ok(())
}

fn read_operations(from: &mut impl Read) -> io::Result<Vec<(u8, Vec<u8>)>> {
    let [count] = take(from)?;
    (0..count)
        .map(|_| {
            let [direction, low, high] = take(from)?;
            let mut bytes = vec![0; usize::from(u16::from_le_bytes([low, high]))];
            match direction {
                WRITE => from.read_exact(&mut bytes)?,
                READ => {}
                _ => return Err(io::ErrorKind::InvalidData.into()),
            }
            Ok((direction, bytes))
        })
        .collect()
}

fn take<const N: usize>(from: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    from.read_exact(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::{ERRORS, SocketBus, number, serve};
    use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, Operation};
    use std::os::unix::net::UnixStream;

    /// Answers each read with the byte written before it plus one, and address 0x77 with an error.
    struct Echo;

    impl ErrorType for Echo {
        type Error = ErrorKind;
    }

    impl I2c for Echo {
        fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
            let mut last = 0;
            for operation in operations {
                match operation {
                    Operation::Write(bytes) => last = *bytes.last().unwrap(),
                    Operation::Read(bytes) => bytes.fill(last + 1),
                }
            }
            if address == 0x77 { Err(ErrorKind::ArbitrationLoss) } else { Ok(()) }
        }
    }

    #[test]
    fn transactions_and_their_errors_cross_the_socket() {
        let (near, far) = UnixStream::pair().unwrap();
        let served = std::thread::spawn(move || serve(far, Echo, || {}));
        let mut bus = SocketBus { stream: near, request: Vec::new() };
        let mut read = [0; 3];
        bus.write_read(0x29, &[1, 2, 7], &mut read).unwrap();
        assert_eq!(read, [8; 3]);
        assert_eq!(bus.write(0x77, &[1]), Err(ErrorKind::ArbitrationLoss));
        bus.write(0x29, &[1]).unwrap();
        drop(bus);
        served.join().unwrap().unwrap();
    }

    #[test]
    fn every_error_has_a_number_of_its_own() {
        for (error, expected) in ERRORS.into_iter().zip(1..) {
            assert_eq!(number(error), expected);
        }
    }

    #[test]
    fn a_bus_that_is_gone_is_an_error_and_no_panic() {
        let (near, far) = UnixStream::pair().unwrap();
        drop(far);
        let mut bus = SocketBus { stream: near, request: Vec::new() };
        assert_eq!(bus.write(0x29, &[1]), Err(ErrorKind::Bus));
        assert_eq!(bus.write(0x29, &[1]), Err(ErrorKind::Bus));
    }
}
