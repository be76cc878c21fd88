//! Dry friction of the ball: what holds it at rest, and what brakes it once it slides.

/// Dry friction as accelerations of the ball, mm/s², none of them below 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DryFriction {
    /// What brakes a ball that slides up, and one that slides down.
    pub sliding: [f64; 2],
    /// What a ball at rest resists to a force that pushes it up, and to one that pushes it down.
    pub holding: [f64; 2],
}

impl DryFriction {
    /// The same friction in both directions, sliding and at rest.
    #[must_use]
    pub const fn even(acceleration_mm_per_s2: f64) -> Self {
        Self { sliding: [acceleration_mm_per_s2; 2], holding: [acceleration_mm_per_s2; 2] }
    }

    /// Whether there is any.
    #[must_use]
    pub fn acts(&self) -> bool {
        self.sliding.iter().chain(&self.holding).any(|acceleration| *acceleration > 0.0)
    }

    /// Whether a ball at rest stays there under the acceleration `net`, mm/s².
    #[must_use]
    pub fn holds(&self, net: f64) -> bool {
        net.abs() <= self.holding[usize::from(net < 0.0)]
    }

    /// The acceleration that friction adds to a ball that slides `direction` (+1 up, −1 down), mm/s².
    #[must_use]
    pub fn acceleration(&self, direction: f64) -> f64 {
        -self.sliding[usize::from(direction < 0.0)] * direction
    }

    /// The mean of the sliding friction up and down, mm/s².
    #[must_use]
    pub fn mean(&self) -> f64 {
        f64::midpoint(self.sliding[0], self.sliding[1])
    }

    /// The expected acceleration by sliding friction, mm/s², where the expectation of the direction of motion is
    /// `direction`, between −1 and 1.
    #[must_use]
    pub fn expected(&self, direction: f64) -> f64 {
        0.5 * (self.sliding[1] - self.sliding[0]) - self.mean() * direction
    }
}

#[cfg(test)]
mod tests {
    use super::DryFriction;

    #[test]
    fn each_direction_has_its_own_friction_and_rest_another() {
        let friction = DryFriction { sliding: [30.0, 10.0], holding: [50.0, 20.0] };
        assert_eq!((friction.acceleration(1.0), friction.acceleration(-1.0)), (-30.0, 10.0));
        assert_eq!((friction.expected(1.0), friction.expected(-1.0), friction.expected(0.0)), (-30.0, 10.0, -10.0));
        assert!(friction.holds(49.0) && !friction.holds(51.0) && friction.holds(-19.0) && !friction.holds(-21.0));
    }
}
