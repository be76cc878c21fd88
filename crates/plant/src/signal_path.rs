//! The effects that are on, combined place by place along the signal path. Nothing here depends on a single effect.

mod delays;

use crate::acts::{Acts, Conditions, Readings};
use crate::effect::{Effect, Stage};
use crate::effects::{Effects, EndStop, SensorOutliers, StaleSamples, Turbulence, WallFriction, for_each_effect};
use crate::motion::OWN_STATES;
use control::design::Linear;

/// What the type of an effect does. A constant, so that a place where it does nothing costs nothing.
#[inline(always)]
const fn acts<E: Effect>(_: &E) -> Acts<E> {
    E::ACTS
}

const fn stage<E: Effect>(_: &E) -> Stage {
    E::ENTRY.stage
}

/// Folds the functions of one place over the effects that are on.
macro_rules! fold {
    ($effects:expr, $place:ident, $start:expr, |$sum:ident, $act:ident, $effect:ident| $next:expr) => {{
        let mut $sum = $start;
        for_each_effect!($effects, $effect => if let Some($act) = acts($effect).$place { $sum = $next });
        $sum
    }};
}

/// What fills a slot: the first effect that is on and does.
macro_rules! slot {
    ($effects:expr, $place:ident, |$act:ident, $effect:ident| $value:expr) => {{
        for_each_effect!($effects, $effect => if let Some($act) = acts($effect).$place { return Some($value) });
        None
    }};
}

/// Whether an effect that is on acts at a place.
macro_rules! any {
    ($effects:expr, $place:ident) => {
        fold!($effects, $place, false, |_sum, _act, _effect| true)
    };
}

mod actuator;

const fn name<E: Effect>(_: &E) -> &'static str {
    E::ENTRY.name
}

/// Air and ball.
impl Effects {
    /// The acceleration, mm/s², of a ball that is `acceleration` without these effects.
    #[inline(always)]
    pub(crate) fn accelerated(&self, acceleration: f64, conditions: &Conditions) -> f64 {
        self.accelerated_by_catalogue(acceleration, conditions) + self.written.force(conditions)
    }

    /// The same without the effects that users write: what acts on the ball, then the air.
    #[inline(always)]
    pub(crate) fn accelerated_by_catalogue(&self, acceleration: f64, conditions: &Conditions) -> f64 {
        let friction = self.smooth_friction();
        let friction = friction.map_or(0.0, |friction| friction.smooth(conditions.velocity_mm_per_s));
        let sum = fold!(self, force, acceleration + friction, |sum, act, effect| {
            if matches!(stage(effect), Stage::Air) { sum } else { sum + act(effect, conditions) }
        });
        fold!(self, force, sum, |sum, act, effect| {
            if matches!(stage(effect), Stage::Air) { sum + act(effect, conditions) } else { sum }
        })
    }

    /// The derivatives of the part of it by the effects of the catalogue, by position, velocity and the fan's
    /// acceleration.
    #[inline(always)]
    pub(crate) fn built_in_slopes(&self, conditions: &Conditions) -> [f64; 3] {
        let friction = self.smooth_friction();
        let slope = friction.map_or(0.0, |friction| friction.smooth_slope_per_s(conditions.velocity_mm_per_s));
        fold!(self, force, [0.0, slope, 0.0], |sum, act, effect| {
            let own = acts(effect)
                .force_slopes
                .map_or_else(|| conditions.slopes_of(|there| act(effect, there)), |slopes| slopes(effect, conditions));
            [sum[0] + own[0], sum[1] + own[1], sum[2] + own[2]]
        })
    }

    /// Whether one of them is such a force.
    #[inline(always)]
    pub(crate) fn has_built_in_force(&self) -> bool {
        any!(self, force) || self.smooth_friction().is_some()
    }

    /// The derivatives of the own states.
    #[inline(always)]
    pub(crate) fn own_rates(&self, conditions: &Conditions) -> [f64; OWN_STATES] {
        self.written.own_rates(conditions).unwrap_or_default()
    }

    /// The own states where the conditions have been constant for ever.
    pub(crate) fn own_settled(&self, conditions: &Conditions) -> [f64; OWN_STATES] {
        self.written.own_settled(conditions).unwrap_or_default()
    }

    /// Their standard deviations before the first reading.
    pub(crate) fn own_spread(&self, conditions: &Conditions) -> [f64; OWN_STATES] {
        self.written.own_spread(conditions).unwrap_or_default()
    }

    /// The number of own states. Only written effects have any.
    #[inline(always)]
    #[must_use]
    pub fn own_states(&self) -> usize {
        self.written.own_states()
    }

    /// Whether an effect has states of its own.
    #[inline(always)]
    pub(crate) fn has_own_states(&self) -> bool {
        self.written.own_states() > 0
    }

    /// Whether a force depends on height or velocity.
    #[inline(always)]
    pub(crate) fn has_force(&self) -> bool {
        self.has_built_in_force() || self.written.has_force()
    }

    /// The random force of the air.
    #[inline(always)]
    #[must_use]
    pub fn coloured_force(&self) -> Option<Turbulence> {
        slot!(self, coloured_force, |act, effect| act(effect))
    }

    /// Dry friction.
    #[inline(always)]
    #[must_use]
    pub fn friction(&self) -> Option<WallFriction> {
        self.any_friction().filter(WallFriction::is_dry)
    }

    /// Friction that builds up smoothly with the speed: a force as others are, which does not hold the ball.
    #[inline(always)]
    #[must_use]
    pub fn smooth_friction(&self) -> Option<WallFriction> {
        self.any_friction().filter(|friction| !friction.is_dry())
    }

    #[inline(always)]
    fn any_friction(&self) -> Option<WallFriction> {
        slot!(self, friction, |act, effect| act(effect))
    }

    /// The ends of the ball's way; `None`: those of the pipe.
    #[inline(always)]
    #[must_use]
    pub fn ends(&self) -> Option<EndStop> {
        slot!(self, ends, |act, effect| act(effect))
    }

    /// Whether the motion between two events is linear in its state, so that its derivatives are the same everywhere,
    /// friction aside.
    #[must_use]
    pub fn motion_is_linear(&self) -> bool {
        let mut linear = true;
        for_each_effect!(self, effect => {
            let acts = acts(effect);
            let moves = acts.follows.is_some() || acts.force.is_some();
            linear &= !moves || acts.is_linear.is_some_and(|is_linear| is_linear(effect));
        });
        linear && self.smooth_friction().is_none() && self.written.motion_is_linear()
    }

    /// Whether a step between two events is a linear map of state, command and friction that depends on its length
    /// alone: no force acts but the fan's, turbulence, drag and friction.
    #[must_use]
    pub fn motion_is_linear_in_command(&self) -> bool {
        self.motion_is_linear() && !self.has_force() && !self.has_own_states()
    }
}

/// Sensor.
impl Effects {
    /// The sensed position, mm, `dt_s` after it was `sensed_mm`, of a ball on a path through start, middle and end.
    #[inline(always)]
    pub(crate) fn sensed(&self, sensed_mm: f64, path_mm: [f64; 3], dt_s: f64) -> f64 {
        fold!(self, senses, path_mm[2], |_s, act, effect| act(effect, sensed_mm, path_mm, dt_s))
    }

    /// Whether the sensor has inertia, and so a state.
    #[inline(always)]
    #[must_use]
    pub fn has_sensor_state(&self) -> bool {
        any!(self, senses)
    }

    /// Whether a written effect acts in the sensor.
    #[inline(always)]
    #[must_use]
    pub fn acts_on_reading(&self) -> bool {
        self.written.acts_on_reading()
    }

    /// How old a reading is, seconds.
    #[inline(always)]
    #[must_use]
    pub fn reading_delay_s(&self) -> f64 {
        fold!(self, delays_reading, 0.0, |sum, act, effect| sum + act(effect))
    }

    /// Standard deviation of a reading, mm, where it is `believed_mm` without these effects.
    #[inline(always)]
    #[must_use]
    pub fn reading_sigma_mm(&self, believed_mm: f64) -> f64 {
        fold!(self, spreads, believed_mm, |sigma, act, effect| act(effect, sigma))
    }

    /// Wild readings.
    #[inline(always)]
    #[must_use]
    pub fn outliers(&self) -> Option<SensorOutliers> {
        slot!(self, outliers, |act, effect| act(effect))
    }

    /// The step of the readings, mm.
    #[inline(always)]
    #[must_use]
    pub fn reading_step_mm(&self) -> Option<f64> {
        slot!(self, rounds, |act, effect| act(effect))
    }

    /// Readings that are held.
    #[inline(always)]
    #[must_use]
    pub fn hold(&self) -> Option<StaleSamples> {
        slot!(self, holds, |act, effect| act(effect))
    }
}

/// What follows from several places.
impl Effects {
    /// Adds what these effects do to a linear plant.
    pub(crate) fn linearise(&self, plant: &mut Linear) {
        for_each_effect!(self, effect => if let Some(act) = acts(effect).linearise { act(effect, plant) });
    }

    /// Whether the values of an effect that is on can show in such readings as its own.
    #[must_use]
    pub fn can_show(&self, effect_name: &str, readings: &Readings) -> bool {
        fold!(self, can_show, true, |can, act, effect| can && (name(effect) != effect_name || act(effect, readings)))
    }
}
