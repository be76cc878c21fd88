//! Predistortion: the duty for an acceleration, from a measured curve of the fan.
//!
//! ```text
//! points (duty, force) by rising duty → blocks with rising mean forces → (mean force, mean duty) of each block
//! duty(c) = hover + D(c) − D(0)      D: straight lines between the blocks, held beyond the first and the last
//! ```
//!
//! The control value is then an acceleration, nominal mm/s². A measured curve is noisy and not monotone; the blocks are
//! those of the least-squares fit of a rising curve, and their centres make it strictly rising, so that D has a finite
//! slope everywhere. The original fitted a polynomial of degree 6, whose slope was too small at small control values:
//! the ball hardly answered there. [`Curve::small_signal`] looks at just that.
//!
//! Source: the thesis, section 3.2 and figure 3.2.3; the fit: Barlow et al., *Statistical Inference under Order
//! Restrictions*, pool adjacent violators.

mod original;

use crate::check::{OutOfRange, within};
use original::ORIGINAL;

/// The most points of a curve.
pub const MAX_POINTS: usize = 128;
/// Control values that count as small, as a share of the curve's smaller end.
const SMALL: f64 = 0.15;
/// Between these the slope at small control values must lie for [`Predistortion::check`]; 1 is a fan made linear.
const SLOPES: (f64, f64) = (0.6, 1.6);

/// A measured curve: which duty gives which acceleration.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Predistortion {
    /// Pairs of duty in percent, rising, and acceleration in mm/s², at most [`MAX_POINTS`]. Absent: the original rig's.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub points: Option<heapless::Vec<[f64; 2], MAX_POINTS>>,
}

/// The rising curve through a measured one.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Force and duty, both rising.
    knots: heapless::Vec<[f64; 2], MAX_POINTS>,
    /// D(0).
    hover: f64,
}

/// Points that have been pooled.
#[derive(Clone, Copy)]
struct Block {
    force: f64,
    duty: f64,
    count: f64,
}

impl Predistortion {
    /// Checks that duties rise, that forces do on the whole, and that the fitted curve follows the measured one near
    /// hover.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first number that does not.
    pub fn check(&self) -> Result<(), OutOfRange> {
        let points = self.points();
        #[expect(clippy::cast_precision_loss, reason = "at most MAX_POINTS")]
        within("number of predistortion.points", points.len() as f64, 4.0, MAX_POINTS as f64)?;
        let mut lowest = 0.0;
        for [duty, force] in points {
            within("predistortion.points (duty, rising)", *duty, lowest, 100.0)?;
            within("predistortion.points (mm/s²)", *force, -1e5, 1e5)?;
            lowest = duty + 1e-9;
        }
        let curve = self.curve();
        let (weakest, strongest) = curve.reach();
        within("predistortion.points (smallest mm/s²)", weakest, -1e5, -1.0)?;
        within("predistortion.points (largest mm/s²)", strongest, 1.0, 1e5)?;
        let (below, above) = curve.small_signal(points);
        within("predistortion.points (slope just below hover)", below, SLOPES.0, SLOPES.1)?;
        within("predistortion.points (slope just above hover)", above, SLOPES.0, SLOPES.1)
    }

    /// The rising curve.
    #[must_use]
    pub fn curve(&self) -> Curve {
        Curve::through(self.points())
    }

    /// The same to be changed; the original rig's are copied first.
    pub(crate) fn points_mut(&mut self) -> &mut [[f64; 2]] {
        self.points.get_or_insert_with(|| ORIGINAL.into_iter().collect())
    }

    /// The measured points, duty and acceleration.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        self.points.as_deref().unwrap_or(&ORIGINAL)
    }
}

impl Curve {
    /// Fits the curve: neighbours whose forces fall are pooled until none do.
    fn through(points: &[[f64; 2]]) -> Self {
        let mut blocks = heapless::Vec::<Block, MAX_POINTS>::new();
        for [duty, force] in points {
            let mut block = Block { force: *force, duty: *duty, count: 1.0 };
            while let Some(before) = blocks.last().copied().filter(|before| before.force >= block.force) {
                block = block.pooled(before);
                blocks.pop();
            }
            // No more blocks than points, and of these no more than fit.
            let _ = blocks.push(block);
        }
        let mut curve = Self { knots: blocks.iter().map(|block| [block.force, block.duty]).collect(), hover: 0.0 };
        curve.hover = curve.at(0.0, 0, 1);
        curve
    }

    /// What must be added to hover for `mm_per_s2`, percent of duty.
    #[must_use]
    pub fn duty_about_hover(&self, mm_per_s2: f64) -> f64 {
        self.at(mm_per_s2, 0, 1) - self.hover
    }

    /// The acceleration that `percent` about hover gives, mm/s².
    #[must_use]
    pub fn mm_per_s2(&self, percent: f64) -> f64 {
        self.at(percent + self.hover, 1, 0)
    }

    /// The smallest and the largest acceleration of the curve, mm/s².
    #[must_use]
    pub fn reach(&self) -> (f64, f64) {
        let force = |knot: Option<&[f64; 2]>| knot.map_or(0.0, |knot| knot[0]);
        (force(self.knots.first()), force(self.knots.last()))
    }

    /// Percent of duty for each mm/s² of a small control value: what turns a plant's gain for a duty into one for the
    /// control value.
    #[must_use]
    pub fn percent_per_mm_per_s2(&self) -> f64 {
        let (weakest, strongest) = self.reach();
        let small = SMALL * (-weakest).min(strongest);
        (self.duty_about_hover(small) - self.duty_about_hover(-small)) / (2.0 * small)
    }

    /// How much of a small control value the measured fan gives behind this curve, below and above hover: the slope,
    /// through the origin and by least squares, of the measured force over the control value that asks for its duty. 1
    /// is linear.
    #[must_use]
    pub fn small_signal(&self, points: &[[f64; 2]]) -> (f64, f64) {
        let (weakest, strongest) = self.reach();
        let small = SMALL * (-weakest).min(strongest);
        let slope = |above: bool| {
            let near = points.iter().filter_map(|[duty, force]| {
                let asked = self.at(*duty, 1, 0);
                ((asked > 0.0) == above && asked.abs() <= small).then_some((asked, *force))
            });
            let (up, down) = near.fold((0.0, 0.0), |(up, down), (x, y)| (up + x * y, down + x * x));
            if down > 0.0 { up / down } else { 1.0 }
        };
        (slope(false), slope(true))
    }

    /// The straight line at `x` from column `from` to column `to`, held beyond the ends.
    fn at(&self, x: f64, from: usize, to: usize) -> f64 {
        let above = self.knots.partition_point(|knot| knot[from] <= x);
        match (above.checked_sub(1).and_then(|below| self.knots.get(below)), self.knots.get(above)) {
            (Some(a), Some(b)) => a[to] + (b[to] - a[to]) * (x - a[from]) / (b[from] - a[from]),
            (Some(end), None) | (None, Some(end)) => end[to],
            (None, None) => 0.0,
        }
    }
}

impl Block {
    fn pooled(self, other: Self) -> Self {
        let count = self.count + other.count;
        let mean = |a: f64, b: f64| (a * self.count + b * other.count) / count;
        Self { force: mean(self.force, other.force), duty: mean(self.duty, other.duty), count }
    }
}

#[cfg(test)]
mod tests;
