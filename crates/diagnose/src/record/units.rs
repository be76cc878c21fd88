//! Usual units of a duty and a position, and numbers as messages have them.

/// Percent per unit of usual inputs: a fraction, and counts of PWM chips of 8, 10, 12 and 16 bits.
const USUAL_SCALES: [f64; 5] = [100.0, 100.0 / 255.0, 100.0 / 1023.0, 100.0 / 4095.0, 100.0 / 65535.0];
/// A hover off by more than this factor is in other units.
pub(crate) const OTHER_HOVER: f64 = 1.5;
/// A gain within this factor of that of a unit of length is that unit's.
const LIKE_A_UNIT: f64 = 2.5;

/// The usual scale of a duty that is nearest to `scale`, if it is `within` this factor of it; otherwise `scale`.
pub(super) fn nearest_scale(scale: f64, within: f64) -> f64 {
    let off = |usual: &f64| (usual / scale).ln().abs();
    let nearest = USUAL_SCALES.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.filter(|usual| off(usual) < within.ln()).unwrap_or(scale)
}

/// The unit of a length whose gain is so many times that of millimetres, and its scale.
pub(super) fn length(ratio: f64) -> (&'static str, f64) {
    let known =
        [(1e-3, ", perhaps metres", 1e3), (0.1, ", perhaps centimetres", 10.0), (1e3, ", perhaps micrometres", 1e-3)];
    let near = known.into_iter().find(|(unit, ..)| (ratio / unit).ln().abs() < LIKE_A_UNIT.ln());
    near.map_or_else(|| ("", ratio.recip()), |(_, words, scale)| (words, scale))
}

/// A number with four significant digits; a very large or small one by its power of ten.
pub(super) fn digits(value: f64) -> String {
    if (1e-6..1e9).contains(&value.abs()) { four_digits(value) } else { format!("{value:.3e}") }
}

/// A number with four significant digits, at most nine of them decimals, without zeros at its end.
pub(crate) fn four_digits(value: f64) -> String {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a few places")]
    let places = (3.0 - value.abs().max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.places$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

/// A number with one decimal; a very large one by its power of ten, not by three hundred digits.
pub(super) fn short(value: f64) -> String {
    if value.abs() < 1e6 { format!("{value:.1}") } else { format!("{value:.3e}") }
}
