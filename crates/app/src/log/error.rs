//! Errors of a log, each with the file, the position and the next step.

use diagnose::RecordingError;
use std::{io, path::PathBuf};

/// The messages of other programs that can be read, and what to do about others.
pub(crate) const READABLE: &str = "read are JSON, and ROS 2 messages in CDR of the standard types of numbers \
    (std_msgs, geometry_msgs, Odometry, JointState, Imu, Range, FluidPressure, Temperature): record such a topic, or \
    export the topic as CSV";

/// Why a log cannot be written or read. Lines count from 1, the header included.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}; check the name and the permissions", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system reported.
        source: io::Error,
    },
    /// A folder.
    #[error("{} is a folder, and no log; name the log in it (of a ROS 2 bag, its .mcap), or diagnose each log in it \
        with `airball diagnose --each {} --out reports`", path.display(), path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
    },
    /// The file cannot be unpacked.
    #[error("cannot unpack {} ({program}): {cause}; copy the file again, or pack it again with \
        `{program}`", path.display())]
    Packed {
        /// The file.
        path: PathBuf,
        /// The program that packs so.
        program: &'static str,
        /// What went wrong.
        cause: String,
    },
    /// The file cannot be created.
    #[error("cannot create the log {}: {source}; check the folder and its permissions", path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// What the system reported.
        source: io::Error,
    },
    /// A log of this name already exists.
    #[error("{} exists already and is kept; choose another name with --log or remove the file", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// Writing failed.
    #[error("writing {} failed after {cycles} cycles: {cause}; what was written before can be read, except perhaps for \
         the last second; check the space on the disk", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Cycles that were written, the last second of them perhaps only in part.
        cycles: u64,
        /// What went wrong.
        cause: String,
    },
    /// The thread that writes could not be started, or ended too early.
    #[error("the thread that writes {} failed: {cause}; fly again, or without --log", path.display())]
    Thread {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        cause: String,
    },
    /// The file is empty.
    #[error("{} is empty; record a flight with `airball simulate` or `airball run`", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// An MCAP file without a readable cycle.
    #[error("{} has no readable message in the channel `cycle`: {cause}; {advice}", path.display())]
    NoCycles {
        /// The file.
        path: PathBuf,
        /// The reason.
        cause: String,
        /// What to do.
        advice: &'static str,
    },
    /// An MCAP file of another program, of which no channel can be read.
    #[error(
        "{} is an MCAP file of another program, and none of its channels can be read: {channels}; {READABLE}",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
        /// The channels, with how they are written.
        channels: String,
    },
    /// The table of an MCAP file of another program is invalid, and some of its channels could not be read.
    #[error("{source}; {unread}")]
    UnreadChannels {
        /// A sentence about these channels.
        unread: String,
        /// What is wrong with the table of the others.
        source: rows::RowsError,
    },
    /// A Parquet file that cannot be read.
    #[error("cannot read {} as Parquet: {cause}; copy it again, or make a CSV of it: in Python, \
        pandas.read_parquet(FILE).to_csv('log.csv', index=False)", path.display())]
    Parquet {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        cause: String,
    },
    /// The rows do not make a recording.
    #[error("{}: {source}", path.display())]
    NotARecording {
        /// The file.
        path: PathBuf,
        /// What is wrong with them.
        source: RecordingError,
    },
    /// The table of a CSV, or `[import]`, is invalid.
    #[error(transparent)]
    Rows(#[from] rows::RowsError),
}
