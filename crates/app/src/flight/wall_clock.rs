//! The wall clock in words. The loop never reads it.

use std::time::{SystemTime, UNIX_EPOCH};

/// A time in UTC, to the millisecond, as RFC 3339 writes it. Times before 1970 become 1970.
#[must_use]
pub fn rfc3339(moment: SystemTime) -> String {
    humantime::format_rfc3339_millis(moment.max(UNIX_EPOCH)).to_string()
}
