//! A lock of what stays whole if a thread panics while it holds it: the lock goes on.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// The content, once no other thread holds it.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
