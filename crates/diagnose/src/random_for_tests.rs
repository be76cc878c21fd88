//! Random numbers for tests.

/// Random numbers from −0.5 to 0.5, by the linear congruential generator of Numerical Recipes.
pub(crate) fn uniform(mut seed: u32) -> impl FnMut() -> f64 {
    move || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
    }
}
