//! What the emulated chips are wired to: time, the beams of the sensors, supply and tachometer of the fan.

/// The physics around the chips. The simulator implements it.
pub trait World: Send {
    /// Seconds since some fixed start; never goes back.
    fn now_s(&self) -> f64;

    /// The wire was busy for so long. A virtual world moves its clock; one in real time may ignore it.
    fn elapse_s(&mut self, seconds: f64);

    /// Distance from the sensor to the target at `at_s`, in millimetres; `None` when there is no target.
    ///
    /// Asked exactly once per measurement, in the order of time, never about the future.
    fn measure_mm(&mut self, at_s: f64) -> Option<f64>;

    /// The same of the second sensor, its distance to the same target. The sensors together are asked in the order of
    /// time.
    fn measure_second_mm(&mut self, at_s: f64) -> Option<f64> {
        let _ = at_s;
        None
    }

    /// When the next edge of the fan's tachometer came, up to now, that was not asked for yet.
    fn edge_s(&mut self) -> Option<f64> {
        None
    }

    /// The fan's PWM is on for this fraction of the time, 0 to 1, from now on. Told only when it changes.
    fn pwm(&mut self, fraction: f64);
}

/// The requests of the bus to a chip: one call per byte on the wire.
pub(super) trait Chip: Send {
    /// Where it answers; `None` while it is held in reset.
    fn address(&self) -> Option<u8>;

    /// The level of its one input pin that is wired: XSHUT, or output-enable.
    fn pin(&mut self, high: bool, world: &mut dyn World);

    /// Its supply was gone for a moment; what its pin is wired to was not.
    fn power_cycle(&mut self);

    /// From now on every distance it measures comes with this range status; `None`: with the one that belongs to it.
    fn doubt(&mut self, status: Option<u8>) {
        let _ = status;
    }

    /// When the measurement that runs will end.
    fn ends_s(&self) -> Option<f64> {
        None
    }

    /// Ends it.
    fn end_one(&mut self, world: &mut dyn World) {
        let _ = world;
    }

    /// The chip is addressed. `false` is "no acknowledge".
    fn begin(&mut self, world: &mut dyn World) -> bool;

    /// First byte written: the index of a register.
    fn select(&mut self, index: u8);

    /// A byte written to the register at the index.
    fn put(&mut self, byte: u8, world: &mut dyn World);

    /// A byte read from the register at the index.
    fn get(&mut self) -> u8;

    /// The stop condition.
    fn end(&mut self, world: &mut dyn World);
}
