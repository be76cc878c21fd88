//! The rig through its two chips: the range sensor at the top of the pipe and the fan's PWM driver.

use super::{Rig, Sighting};
use control::{Duty, Millimetres};
use embedded_hal::i2c::{Error, ErrorKind, I2c};
use hal::{Clock, Fan, FanError, Range, RangeError, RangeSensor};

/// How long the sensor may take to start, seconds: its driver needs 0.1 s at 100 kHz.
const START_ALLOWED_S: f64 = 2.0;
/// How long a reading may take, seconds: ten times the sensor's period.
const READING_ALLOWED_S: f64 = 0.2;
/// How far beyond the pipe a reading may lie before it is no ball, mm: twelve times the sensor's noise.
const BEYOND_PIPE_MM: f64 = 30.0;

/// Both chips, each on its own handle of a bus, and a clock.
pub struct Chips<S: I2c, P: I2c, C: Clock> {
    sensor: RangeSensor<S, C>,
    fan: Fan<P>,
    clock: C,
    sensor_to_bottom_mm: f64,
    sensor_scale: f64,
}

/// Why a rig does not start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StartError<S, P> {
    /// The range sensor.
    #[error(transparent)]
    Sensor(RangeError<S>),
    /// The fan driver.
    #[error(transparent)]
    Fan(FanError<P>),
}

impl<S: I2c, P: I2c, C: Clock + Clone> Chips<S, P, C> {
    /// Turns the fan off and starts the sensor.
    ///
    /// # Errors
    /// [`StartError`] names the chip and what is wrong with it; the fan is off.
    pub fn start(
        (sensor_bus, fan_bus): (S, P),
        clock: C,
        sensor_to_bottom_mm: f64,
        fan_pwm_hz: f64,
    ) -> Result<Self, StartError<S::Error, P::Error>> {
        let fan = Fan::start(fan_bus, fan_pwm_hz).map_err(StartError::Fan)?;
        let sensor = RangeSensor::start(sensor_bus, clock.clone(), START_ALLOWED_S).map_err(StartError::Sensor)?;
        Ok(Self { sensor, fan, clock, sensor_to_bottom_mm, sensor_scale: 1.0 })
    }

    /// The same with the sensor's distances multiplied by what a calibration found.
    #[must_use]
    pub fn scaled(mut self, sensor_scale: f64) -> Self {
        self.sensor_scale = sensor_scale;
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

    fn drive(&mut self, duty: Duty) -> Result<Duty, ErrorKind> {
        self.fan.drive(duty).map_err(|error| match error {
            FanError::Bus(error) => error.kind(),
            _ => ErrorKind::Other,
        })
    }
}

fn kind<E: Error>(error: RangeError<E>) -> ErrorKind {
    match error {
        RangeError::Bus(error) => error.kind(),
        _ => ErrorKind::Other,
    }
}

/// The chip keeps its last duty when the program ends: whatever way a flight ends, a panic included, the fan
/// is turned off here.
impl<S: I2c, P: I2c, C: Clock> Drop for Chips<S, P, C> {
    fn drop(&mut self) {
        // Nobody is left to tell of a failure; the flight has already tried and reported.
        let _ = self.fan.off();
    }
}
