//! Definitions live as long as the program, as those of the catalogue do, so that an entry can be copied freely. Equal
//! definitions share one place, so that a program which reads the same file again and again does not grow.

use super::definition::Definition;
use std::sync::{Mutex, PoisonError};

static KNOWN: Mutex<Vec<&'static Definition>> = Mutex::new(Vec::new());

/// The definition that was interned with this name and table.
pub(super) fn known(is_it: impl Fn(&Definition) -> bool) -> Option<&'static Definition> {
    let known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    known.iter().copied().find(|known| is_it(known))
}

/// Keeps a definition for the life of the program.
pub(super) fn keep(definition: Definition) -> &'static Definition {
    let kept: &'static Definition = Box::leak(Box::new(definition));
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner).push(kept);
    kept
}

/// Keeps a text for the life of the program.
pub(super) fn text(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

/// Keeps a list for the life of the program.
pub(super) fn list<T>(items: Vec<T>) -> &'static [T] {
    Box::leak(items.into_boxed_slice())
}
