//! The fan driver's output-enable.

use super::bench;
use crate::fan::Fan;
use control::Duty;
use embedded_hal::digital::OutputPin;

#[test]
fn output_enable_stops_the_fan_whatever_the_chip_holds_and_a_line_that_is_given_back_does_too() {
    let (bus, _) = bench();
    let mut enable = bus.output_enable();
    let mut fan = Fan::start(bus.handle(), 1526.0).unwrap();
    fan.drive(Duty::clamped(25.0)).unwrap();
    let given = || bus.with_world(|world| world.pwm.last().copied());
    assert_eq!(given(), None, "the outputs are off");
    enable.set_low().unwrap();
    assert_eq!(given(), Some(0.25));
    enable.set_high().unwrap();
    assert_eq!(given(), Some(0.0));
    enable.set_low().unwrap();
    drop(enable);
    assert_eq!(given(), Some(0.0));
}
