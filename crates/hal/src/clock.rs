//! Time as the chips see it: seconds that only grow.
//!
//! The clocks themselves (the kernel's and the simulator's) live in the app. A driver that waits must wait on
//! the same clock as the loop, or a simulated second would last a real one.

/// Seconds that only grow, and a way to wait for one of them.
pub trait Clock {
    /// Seconds since some fixed start; never goes back.
    fn now_s(&self) -> f64;

    /// Returns at or after `t_s`.
    fn sleep_until_s(&self, t_s: f64);
}

impl<C: Clock + ?Sized> Clock for &C {
    fn now_s(&self) -> f64 {
        (**self).now_s()
    }

    fn sleep_until_s(&self, t_s: f64) {
        (**self).sleep_until_s(t_s);
    }
}
