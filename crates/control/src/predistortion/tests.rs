//! What `predistortion.rs` promises.

use super::{Curve, MAX_POINTS, ORIGINAL, Predistortion};

fn curve(points: &[[f64; 2]]) -> Curve {
    Predistortion { points: Some(points.iter().copied().collect()) }.curve()
}

#[test]
fn the_curve_of_the_original_rig_is_sound_and_rises_where_its_points_do_not() {
    let original = Predistortion { points: None };
    original.check().unwrap();
    let falls = ORIGINAL.windows(2).filter(|pair| pair[1][1] < pair[0][1]).count();
    assert_eq!(falls, 20, "steps down in the table");
    let curve = original.curve();
    let mut last = f64::NEG_INFINITY;
    for k in -800..=1090 {
        let duty = curve.duty_about_hover(f64::from(k));
        assert!(duty > last, "{k} mm/s² asks for {duty} %, less than before: {last} %");
        last = duty;
    }
}

#[test]
fn a_rising_table_is_interpolated_point_by_point_and_held_beyond_its_ends() {
    let curve = curve(&[[20.0, -200.0], [21.0, -100.0], [22.0, 0.0], [23.0, 300.0], [24.0, 400.0]]);
    for (force, duty) in [(-999.0, -2.0), (-150.0, -1.5), (0.0, 0.0), (150.0, 0.5), (400.0, 2.0), (999.0, 2.0)] {
        assert!((curve.duty_about_hover(force) - duty).abs() < 1e-12, "{force} mm/s²");
    }
    assert_eq!(curve.reach(), (-200.0, 400.0));
}

#[test]
fn near_hover_the_original_curve_is_its_table() {
    let curve = Predistortion { points: None }.curve();
    // 21.3 is hover; 20.9 to 21.6 rise in the table.
    for (force, duty) in [(-82.916, -0.3), (-23.061, -0.1), (0.0, 0.0), (54.491, 0.1), (156.07, 0.2), (209.085, 0.3)] {
        assert!((curve.duty_about_hover(force) - duty).abs() < 1e-9, "{force} mm/s²");
    }
}

#[test]
fn a_straight_curve_has_its_slope_at_small_control_values() {
    let straight = curve(&[[20.0, -200.0], [21.0, -100.0], [22.0, 0.0], [23.0, 100.0], [24.0, 200.0]]);
    assert!((straight.percent_per_mm_per_s2() - 0.01).abs() < 1e-12);
}

#[test]
fn points_that_fall_are_pooled_to_their_mean() {
    let curve = curve(&[[10.0, -20.0], [11.0, 6.0], [12.0, 0.0], [13.0, 3.0], [14.0, 30.0]]);
    // 6, 0 and 3 pool to 3 at 12 %; from there the lines lead to −20 at 10 % and to 30 at 14 %.
    assert!((curve.mm_per_s2(curve.duty_about_hover(3.0)) - 3.0).abs() < 1e-12);
    let slope = (curve.duty_about_hover(30.0) - curve.duty_about_hover(3.0)) / 27.0;
    assert!((slope - 2.0 / 27.0).abs() < 1e-12, "{slope}");
}

#[test]
fn the_inverse_of_the_curve_is_its_inverse() {
    let curve = Predistortion { points: None }.curve();
    for k in -15..=20 {
        let force = 50.0 * f64::from(k);
        assert!((curve.mm_per_s2(curve.duty_about_hover(force)) - force).abs() < 1e-9, "{force} mm/s²");
    }
}

#[test]
fn a_curve_that_is_too_flat_near_hover_shows_in_its_small_signal() {
    let (below, above) = Predistortion { points: None }.curve().small_signal(&ORIGINAL);
    assert!((below - 1.0).abs() < 0.05 && (above - 1.0).abs() < 0.05, "{below}, {above}");
    // The straight line through the ends, as a smooth fit of few degrees is near hover.
    let straight = curve(&[[17.6, -805.266], [25.9, 1091.921]]);
    let (_, above) = straight.small_signal(&ORIGINAL);
    assert!(!(0.7..=1.5).contains(&above), "{above}");
}

#[test]
fn too_few_points_and_duties_that_fall_are_refused() {
    let refused =
        |points: &[[f64; 2]]| Predistortion { points: Some(points.iter().copied().collect()) }.check().unwrap_err().key;
    assert_eq!(refused(&[[1.0, -2.0], [2.0, 2.0]]), "number of predistortion.points");
    let falling = [[20.0, -200.0], [22.0, -100.0], [21.0, 0.0], [23.0, 300.0]];
    assert!(refused(&falling).contains("duty, rising"));
    let pushed = [[20.0, 200.0], [21.0, 300.0], [22.0, 400.0], [23.0, 500.0]];
    assert!(refused(&pushed).contains("smallest"));
    assert!(ORIGINAL.len() <= MAX_POINTS);
}
