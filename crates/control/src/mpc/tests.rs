//! What `mpc.rs` promises, against LQR and against a general solver of convex programmes.

use super::{HORIZON, Mpc, Planner};
use crate::Limits;
use crate::believed::tests::G_C;
use crate::design::riccati::sampled_lqr;
use crate::inputs::{Inputs, tests::inputs};
use crate::observer::Estimate;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT};
use nalgebra::{Matrix3, vector};
use proptest::prelude::*;

use std::vec::Vec;

const WEIGHTS: Mpc = Mpc { move_s: 0.06, position_mm: 20.0, velocity_mm_per_s: 150.0, control: 0.6 };

fn planner() -> Planner {
    Planner::new(&WEIGHTS, &G_C).unwrap()
}

/// The same programme by an interior-point method.
fn reference(planner: &Planner, state: &nalgebra::Vector3<f64>, limits: Limits) -> Vec<f64> {
    let hessian = planner.programme.hessian;
    let linear = planner.linear * state;
    let upper: Vec<Vec<f64>> = (0..HORIZON)
        .map(|row| (0..HORIZON).map(|column| if row <= column { hessian[(row, column)] } else { 0.0 }).collect())
        .collect();
    let bounds: Vec<Vec<f64>> = (0..2 * HORIZON)
        .map(|row| {
            let sign = if row < HORIZON { 1.0 } else { -1.0 };
            (0..HORIZON).map(|column| if row % HORIZON == column { sign } else { 0.0 }).collect()
        })
        .collect();
    let sides: Vec<f64> =
        (0..2 * HORIZON).map(|row| if row < HORIZON { limits.upper } else { -limits.lower }).collect();
    let settings = DefaultSettingsBuilder::default().verbose(false).build().unwrap();
    let cones = [NonnegativeConeT(2 * HORIZON)];
    let (p, a) = (CscMatrix::from(&upper), CscMatrix::from(&bounds));
    let mut solver = DefaultSolver::new(&p, linear.as_slice(), &a, &sides, &cones, settings).unwrap();
    solver.solve();
    solver.solution.x.clone()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_plan_is_that_of_a_general_solver_whatever_the_state_and_the_limits(
        x in -400.0..400.0_f64, v in -600.0..600.0_f64, w in -8.0..8.0_f64, lower in -12.0..-0.5_f64, upper in 0.5..20.0_f64,
    ) {
        let planner = planner();
        let (state, limits) = (vector![x, v, w], Limits { lower, upper });
        let (got, exact) = (planner.plan(&state, limits), reference(&planner, &state, limits));
        // The move that is made, to a twentieth of a step of the fan.
        prop_assert!((got[0] - exact[0]).abs() < 0.04, "{} or {}", got[0], exact[0]);
        let cost = |u: &nalgebra::SVector<f64, HORIZON>| {
            (0.5 * u.transpose() * planner.programme.hessian * u)[0] + (planner.linear * state).dot(u)
        };
        let best = cost(&nalgebra::SVector::from_column_slice(&exact));
        prop_assert!(cost(&got) <= best + 1e-3 * best.abs().max(1.0), "{} or {best}", cost(&got));
        prop_assert!(got.iter().all(|u| (lower..=upper).contains(u)));
    }
}

#[test]
fn a_plan_that_meets_no_limit_is_lqr() {
    let planner = planner();
    let over = G_C.over(WEIGHTS.move_s);
    let (step, push) = (over.matrix.fixed_view::<3, 3>(0, 0).into_owned(), over.input.fixed_rows::<3>(0).into_owned());
    let weight = Matrix3::from_diagonal(&vector![1.0 / 400.0, 1.0 / 22_500.0, 0.0]);
    let effort = 1.0 / 0.36;
    let gain = sampled_lqr(&step, &push, &weight, effort).unwrap();
    let state = vector![30.0, -20.0, 0.3];
    let free = Limits { lower: -100.0, upper: 100.0 };
    assert!((planner.plan(&state, free)[0] + (gain * state)[0]).abs() < 1e-9);
}

#[test]
fn at_rest_on_the_setpoint_it_gives_what_hover_lacks() {
    let seen = Estimate { position_mm: 300.0, fan: -0.4, disturbance: 0.4, ..Estimate::default() };
    let now = Inputs { observed: seen, ..inputs(300.0, 300.0, 0.0) };
    assert!((planner().step(&now) + 0.4).abs() < 1e-12);
}

#[test]
fn with_little_to_brake_with_it_overshoots_less_than_the_same_law_clipped() {
    let planner = Planner::new(&Mpc { velocity_mm_per_s: 500.0, control: 3.0, ..WEIGHTS }, &G_C).unwrap();
    let tight = Limits { lower: -0.1, upper: 2.0 };
    let over = G_C.over(WEIGHTS.move_s);
    let overshoot = |law: &dyn Fn(nalgebra::Vector3<f64>) -> f64| {
        let mut state = vector![-350.0, 0.0, 0.0, 0.0];
        let mut highest = f64::NEG_INFINITY;
        for _ in 0..150 {
            let control = law(state.fixed_rows::<3>(0).into_owned());
            state = over.apply(&state, control);
            highest = f64::max(highest, state[0]);
        }
        highest
    };
    let clipped = overshoot(&|state| tight.hold((planner.free * state)[0]));
    let planned = overshoot(&|state| planner.plan(&state, tight)[0]);
    assert!(planned < 0.5 * clipped && clipped > 5.0, "{planned} mm, clipped {clipped} mm");
}
