//! Bounds of the parameters, narrowed by what was recorded.
//!
//! ```text
//! hover     lowest duty − m ≤ hover ≤ highest duty + m       m: half of the range of duties
//! heights   min(0, lowest reading) ≤ height ≤ max(length of the pipe, highest reading)
//!           half a turn further, where the position is an angle: it need not pass where its pendulum hangs
//! speeds    v/50 ≤ speed ≤ v                              v: the speed that a quarter of the readings exceeds
//! others    as the config accepts them; the gain keeps its sign
//! ```
//!
//! A ball that is still in the pipe at the end was accelerated both ways, so the duty that balances it lies within the
//! range of recorded duties. The margin is for a mean force that an effect may add. A stop beyond all readings cannot
//! be estimated.

use crate::fit::parameter::Parameter;
use crate::record::recording::Recording;
use crate::record::usual_speed::usual_speed;
use plant::{Model, Scale, Unsound};

/// Margin of hover beyond the range of duties, as a share of that range.
const MARGIN: f64 = 0.5;
/// A value this near to a bound is at it: relative to the larger of the two, and absolute.
const NEAR: f64 = 1e-9;

/// Bounds of the parameters of every model on one record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    hover_percent: [f64; 2],
    height_mm: [f64; 2],
    speed_mm_per_s: [f64; 2],
}

/// Slowest speed over which friction builds up, as a share of the usual one: below that it is dry for all that a record
/// shows. Chosen by hand.
const SLOW: f64 = 0.02;

/// Why a model is not possible on a record.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Impossible {
    /// The config does not allow the model.
    Unsound(Unsound),
    /// A parameter is outside the bounds of the record.
    OutOfRecord(Parameter),
}

impl Bounds {
    /// The bounds on this record, for a rig that is believed to be `belief`.
    pub(crate) fn of(belief: &Model, recording: &Recording) -> Self {
        let [low, high] = recording.duty_range();
        let margin = MARGIN * (high - low);
        let [lowest, highest] = recording.height_range();
        let (bottom, top) = belief.pipe_mm();
        let speed = usual_speed(recording);
        let beyond_mm = belief.turn_mm.map_or(0.0, |turn_mm| turn_mm / 2.0);
        Self {
            hover_percent: [(low - margin).max(Model::HOVER.min), (high + margin).min(Model::HOVER.max)],
            speed_mm_per_s: [SLOW * speed, speed],
            height_mm: [lowest.min(bottom) - beyond_mm, highest.max(top) + beyond_mm],
        }
    }

    /// The smallest and the largest value of a parameter, in its unit.
    #[must_use]
    pub fn range(&self, parameter: Parameter) -> [f64; 2] {
        let Some(param) = parameter.param() else { return [0.0, f64::INFINITY] };
        match (parameter, param.scale) {
            (Parameter::Hover, _) => self.hover_percent,
            (_, Scale::Height(_)) => [param.min.max(self.height_mm[0]), param.max.min(self.height_mm[1])],
            (_, Scale::Speed) => self.speed_mm_per_s.map(|bound| bound.clamp(param.min, param.max)),
            _ => [param.min, param.max],
        }
    }

    /// The model with each of these parameters clamped to its bounds.
    pub(crate) fn clamped(&self, model: Model, parameters: &[Parameter]) -> Model {
        parameters.iter().fold(model, |model, parameter| {
            let [low, high] = self.range(*parameter);
            match parameter.value(&model) {
                Some(value) if value < low => parameter.with_value(&model, low),
                Some(value) if value > high => parameter.with_value(&model, high),
                _ => model,
            }
        })
    }

    /// The bound at which a parameter of `model` is, if any; a bound where the parameter has no effect does not count.
    #[must_use]
    pub fn active(&self, parameter: Parameter, model: &Model) -> Option<f64> {
        let value = parameter.value(model)?;
        let near = |bound: &f64| (value - bound).abs() <= NEAR * bound.abs().max(1.0);
        let neutral = parameter.neutral(model);
        self.range(parameter).into_iter().filter(near).find(|bound| neutral != Some(*bound))
    }

    /// Checks a model against the bounds of the config, and `parameters` against those of the record.
    pub(crate) fn check(&self, model: &Model, parameters: &[Parameter]) -> Result<(), Impossible> {
        model.check().map_err(|(_, unsound)| Impossible::Unsound(unsound))?;
        let outside = |parameter: &&Parameter| {
            let [low, high] = self.range(**parameter);
            parameter.value(model).is_some_and(|value| !(low..=high).contains(&value))
        };
        parameters.iter().find(outside).map_or(Ok(()), |parameter| Err(Impossible::OutOfRecord(*parameter)))
    }
}

#[cfg(test)]
mod tests {
    use super::{Bounds, Impossible};
    use crate::fit::estimate::Problem;
    use crate::fit::parameter::{BASE, Parameter, Prior, parameters_of_effect};
    use crate::record::folds::Folds;
    use crate::tests_support::{model, record};
    use plant::{Effects, Model};

    #[test]
    fn a_fit_ends_within_the_duties_flown_wherever_it_starts() {
        let recording = record(&model(), 1, 40);
        let [low, high] = recording.duty_range();
        let bounds = Bounds::of(&model(), &recording);
        for hover_duty_percent in [-173.0, 900.0] {
            let start = Model { hover_duty_percent, ..model() };
            let folds = Folds::new(&start, &recording);
            let problem = Problem { recording: &recording, belief: &start, folds: &folds, prior: Prior::Nothing };
            let fit = problem.fit(&start, &BASE);
            let margin = (high - low) / 2.0;
            let within = low - margin..=high + margin;
            assert!(within.contains(&fit.model.hover_duty_percent), "{}", fit.model.hover_duty_percent);
            assert_eq!(bounds.check(&fit.model, &BASE), Ok(()));
            for held_out in problem.without_each_fold(&fit) {
                assert_eq!(bounds.check(&held_out, &BASE), Ok(()));
            }
        }
    }

    #[test]
    fn a_stop_stays_where_the_ball_could_be() {
        let recording = record(&model(), 1, 40);
        let bounds = Bounds::of(&model(), &recording);
        let mut stopped = model();
        stopped.effects.set("end_stop", &[-335.0, 900.0, 0.5]);
        let parameters = parameters_of_effect(Effects::built_in("end_stop").unwrap(), &[-335.0, 900.0, 0.5]);
        assert_eq!(bounds.check(&stopped, &parameters), Err(Impossible::OutOfRecord(parameters[0])));
        let clamped = bounds.clamped(stopped, &parameters);
        let [lowest, highest] = recording.height_range();
        let expected = [lowest.min(0.0), highest.max(model().pipe_length_mm), 0.5];
        assert_eq!(clamped.effects.values("end_stop"), Some(expected.to_vec()));
    }

    #[test]
    fn a_bound_is_active_where_the_value_stands_at_it_and_does_something() {
        let recording = record(&model(), 1, 40);
        let bounds = Bounds::of(&model(), &recording);
        let high = bounds.range(Parameter::Hover)[1];
        let at = Model { hover_duty_percent: high, ..model() };
        assert_eq!(
            (bounds.active(Parameter::Hover, &at), bounds.active(Parameter::Hover, &model())),
            (Some(high), None)
        );
        let mut zone = Model { effects: Effects::default(), ..model() };
        zone.effects.set("dead_zone", &[-100.0, 0.0]);
        let edges = parameters_of_effect(Effects::built_in("dead_zone").unwrap(), &[-100.0, 0.0]);
        assert_eq!([0, 1].map(|edge| bounds.active(edges[edge], &zone)), [Some(-100.0), None]);
    }
}
