//! Model-predictive control: the optimal plan over a horizon within the limits of the fan, of which the first move is
//! executed.
//!
//! ```text
//! minimise Σ x̃ₖᵀQx̃ₖ + R·δₖ²  over k < N,  + x̃_NᵀPx̃_N        x̃ₖ₊₁ = Φx̃ₖ + Γδₖ      lower ≤ δₖ − d̂ + u_r ≤ upper
//! x̃ = (x̂ − r, v̂ − ṙ, ŵ + d̂ − w_r)      δ = u + d̂ − u_r        Q = diag(1/x₀², 1/v₀², 0), R = 1/u₀²
//! ```
//!
//! x₀, v₀ and u₀ are deviations of equal weight; P is the cost of the unlimited optimum from the horizon on, so that
//! plans which reach no limit are LQR. The error of hover shifts the target and the limits: no error remains at rest.
//! The states are eliminated (N unknowns), and a plan that violates a limit is corrected in [`STEPS`] steps of
//! `box_qp.rs`.
//! Source: Maciejowski, *Predictive Control with Constraints*, chapters 2 and 3.

use crate::believed::{Believed, Transition};
use crate::box_qp::BoxQp;
use crate::check::{OutOfRange, within};
use crate::design::riccati::cost_to_go;
use crate::inputs::Inputs;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3, vector};

/// N: moves in a plan.
pub const HORIZON: usize = 16;
/// Steps of the optimisation: a fixed number, so that a control step takes a constant time.
pub const STEPS: u32 = 60;

/// The weights of the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Mpc {
    /// Length of one move of the plan, seconds; the plan has 16 of them.
    pub move_s: f64,
    /// x₀: a deviation of the position that weighs 1, mm.
    pub position_mm: f64,
    /// v₀: a velocity that weighs 1, mm/s.
    pub velocity_mm_per_s: f64,
    /// u₀: a control value that weighs 1.
    pub control: f64,
}

/// The plan's matrices for one belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planner {
    programme: BoxQp<HORIZON>,
    /// From the state to the linear part of the programme.
    linear: SMatrix<f64, HORIZON, 3>,
    /// From the state to the plan without limits.
    free: SMatrix<f64, HORIZON, 3>,
}

impl Mpc {
    /// Checks every number against its bounds.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first number outside its bounds.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("move_s", self.move_s, 0.005, 1.0)?;
        within("position_mm", self.position_mm, 0.1, 1e4)?;
        within("velocity_mm_per_s", self.velocity_mm_per_s, 1.0, 1e6)?;
        within("control", self.control, 1e-3, 1e6)
    }
}

impl Planner {
    /// The matrices of `set` for a plant as `believed`. `None`: numbers so far apart that no plan can be computed.
    #[must_use]
    pub fn new(set: &Mpc, believed: &Believed) -> Option<Self> {
        let Transition { matrix, input } = believed.over(set.move_s);
        let step: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into_owned();
        let push: Vector3<f64> = input.fixed_rows::<3>(0).into_owned();
        let square = |value: f64| (value * value).recip();
        let weight = Matrix3::from_diagonal(&vector![square(set.position_mm), square(set.velocity_mm_per_s), 0.0]);
        let effort = square(set.control);
        let end = cost_to_go(&step, &push, &weight, effort).ok()?;

        let mut hessian = SMatrix::<f64, HORIZON, HORIZON>::identity() * effort;
        let mut linear = SMatrix::<f64, HORIZON, 3>::zeros();
        // State k as `from` times the state now plus `by` times the plan.
        let mut from = Matrix3::identity();
        let mut by = SMatrix::<f64, 3, HORIZON>::zeros();
        for k in 0..HORIZON {
            from = step * from;
            by = step * by;
            by.set_column(k, &push);
            let weight = if k + 1 == HORIZON { &end } else { &weight };
            hessian += by.transpose() * weight * by;
            linear += by.transpose() * weight * from;
        }
        let free = -hessian.cholesky()?.solve(&linear);
        free.iter().all(|value| value.is_finite()).then(|| Self {
            programme: BoxQp::new(hessian, effort),
            linear,
            free,
        })
    }

    /// One control step. It has no state: every plan is new.
    #[must_use]
    pub fn step(&self, inputs: &Inputs) -> f64 {
        let (wanted, seen) = (&inputs.reference, &inputs.observed);
        let state = vector![
            seen.position_mm - wanted.position_mm,
            seen.velocity_mm_per_s - wanted.velocity_mm_per_s,
            seen.fan + seen.disturbance - wanted.fan
        ];
        let limits = inputs.limits.shifted(seen.disturbance);
        let plan = self.plan(&state, limits);
        inputs.limits.hold(plan[0] - seen.disturbance)
    }

    /// The best moves from the deviation `state` within `limits`.
    fn plan(&self, state: &Vector3<f64>, limits: crate::Limits) -> SVector<f64, HORIZON> {
        let free = self.free * state;
        if free.iter().all(|value| limits.hold(*value) == *value) {
            return free;
        }
        self.programme.solve(&free, &(self.linear * state), limits, STEPS)
    }
}

#[cfg(test)]
mod tests;
