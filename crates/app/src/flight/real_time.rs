//! Real time, where the system permits it: a first-in-first-out priority for the loop's thread, and locked memory.
//!
//! Neither is requested where it is permitted only up to a limit: memory that can be locked only in part would fail
//! later, in flight. The flight continues without it, and a message names the missing permission.

use nix::sys::mman::{MlockAllFlags, mlockall};
use nix::sys::resource::{RLIM_INFINITY, Resource, getrlimit};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// Priority of the loop: above everything that is not real time, not above the kernel's own threads for interrupts
/// (50).
const LOOP: u8 = 45;
/// Priority of the guard: above a loop that hangs.
const GUARD: u8 = 46;

/// For the calling thread as the loop. Returns in words what was not permitted; nothing where all was.
///
/// Raises the calling thread only. Threads that it starts later would inherit the priority: start them before.
#[must_use]
pub fn of_the_loop() -> Vec<String> {
    [raise(LOOP).err(), lock_memory().err()].into_iter().flatten().collect()
}

/// For the calling thread as the guard. Where it is not permitted, the guard is later by milliseconds only.
pub fn of_the_guard() {
    let _ = raise(GUARD);
}

fn raise(priority: u8) -> Result<(), String> {
    let refused = |why: String| {
        format!(
            "no real-time priority {priority} ({why}): cycles may begin late under load; run as the service, or permit it \
             with LimitRTPRIO, `ulimit -r` or CAP_SYS_NICE"
        )
    };
    let value = ThreadPriorityValue::try_from(priority).map_err(refused)?;
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Crossplatform(value), policy)
        .map_err(|why| refused(why.to_string()))
}

fn lock_memory() -> Result<(), String> {
    let refused = |why: String| {
        format!("memory is not locked ({why}): a page that was put out may delay a cycle; permit it with LimitMEMLOCK")
    };
    let (limit, _) = getrlimit(Resource::RLIMIT_MEMLOCK).map_err(|error| refused(error.to_string()))?;
    if limit != RLIM_INFINITY {
        return Err(refused(format!("only {} KiB are permitted", limit / 1024)));
    }
    mlockall(MlockAllFlags::MCL_CURRENT | MlockAllFlags::MCL_FUTURE).map_err(|error| refused(error.to_string()))
}
