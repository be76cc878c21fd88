use super::{Abscissa, Binned, EffectCurve};
use crate::tests_support::{model, record, shaken};
use crate::{Options, Recording, Series, diagnose};
use plant::Model;

fn curves(belief: &Model, recording: &Recording) -> Vec<EffectCurve> {
    let found = diagnose(belief, recording, &Options::default());
    Series::of(&found, belief, recording).effects
}

/// The share of bins whose interval holds the true value.
fn held(bins: &[Binned], truth: impl Fn(f64) -> f64) -> f64 {
    let held = bins.iter().filter(|bin| (bin.low..bin.high).contains(&truth(bin.at))).count();
    held as f64 / bins.len() as f64
}

#[test]
fn the_bins_of_a_dead_zone_show_the_force_of_the_rig_over_the_duty() {
    let mut rig = model();
    rig.effects.set("dead_zone", &[-0.3, 0.3]);
    let curves = curves(&model(), &record(&rig, 3, 80));
    let [curve] = curves.as_slice() else { panic!("{curves:?}") };
    assert_eq!((curve.effect, curve.over), ("dead_zone", Abscissa::Duty));
    let truth = |duty: f64| rig.commanded(duty);
    assert!(curve.bins.len() > 8 && held(&curve.bins, truth) > 0.7, "{:?}", curve.bins);
    // Inside the zone the belief has a force where the record has none.
    let inside = curve.mended.iter().zip(&curve.believed).find(|(point, _)| point[0] > 21.6).unwrap();
    assert!(inside.0[1].abs() < 15.0 && inside.1.1 > 40.0, "{inside:?}");
}

/// The curve over this signal, of a rig with one effect that the belief lacks. A twin may have its name.
fn alone(name: &str, values: &[f64], over: Abscissa, fly: fn(&Model, u64, u32) -> Recording) -> (Model, EffectCurve) {
    let mut rig = model();
    assert!(rig.effects.set(name, values));
    let curves = curves(&model(), &fly(&rig, 3, 80));
    let said = format!("{name}: {:?}", curves.iter().map(|curve| (curve.effect, curve.over)).collect::<Vec<_>>());
    (rig, curves.into_iter().find(|curve| curve.over == over).expect(&said))
}

#[test]
fn each_kind_of_effect_is_drawn_over_the_signal_that_it_depends_on_and_holds_the_truth_there() {
    let (_, friction) = alone("wall_friction", &[60.0], Abscissa::Speed, record);
    let fast: Vec<Binned> = friction.bins.iter().filter(|bin| bin.at.abs() > 40.0).copied().collect();
    // Beside the drag of the rig, from which that of the mended model hardly differs.
    let truth = |v: f64| -60.0 * v.signum();
    assert!(fast.len() > 3 && held(&fast, truth) > 0.6, "{fast:?}");

    let (rig, leak) = alone("height_dependent_flow", &[1.5], Abscissa::Height, record);
    let truth = |mm: f64| rig.force_at_rest(mm);
    assert!(held(&leak.bins, truth) > 0.7, "{:?}", leak.bins);

    let (rig, drift) = alone("gain_drift", &[0.01], Abscissa::GainOverTime, shaken);
    let truth = |s: f64| rig.gain_mm_per_s2_per_percent * (1.0 + 0.01 * s);
    assert!(held(&drift.bins, truth) > 0.7, "{:?}", drift.bins);

    let (_, late) = alone("transport_delay", &[0.1], Abscissa::AfterDuty, shaken);
    // A duty of slow sines tells nothing about single tenths of a second: bins that are too uncertain are left out.
    let at = |after_s: f64| late.mended.iter().find(|point| point[0] >= after_s).unwrap();
    assert!(at(0.07)[1] == 0.0 && at(0.13)[1] == 1.0, "{:?}", late.mended);
    assert!(late.believed.iter().all(|(_, share)| *share == 1.0));
    assert!(late.bins.iter().all(|bin| bin.high - bin.low < 1.0), "{:?}", late.bins);
}
