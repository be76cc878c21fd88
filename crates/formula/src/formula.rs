//! A formula: its text, and what was made of it.

use crate::dual::Dual;
use crate::mistake::Mistake;
use crate::parse::parse;
use crate::program::Program;
use crate::tree::Tree;
use crate::{affine, range};
use alloc::string::String;
use core::fmt::{Display, Formatter, Result as Written};

/// An expression that is parsed once and then evaluated as often as wanted, from any thread.
///
/// ```
/// use formula::Formula;
///
/// let spring = Formula::parse("-k * max(x - start, 0)", &["x", "k", "start"])?;
/// assert_eq!(spring.value(&[350.0, 2.0, 300.0]), -100.0);
/// // The derivative by x.
/// assert_eq!(spring.dual(&[350.0, 2.0, 300.0], &[1.0, 0.0, 0.0]), (-100.0, -2.0));
/// # Ok::<(), formula::Mistake>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    text: String,
    tree: Tree,
    program: Program,
}

impl Formula {
    /// Reads a formula. `names` are the variables' names in the order of the values that [`Formula::value`] takes. Of
    /// two equal names the first counts; a variable named `pi` hides the constant (see [`crate::is_free_name`]).
    pub fn parse(text: &str, names: &[&str]) -> Result<Self, Mistake> {
        let tree = parse(text, names)?;
        Ok(Self { text: text.into(), program: Program::new(&tree), tree })
    }

    /// The value. A missing variable is NaN, and a NaN that is used makes the value NaN, except in a comparison, which
    /// is then false, in the branch of an `if` that is not taken, and in `NaN^0` and `1^NaN`, which are 1.
    #[must_use]
    pub fn value(&self, variables: &[f64]) -> f64 {
        one_nan(self.program.run(|k| variables.get(k).copied().unwrap_or(f64::NAN)))
    }

    /// The value, which is that of [`Formula::value`] in every bit, and its derivative while the variables move with
    /// the speeds `towards` (forward-mode automatic differentiation). A missing speed is zero.
    ///
    /// `max`, `min`, `clamp`, `abs` and `if` have the derivative of the side that the value takes, which of two equal ones
    /// is the left one, and of `abs(0)` the positive one. `sign` and comparisons have none: zero.
    #[must_use]
    pub fn dual(&self, variables: &[f64], towards: &[f64]) -> (f64, f64) {
        let (value, [slope]) = self.along(variables, |k| [towards.get(k).copied().unwrap_or(0.0)]);
        (value, slope)
    }

    /// The value, and its derivatives by `N` of the variables at once, given by their places among the names; see
    /// [`Formula::dual`].
    #[must_use]
    pub fn gradient<const N: usize>(&self, variables: &[f64], by: &[usize; N]) -> (f64, [f64; N]) {
        self.along(variables, |k| by.map(|one| f64::from(u8::from(one == k))))
    }

    #[inline(always)]
    fn along<const N: usize>(&self, variables: &[f64], towards: impl Fn(usize) -> [f64; N]) -> (f64, [f64; N]) {
        let Dual { value, slopes } =
            self.program.run(|k| Dual { value: variables.get(k).copied().unwrap_or(f64::NAN), slopes: towards(k) });
        (one_nan(value), slopes.map(one_nan))
    }

    /// The text that was parsed.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether the variable at this place among the names occurs.
    #[must_use]
    pub fn uses(&self, variable: usize) -> bool {
        self.column_of(variable).is_some()
    }

    /// Where the variable at this place among the names occurs first: the column, in characters, from 1.
    #[must_use]
    pub fn column_of(&self, variable: usize) -> Option<usize> {
        self.tree.variables.iter().find(|used| used.index == variable).map(|used| used.column)
    }

    /// Whether the value is affine in these variables together, whatever the others are: a sum of products of one of
    /// them and of what depends on none. False where that is not plain, as in `x^2 - x^2`.
    #[must_use]
    pub fn is_affine_in(&self, variables: &[usize]) -> bool {
        affine::is_affine_in(&self.tree, variables)
    }

    /// The least and the greatest value, or beyond them, when each variable lies within its bounds, or where the value
    /// can be undefined (interval arithmetic). One that occurs twice counts as two: `x - x` is not zero.
    ///
    /// The branch of an `if` that is never taken within the bounds may be undefined.
    pub fn range(&self, bounds: &[(f64, f64)]) -> Result<(f64, f64), Mistake> {
        range::range(&self.tree, bounds)
    }
}

impl Display for Formula {
    fn fmt(&self, f: &mut Formatter<'_>) -> Written {
        f.write_str(&self.text)
    }
}

/// Of the NaNs, which differ from machine to machine, always the same.
fn one_nan(value: f64) -> f64 {
    if value.is_nan() { f64::NAN } else { value }
}

const _: () = {
    const fn can_be_shared<T: Send + Sync>() {}
    can_be_shared::<Formula>();
};
