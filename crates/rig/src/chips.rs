//! The rig through its chips: the range sensor at the top of the pipe and the fan's PWM driver, and optionally a second
//! range sensor, the fan's tachometer and the driver's output-enable.

use super::error::StartError;
use super::lines::{Lines, Pin};
use super::range::{BEYOND_PIPE_MM, START_ALLOWED_S, kind};
use super::second::{Apart, Second};
use super::shared_setpoint::SharedSetpoint;
use super::{Rig, Sighting};
use control::{Duty, Millimetres};
use embedded_hal::i2c::{Error, ErrorKind, I2c};
use hal::{Clock, Edges, Fan, FanError, Range, RangeSensor, Tachometer};

/// How long a reading may take, seconds: ten times the sensor's period.
const READING_ALLOWED_S: f64 = 0.2;

/// A handle of the bus for each chip, and the GPIO lines.
pub struct Wiring<S, P> {
    /// For the range sensor.
    pub sensor: S,
    /// For the second one, where the rig has it.
    pub second: Option<S>,
    /// For the fan driver.
    pub fan: P,
    /// The lines of the rig's tables.
    pub lines: Lines,
}

/// The chips, each on its own handle of a bus, and a clock.
pub struct Chips<S: I2c, P: I2c, C: Clock> {
    sensor: RangeSensor<S, C>,
    second: Option<Second<S, C>>,
    tachometer: Option<Tachometer<Box<dyn Edges>>>,
    fan: Fan<P>,
    output_enable: Option<Pin>,
    /// Whether the driver's outputs are on.
    outputs_on: bool,
    clock: C,
    sensor_to_bottom_mm: f64,
    sensor_scale: f64,
    /// The setpoint for an emulated world.
    setpoint: SharedSetpoint,
}

impl<S: I2c, P: I2c, C: Clock + Clone> Chips<S, P, C> {
    /// Turns the fan off and starts the sensors.
    ///
    /// # Errors
    /// [`StartError`] names the chip and what is wrong with it; the fan is off.
    pub fn start(wiring: Wiring<S, P>, clock: C, rig: &config::Rig) -> Result<Self, StartError<S::Error, P::Error>> {
        let Wiring { sensor, second, fan, lines: Lines { edges, xshut, output_enable } } = wiring;
        let fan = Fan::start(fan, rig.fan_pwm_hz).map_err(StartError::Fan)?;
        let apart = match (rig.second_sensor, second, xshut) {
            (Some(table), Some(bus), Some(xshut)) => {
                Some(Apart::of(bus, table, xshut, &clock).map_err(StartError::Separate)?)
            }
            _ => None,
        };
        let mut sensor = RangeSensor::prepare(sensor, clock.clone(), START_ALLOWED_S).map_err(StartError::Sensor)?;
        let second = apart.map(|apart| apart.start(clock.clone(), rig.sensor_to_bottom_mm));
        let second = second.transpose().map_err(StartError::Second)?;
        // Just after the second, so that both measure the ball at about the same time.
        sensor.range(START_ALLOWED_S).map_err(StartError::Sensor)?;
        let pulses = rig.tachometer.map_or(1, |tachometer| tachometer.pulses_per_revolution);
        Ok(Self {
            sensor,
            second,
            tachometer: edges.map(|edges| Tachometer::new(edges, pulses)),
            fan,
            output_enable,
            outputs_on: false,
            clock,
            sensor_to_bottom_mm: rig.sensor_to_bottom_mm,
            sensor_scale: rig.sensor_scale,
            setpoint: SharedSetpoint::default(),
        })
    }

    /// The same chips, which share the setpoint with an emulated world.
    pub(super) fn with_setpoint(mut self, setpoint: SharedSetpoint) -> Self {
        self.setpoint = setpoint;
        self
    }

    /// The PWM frequency in force, hertz; the chip has an upper limit of 1526 Hz.
    #[must_use]
    pub fn fan_pwm_hz(&self) -> f64 {
        self.fan.frequency_hz()
    }
}

impl<S: I2c, P: I2c, C: Clock + Clone> Rig for Chips<S, P, C> {
    fn now_s(&self) -> f64 {
        self.clock.now_s()
    }

    fn sleep_until_s(&self, t_s: f64) {
        self.clock.sleep_until_s(t_s);
    }

    fn align(&mut self) -> Result<(), ErrorKind> {
        self.sensor.wait(READING_ALLOWED_S).map(drop).map_err(kind)
    }

    fn position(&mut self) -> Result<Sighting, ErrorKind> {
        let range = self.sensor.poll().map_err(kind)?;
        Ok(match range {
            None => Sighting::NotReady,
            Some(Range::NoTarget { reported_mm }) => Sighting::NoBall { reported_mm },
            Some(Range::Doubtful { status, reported_mm }) => Sighting::Doubtful { status, reported_mm },
            Some(Range::Distance(Millimetres(reported))) => {
                let distance = self.sensor_scale * reported;
                if distance > self.sensor_to_bottom_mm + BEYOND_PIPE_MM {
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it came from a u16")]
                    Sighting::NoBall { reported_mm: reported as u16 }
                } else {
                    Sighting::Ball(Millimetres(self.sensor_to_bottom_mm - distance))
                }
            }
        })
    }

    fn fan_rpm(&mut self) -> Option<f64> {
        let now_s = self.clock.now_s();
        self.tachometer.as_mut().map(|tachometer| tachometer.rpm(now_s))
    }

    fn second_position(&mut self) -> Option<Result<Sighting, ErrorKind>> {
        self.second.as_mut().map(Second::position)
    }

    fn set_setpoint(&mut self, setpoint_mm: Option<f64>) {
        self.setpoint.set(setpoint_mm);
    }

    fn drive(&mut self, duty: Duty) -> Result<Duty, ErrorKind> {
        if duty == Duty::OFF {
            self.disable_outputs();
        }
        let held = self.fan.drive(duty).map_err(|error| match error {
            FanError::Bus(error) => error.kind(),
            _ => ErrorKind::Other,
        })?;
        if held != Duty::OFF {
            self.enable_outputs()?;
        }
        Ok(held)
    }
}

impl<S: I2c, P: I2c, C: Clock> Chips<S, P, C> {
    fn enable_outputs(&mut self) -> Result<(), ErrorKind> {
        if let Some(pin) = self.output_enable.as_mut().filter(|_| !self.outputs_on) {
            pin.set_low().map_err(|_| ErrorKind::Other)?;
            self.outputs_on = true;
        }
        Ok(())
    }

    /// Needs no bus, so it comes first. If the line fails, the fan is turned off over the bus.
    fn disable_outputs(&mut self) {
        if let Some(pin) = &mut self.output_enable {
            let _ = pin.set_high();
            self.outputs_on = false;
        }
    }
}

/// The chip keeps its last duty when the program ends: the fan is turned off here at every end of a flight, a panic
/// included.
impl<S: I2c, P: I2c, C: Clock> Drop for Chips<S, P, C> {
    fn drop(&mut self) {
        self.disable_outputs();
        // A failure here cannot be reported; the flight has already tried and reported.
        let _ = self.fan.off();
    }
}
