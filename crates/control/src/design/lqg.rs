//! LQG as a law: the observer and the feedback of its estimate, in one transfer function.
//!
//! ```text
//! sampled      x̂ ← (I − L·C)·(Φ·x̂ + Γ·u) + L·y          continuous   dx̂/dt = A·x̂ + B·u + L·(y − C·x̂)
//!              A_o = (I − L·C)·Φ   B_o = (I − L·C)·Γ                  A_o = A − L·C   B_o = B
//! u = k₁·r − K·x̂     M = A_o − B_o·K     χ: characteristic polynomial
//! C = (χ(M − L·K) − χ(M))/χ(M), times z where sampled         S = k₁·χ(A_o)/χ(M)
//! ```
//!
//! x̂ holds position, velocity and fan, and what hover lacks where the observer looks for it: K = [k₁, k₂, k₃, k₃ + 1].
//! The sampled law is the one that flies, with the steady gain of [`crate::observer`] and a reading that is used at
//! once.
//! Source: Åström & Wittenmark, *Computer-Controlled Systems*, "Output feedback";
//! det(x·I − M + L·K) = χ(M)·(1 + K·(x·I − M)⁻¹·L).

use super::ackermann::characteristic;
use super::error::DesignError;
use super::law::Law;
use super::polynomial::Polynomial;
use super::riccati::kalman;
use super::transfer::{Plane, Transfer};
use crate::believed::Believed;
use crate::observer::Observer;
use crate::state_feedback::Lqg;
use nalgebra::{Matrix4, RowSVector, SMatrix, SVector, Vector4, matrix, vector};

/// An observer and the feedback of its estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observed {
    /// K.
    pub feedback: Lqg,
    /// Belief and noise, from which L follows.
    pub observer: Observer,
}

impl Observed {
    /// The law; in continuous time the noise of the readings is spread over `period_s`.
    ///
    /// # Errors
    /// [`DesignError::NoRiccatiSolution`]: the observer has no steady gain.
    pub fn law(&self, plane: Plane, period_s: f64) -> Result<Law, DesignError> {
        match (self.observer.believed.fan_lag_s.is_some(), self.observer.disturbance_psd_per_s.is_some()) {
            (true, true) => self.of([0, 1, 2, 3], plane, period_s),
            (true, false) => self.of([0, 1, 2], plane, period_s),
            (false, true) => self.of([0, 1, 3], plane, period_s),
            (false, false) => self.of([0, 1], plane, period_s),
        }
    }

    /// The law of an observer that has only `states` of position, velocity, fan and what hover lacks.
    fn of<const N: usize>(&self, states: [usize; N], plane: Plane, period_s: f64) -> Result<Law, DesignError> {
        let Lqg { position_per_mm, velocity_s_per_mm, fan } = self.feedback;
        let all = [position_per_mm, velocity_s_per_mm, fan, fan + 1.0];
        let k = RowSVector::<f64, N>::from_fn(|_, at| all[states[at]]);
        let c = RowSVector::<f64, N>::from_fn(|_, at| if at == 0 { 1.0 } else { 0.0 });
        let only = |whole: Vector4<f64>| SVector::<f64, N>::from_fn(|at, _| whole[states[at]]);
        let among = |whole: Matrix4<f64>| SMatrix::<f64, N, N>::from_fn(|row, col| whole[(states[row], states[col])]);
        let Observer { believed, acceleration_psd_mm2_per_s3: psd, sensor_mm, disturbance_psd_per_s, .. } =
            self.observer;
        let (own, pushed, gain, ahead) = match plane {
            Plane::Sampled(t) => {
                let (over, gain) = (believed.over(t), only(self.observer.steady_gain(t)?));
                let keep = SMatrix::<f64, N, N>::identity() - gain * c;
                // In δ = z − 1 the polynomials are those of A_o − I.
                let own = keep * among(over.matrix) - SMatrix::<f64, N, N>::identity();
                (own, keep * only(over.input), gain, Polynomial::new(&[1.0, 1.0]))
            }
            Plane::Continuous => {
                let (a, b) = rates(&believed);
                let w = Matrix4::from_diagonal(&vector![0.0, psd, 0.0, disturbance_psd_per_s.unwrap_or(0.0)]);
                let gain = kalman(&among(a), &c, &among(w), sensor_mm * sensor_mm * period_s)?;
                (among(a) - gain * c, only(b), gain, Polynomial::new(&[1.0]))
            }
        };
        let moved = own - pushed * k;
        let feedback = characteristic(&(moved - gain * k)).plus(&characteristic(&moved).scaled(-1.0));
        // The estimate of hover is an integrator: this root is 0 exactly, and rounding must not make a slow pole of it.
        let denominator = characteristic(&moved).with_root_at_0(disturbance_psd_per_s.is_some());
        let over = |numerator: Polynomial| Transfer { numerator, denominator, plane };
        let setpoint = characteristic(&own).scaled(position_per_mm);
        Ok(Law { feedback: over(feedback.times(&ahead)), setpoint: over(setpoint) })
    }
}

/// A and B of what is believed, in continuous time. Without a lag the fan is no state, and pushes the ball at once.
fn rates(believed: &Believed) -> (Matrix4<f64>, Vector4<f64>) {
    let Believed { gain_mm_per_s2_per_control: gain, drag_per_s: drag, fan_lag_s } = *believed;
    let (pole, at_once) = fan_lag_s.map_or((0.0, gain), |lag_s| (1.0 / lag_s, 0.0));
    let state = matrix![
        0.0, 1.0, 0.0, 0.0;
        0.0, -drag, gain, gain;
        0.0, 0.0, -pole, 0.0;
        0.0, 0.0, 0.0, 0.0];
    (state, vector![0.0, at_once, pole, 0.0])
}

#[cfg(test)]
mod tests {
    use super::{Observed, Plane};
    use crate::Limits;
    use crate::believed::{Believed, tests::G_C};
    use crate::controller::{Controllers, Kind};
    use crate::design::Linear;
    use crate::design::ackermann::characteristic;
    use crate::design::polynomial::magnitude;
    use crate::design::step::response;
    use crate::observer::{Gain, Observer};
    use crate::regulator::Regulator;
    use crate::state_feedback::Lqg;
    use nalgebra::{matrix, vector};

    const T: f64 = 0.02;

    fn observed(believed: Believed, disturbance_psd_per_s: Option<f64>) -> Observed {
        let fan = if believed.fan_lag_s.is_some() { 0.697 } else { 0.0 };
        Observed {
            feedback: Lqg { position_per_mm: 0.0195, velocity_s_per_mm: 0.0044, fan },
            observer: Observer {
                sensor_mm: 2.5,
                acceleration_psd_mm2_per_s3: 360.0,
                disturbance_psd_per_s,
                gate_sigma: f64::INFINITY,
                second_sensor_mm: None,
                tachometer: None,
                gain: Gain::SteadyState,
                believed,
            },
        }
    }

    fn plant(believed: &Believed) -> Linear {
        let lag_s = believed.fan_lag_s.unwrap_or(0.0);
        let bare = Linear::two_poles(believed.gain_mm_per_s2_per_control, believed.drag_per_s);
        Linear { fan_lag_s: lag_s, ..bare }
    }

    #[test]
    fn the_sampled_law_steps_as_the_firmware_does_on_the_believed_plant() {
        for believed in [G_C, Believed { fan_lag_s: None, ..G_C }] {
            for psd in [None, Some(1e-3)] {
                let observed = observed(believed, psd);
                let closed = observed.law(Plane::Sampled(T), T).unwrap().closed(&plant(&believed).sampled(T).unwrap());
                let set = Controllers { lqg: Some(observed.feedback), ..Controllers::default() };
                let mut flown = Regulator::new(set, Some(&observed.observer), T).unwrap();
                let (over, free) = (believed.over(T), Limits { lower: -1e9, upper: 1e9 });
                let mut state = vector![200.0, 0.0, 0.0, 0.0];
                for (time_s, value) in response(&closed).unwrap().take(400) {
                    let exact = (state[0] - 200.0) / 100.0;
                    assert!((value - exact).abs() < 1e-6, "{believed:?}, {psd:?}, {time_s} s: {value}, flown {exact}");
                    flown.read(state[0], T);
                    let control = flown.step(300.0, T, free);
                    state = over.apply(&state, control);
                    flown.pass(control, T);
                }
                assert_eq!(flown.kind(), Kind::Lqg);
            }
        }
    }

    #[test]
    fn the_closed_loop_has_the_poles_of_the_feedback_and_those_of_the_observer() {
        let observed = observed(G_C, None);
        let law = observed.law(Plane::Continuous, T).unwrap();
        let found = law.feedback.then(&plant(&G_C).continuous()).closed_poles(1.0);
        let (gain, drag, pole) = (827.2, 3.896, 1.0 / 0.257);
        let a = matrix![0.0, 1.0, 0.0; 0.0, -drag, gain; 0.0, 0.0, -pole];
        let (b, k) = (vector![0.0, 0.0, pole], matrix![0.0195, 0.0044, 0.697]);
        let poles = characteristic(&(a - b * k)).roots();
        assert_eq!((poles.len(), found.len()), (3, 6));
        for pole in poles {
            assert!(found.iter().any(|p| magnitude(p - pole) < 1e-6), "{pole} is not in {found:?}");
        }
    }

    #[test]
    fn what_looks_for_hover_leaves_no_error_behind_a_disturbance() {
        for plane in [Plane::Continuous, Plane::Sampled(T)] {
            let law = observed(G_C, Some(1e-3)).law(plane, T).unwrap();
            assert_eq!(law.feedback.denominator.ascending()[0], 0.0, "an integrator");
            // At rest the setpoint counts as much as the position.
            let (to, from) = (law.setpoint.numerator.ascending()[0], law.feedback.numerator.ascending()[0]);
            assert!((to / from - 1.0).abs() < 1e-6, "{to} and {from}");
        }
    }
}
