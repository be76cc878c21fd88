//! One step of a linear plant under an input that is held: state (position, speed, force), input and noise.

use super::{Order, Point};

/// Transition of the state, response to a unit input, and covariance of a unit noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) transition: [[f64; 2]; 2],
    pub(super) response: [f64; 2],
    /// Whether the third state acts as the input does.
    pub(super) drifts: bool,
    /// Upper triangle, row by row.
    pub(super) noise: [f64; 6],
}

impl Step {
    /// Over `dt` seconds.
    pub(super) fn over(dt: f64, point: Point) -> Self {
        let Point { order, drag_per_s, spring_per_s2, .. } = point;
        let (transition, response) = match order {
            Order::First => ([[(-drag_per_s * dt).exp(), 0.0], [0.0, 0.0]], [integral(drag_per_s, dt), 0.0]),
            Order::Second | Order::Spring | Order::Unstable | Order::Drifting => second(drag_per_s, spring_per_s2, dt),
        };
        Self { transition, response, drifts: order == Order::Drifting, noise: noise(dt, point) }
    }

    /// The next state.
    pub(super) fn moved(&self, [y, v, d]: [f64; 3], input: f64) -> [f64; 3] {
        let [[a, b], [c, e]] = self.transition;
        let input = if self.drifts { input + d } else { input };
        [a * y + b * v + self.response[0] * input, c * y + e * v + self.response[1] * input, d]
    }

    /// The covariance of the next state.
    pub(super) fn spread(&self, [yy, yv, yd, vv, vd, dd]: [f64; 6], psd: f64) -> [f64; 6] {
        let [[a, b], [c, e]] = self.transition;
        let [r, s] = if self.drifts { self.response } else { [0.0; 2] };
        // Φ·P, then times Φᵀ.
        let (py, pv, pd) = (
            [a * yy + b * yv + r * yd, c * yy + e * yv + s * yd],
            [a * yv + b * vv + r * vd, c * yv + e * vv + s * vd],
            [a * yd + b * vd + r * dd, c * yd + e * vd + s * dd],
        );
        let q = self.noise.map(|noise| noise * psd);
        [
            py[0] * a + pv[0] * b + pd[0] * r + q[0],
            py[0] * c + pv[0] * e + pd[0] * s + q[1],
            pd[0] + q[2],
            py[1] * c + pv[1] * e + pd[1] * s + q[3],
            pd[1] + q[4],
            dd + q[5],
        ]
    }
}

/// ∫ g·gᵀ dt by Simpson's rule, g: the response to an impulse of the noise.
fn noise(dt: f64, point: Point) -> [f64; 6] {
    let impulse = |s: f64| match point.order {
        Order::First => [(-point.drag_per_s * s).exp(), 0.0, 0.0],
        Order::Second | Order::Spring | Order::Unstable => {
            let (phi, _) = second(point.drag_per_s, point.spring_per_s2, s);
            [phi[0][1], phi[1][1], 0.0]
        }
        Order::Drifting => {
            let (_, [y, v]) = second(point.drag_per_s, point.spring_per_s2, s);
            [y, v, 1.0]
        }
    };
    let square = |s: f64| {
        let [y, v, d] = impulse(s);
        [y * y, y * v, y * d, v * v, v * d, d * d]
    };
    let (a, b, c) = (square(0.0), square(0.5 * dt), square(dt));
    std::array::from_fn(|i| dt / 6.0 * (a[i] + 4.0 * b[i] + c[i]))
}

/// (1 − e^−at)/a.
fn integral(a: f64, t: f64) -> f64 {
    if a * t < 1e-9 { t } else { -(-a * t).exp_m1() / a }
}

/// (1 − e^−at)/a, and its integral over t: velocity and displacement after `t` by a constant acceleration of 1 under
/// the drag `a`. Where a·t is small, the difference t − velocity loses its digits; the series leaves out (a·t)²/12 of
/// its value, 10⁻⁹ at the limit.
pub(crate) fn integrals(a: f64, t: f64) -> [f64; 2] {
    let velocity = integral(a, t);
    [velocity, if a * t < 1e-4 { 0.5 * t * t * (1.0 - a * t / 3.0) } else { (t - velocity) / a }]
}

/// Transition and response of ÿ = −k·y − a·ẏ + u.
fn second(a: f64, k: f64, t: f64) -> ([[f64; 2]; 2], [f64; 2]) {
    if k == 0.0 {
        let [velocity, displacement] = integrals(a, t);
        return ([[1.0, velocity], [0.0, (-a * t).exp()]], [displacement, velocity]);
    }
    // Φ = e^−at/2·(c + s·(A + a/2)),   c, s: cos ωt and sin ωt/ω, or their hyperbolic forms
    let square = k - 0.25 * a * a;
    let (c, s) = if square.abs() * t * t < 1e-12 {
        (1.0, t)
    } else if square > 0.0 {
        let w = square.sqrt();
        ((w * t).cos(), (w * t).sin() / w)
    } else {
        let w = (-square).sqrt();
        ((w * t).cosh(), (w * t).sinh() / w)
    };
    let e = (-0.5 * a * t).exp();
    let phi = [[e * (c + 0.5 * a * s), e * s], [-e * k * s, e * (c - 0.5 * a * s)]];
    (phi, [(1.0 - phi[0][0]) / k, phi[0][1]])
}

#[cfg(test)]
mod tests {
    use super::super::{Order, Point};
    use super::Step;

    /// Ten steps of a tenth give what one step gives.
    #[test]
    fn steps_in_a_row_are_one_long_step() {
        for (order, drag_per_s, spring_per_s2) in [
            (Order::First, 2.0, 0.0),
            (Order::Second, 0.0, 0.0),
            (Order::Second, 3.0, 0.0),
            (Order::Spring, 3.0, 40.0),
            (Order::Spring, 30.0, 40.0),
            (Order::Spring, 2.0, 1.0),
            (Order::Unstable, 2.0, -40.0),
        ] {
            let point = Point { order, drag_per_s, spring_per_s2, lag_s: 0.0, noise_ratio: 1.0 };
            let (whole, tenth) = (Step::over(0.3, point), Step::over(0.03, point));
            let mut state = [0.5, if order == Order::First { 0.0 } else { -2.0 }];
            let next = |step: &Step, [y, v]: [f64; 2]| {
                let [[a, b], [c, d]] = step.transition;
                [a * y + b * v + step.response[0], c * y + d * v + step.response[1]]
            };
            let at_once = next(&whole, state);
            (0..10).for_each(|_| state = next(&tenth, state));
            for (one, many) in at_once.into_iter().zip(state) {
                assert!((one - many).abs() < 1e-9, "{order:?}: {one} and {many}");
            }
        }
    }
}
