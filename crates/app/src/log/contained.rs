//! Calls of a library that may panic on a damaged file: the panic becomes an answer, and nothing is printed.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether a panic of this thread is expected and stays unprinted.
    static CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// What `call` returns; `None` if it panics. What it borrows must not be used after a panic.
pub(super) fn contained<T>(call: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let print = take_hook();
        set_hook(Box::new(move |info| {
            if !CONTAINED.get() {
                print(info);
            }
        }));
    });
    CONTAINED.set(true);
    let answer = catch_unwind(AssertUnwindSafe(call)).ok();
    CONTAINED.set(false);
    answer
}

#[cfg(test)]
mod tests {
    use super::contained;

    #[test]
    fn a_panic_is_an_answer_and_the_next_call_goes_on() {
        assert_eq!(contained(|| [1, 2].iter().sum::<i32>()), Some(3));
        assert_eq!(contained(|| "1x".parse::<i32>().unwrap()), None);
        assert_eq!(contained(|| 4), Some(4));
    }
}
