//! Work on a thread of its own, without Python's lock, which Ctrl-C ends.
//!
//! The calling thread waits, looks for signals, and reports progress. After Ctrl-C it returns at once; a diagnosis then
//! ends with the fit that is running, other work when it is done.

use crate::errors::OrRaise;
use anyhow::{Result, anyhow};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Time between two looks for signals: too short to be felt.
const LOOK: Duration = Duration::from_millis(40);

/// What is unwound with where work was interrupted.
struct Interrupted;

/// Whether work is to end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stop(pub(crate) Arc<AtomicBool>);

impl Stop {
    /// Ends the calling work if that is asked for. The threads of a computation pass the unwinding on to the one that
    /// began it, which catches it.
    pub(crate) fn here(&self) {
        if self.0.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Interrupted));
        }
    }
}

/// Runs `work`, and calls `look` again and again until it is done. An error of `look`, or a signal, sets `stop`.
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    stop: &Stop,
    mut look: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce() -> Result<T> + Send + 'static,
) -> PyResult<T> {
    let (done, mut result) = channel();
    let pool = pool().or_raise(py)?;
    let run = move || {
        let made = catch_unwind(AssertUnwindSafe(|| pool.install(work)));
        // Nobody waits for work that was interrupted.
        let _ = done.send(made.unwrap_or_else(|_| Err(anyhow!("the computation broke off; please report this"))));
    };
    thread::Builder::new().name("airball".into()).spawn(run).or_raise(py)?;
    loop {
        let (heard, back) = py.detach(move || wait(result));
        match heard {
            Ok(made) => return made.or_raise(py),
            Err(RecvTimeoutError::Disconnected) => return Err(anyhow!("the computation was lost")).or_raise(py),
            Err(RecvTimeoutError::Timeout) => {}
        }
        result = back;
        if let Err(error) = py.check_signals().and_then(|()| look(py)) {
            stop.0.store(true, Ordering::Relaxed);
            return Err(error);
        }
    }
}

type Heard<T> = Result<Result<T>, RecvTimeoutError>;

fn wait<T>(result: Receiver<Result<T>>) -> (Heard<T>, Receiver<Result<T>>) {
    (result.recv_timeout(LOOK), result)
}

/// The threads of the computations. A process that was forked off has none of its parent's, and gets its own.
fn pool() -> Result<Arc<ThreadPool>> {
    static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let own = process::id();
    let mut held = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match held.take() {
        Some((process, pool)) if process == own => Ok(Arc::clone(&held.insert((own, pool)).1)),
        of_parent => {
            // Its threads do not exist here, so it cannot be ended.
            std::mem::forget(of_parent);
            let pool = Arc::new(ThreadPoolBuilder::new().build()?);
            Ok(Arc::clone(&held.insert((own, pool)).1))
        }
    }
}
