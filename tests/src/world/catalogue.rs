//! The effect names of a truth, and the size of a drawn effect: from barely to clearly visible.

use crate::chance::Chance;
use serde::Serialize;
use std::collections::BTreeMap;

/// An effect by its catalogue name, with the values of its catalogue parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Effect {
    /// Name in the catalogue, or of a kind outside it.
    pub(crate) name: &'static str,
    /// Equivalent values; `forms/` defines in which sense.
    pub(crate) parameters: BTreeMap<&'static str, f64>,
}

impl Effect {
    /// An effect with these parameters.
    pub(crate) fn new(name: &'static str, parameters: &[(&'static str, f64)]) -> Self {
        Self { name, parameters: parameters.iter().copied().collect() }
    }

    /// The value of a parameter that this effect has.
    pub(crate) fn get(&self, parameter: &str) -> f64 {
        self.parameters[parameter]
    }
}

/// Stage and name of everything in the catalogue, along the signal path.
pub(crate) const CATALOGUE: [(&str, &str); 23] = [
    ("actuator", "transport_delay"),
    ("actuator", "duty_quantisation"),
    ("actuator", "dead_zone"),
    ("actuator", "hysteresis"),
    ("actuator", "force_asymmetry"),
    ("actuator", "thrust_curve"),
    ("actuator", "saturation"),
    ("actuator", "fan_lag"),
    ("actuator", "spin_asymmetry"),
    ("actuator", "gain_drift"),
    ("actuator", "hover_drift"),
    ("air", "height_dependent_flow"),
    ("air", "relative_airflow"),
    ("air", "turbulence"),
    ("ball", "quadratic_drag"),
    ("ball", "wall_friction"),
    ("ball", "end_stop"),
    ("sensor", "sensor_lag"),
    ("sensor", "sensor_delay"),
    ("sensor", "sensor_noise"),
    ("sensor", "sensor_outliers"),
    ("sensor", "sensor_quantisation"),
    ("sensor", "stale_samples"),
];

/// Stage and name of the effects outside the catalogue.
pub(crate) const OUTSIDE: [(&str, &str); 13] = [
    ("actuator", "late_writes"),
    ("actuator", "stuck_driver"),
    ("actuator", "supply_ripple"),
    ("actuator", "supply_sag"),
    ("actuator", "duty_dependent_lag"),
    ("actuator", "pipe_resonance"),
    ("air", "gusts"),
    ("air", "limit_cycle"),
    ("air", "height_ripple"),
    ("ball", "spin_lift"),
    ("ball", "sticky_zone"),
    ("sensor", "mount_backlash"),
    ("sensor", "mount_slip"),
];

/// The static name and the stage of an effect, inside the catalogue or outside.
pub(crate) fn find(name: &str) -> Option<(&'static str, &'static str)> {
    CATALOGUE.iter().chain(&OUTSIDE).find(|(_, known)| *known == name).copied()
}

/// Whether the catalogue has it.
pub(crate) fn inside(name: &str) -> bool {
    CATALOGUE.iter().any(|(_, known)| *known == name)
}

/// Every name inside the catalogue and outside.
pub(crate) fn all_names() -> Vec<&'static str> {
    CATALOGUE.iter().chain(&OUTSIDE).map(|(_, name)| *name).collect()
}

/// The range of the setpoints of a flight and its length, which determine the sizes of visible effects.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Lowest setpoint, mm.
    pub(crate) low_mm: f64,
    /// Highest setpoint, mm.
    pub(crate) high_mm: f64,
    /// Length, s.
    pub(crate) seconds: f64,
}

/// Draws the size of an effect of the catalogue or outside it.
pub(crate) fn draw(name: &'static str, c: &mut Chance, reach: Reach) -> Effect {
    if inside(name) { inside_draw(name, c, reach) } else { outside_draw(name, c, reach) }
}

fn inside_draw(name: &'static str, c: &mut Chance, reach: Reach) -> Effect {
    let parameters: &[(&'static str, f64)] = &match name {
        "transport_delay" | "sensor_delay" => vec![("delay_s", c.scale(0.025, 0.14))],
        "duty_quantisation" => vec![("step_percent", c.scale(0.4, 1.6))],
        "dead_zone" => {
            let width = c.scale(0.18, 0.6);
            vec![("lower_percent", -width * c.between(0.6, 1.4)), ("upper_percent", width)]
        }
        "hysteresis" => vec![("half_width_percent", c.scale(0.15, 0.6))],
        "force_asymmetry" => vec![("up_over_down", c.scale(1.3, 2.2).powf(c.sign()))],
        "thrust_curve" => {
            let up = c.happens(0.6);
            vec![("curvature_per_percent", if up { c.scale(0.012, 0.05) } else { -c.scale(0.008, 0.016) })]
        }
        "saturation" => {
            let (low, high) = (c.scale(70.0, 350.0), c.scale(70.0, 350.0));
            vec![("lower_mm_per_s2", -low), ("upper_mm_per_s2", high)]
        }
        "fan_lag" => vec![("time_constant_s", c.scale(0.06, 0.3))],
        "spin_asymmetry" => {
            let up = c.scale(0.06, 0.2);
            vec![("up_s", up), ("down_s", up * c.scale(1.8, 4.0))]
        }
        "gain_drift" => vec![("fraction_per_s", c.sign() * c.scale(0.18, 0.65) / reach.seconds)],
        "hover_drift" => vec![("percent_per_s", c.sign() * c.scale(0.12, 1.2) / reach.seconds)],
        "height_dependent_flow" => vec![("gradient_per_s2", c.scale(0.2, 2.2)), ("centre_mm", 300.0)],
        "relative_airflow" => vec![("inverse_speed_s_per_mm", c.scale(6e-4, 3e-3))],
        "turbulence" => vec![("sigma_mm_per_s2", c.scale(15.0, 60.0)), ("correlation_s", c.scale(0.2, 1.5))],
        "quadratic_drag" => vec![("coefficient_per_mm", c.scale(0.005, 0.04))],
        "wall_friction" => vec![("acceleration_mm_per_s2", c.scale(8.0, 60.0))],
        "end_stop" => {
            let (top, over) = (c.happens(0.5), c.between(-20.0, 15.0));
            let (bottom, top) = if top { (0.0, reach.high_mm + over) } else { (reach.low_mm - over, 600.0) };
            vec![("bottom_mm", bottom), ("top_mm", top), ("restitution", c.between(0.2, 0.75))]
        }
        "sensor_lag" => vec![("time_constant_s", c.scale(0.04, 0.2))],
        "sensor_noise" => vec![("sigma_mm", c.scale(1.0, 6.0))],
        "sensor_outliers" => vec![("probability", c.scale(0.008, 0.06)), ("size_mm", c.scale(20.0, 100.0))],
        "sensor_quantisation" => vec![("step_mm", c.scale(5.0, 20.0))],
        "stale_samples" => vec![("hold_s", c.scale(0.05, 0.15))],
        other => unreachable!("{other} is not in the catalogue"),
    };
    Effect::new(name, parameters)
}

fn outside_draw(name: &'static str, c: &mut Chance, reach: Reach) -> Effect {
    let parameters: &[(&'static str, f64)] = &match name {
        "late_writes" => vec![("up_to_s", c.between(0.15, 0.3))],
        "stuck_driver" => vec![("every_s", c.between(4.0, 9.0)), ("for_s", c.between(0.6, 1.1))],
        "supply_ripple" => vec![("fraction", c.between(0.45, 0.8)), ("period_s", c.between(7.0, 25.0))],
        "supply_sag" => vec![("share", c.scale(0.1, 0.45)), ("recovery_s", c.scale(1.5, 8.0))],
        "duty_dependent_lag" => {
            vec![("at_hover_s", c.between(0.15, 0.3)), ("halves_per_percent", c.between(0.25, 0.6))]
        }
        "pipe_resonance" => vec![("frequency_hz", c.between(0.9, 2.2)), ("share", c.between(0.4, 0.6))],
        "gusts" => vec![("every_s", c.between(5.0, 12.0)), ("size_mm_per_s2", c.between(140.0, 350.0))],
        "limit_cycle" => vec![("frequency_hz", c.between(0.5, 1.6)), ("size_mm_per_s2", c.between(60.0, 160.0))],
        "height_ripple" => vec![("size_mm_per_s2", c.between(50.0, 130.0)), ("wave_mm", c.between(30.0, 60.0))],
        "spin_lift" => vec![("size_mm_per_s2", c.between(80.0, 180.0)), ("wave_mm_per_s", c.between(50.0, 120.0))],
        "sticky_zone" => {
            let centre = c.between(reach.low_mm + 15.0, reach.high_mm - 15.0);
            vec![
                ("centre_mm", centre),
                ("half_width_mm", c.between(12.0, 25.0)),
                ("size_mm_per_s2", c.between(120.0, 260.0)),
            ]
        }
        "mount_backlash" => vec![("half_width_mm", c.between(4.0, 10.0))],
        "mount_slip" => vec![("every_s", c.between(10.0, 25.0)), ("size_mm", c.between(8.0, 20.0))],
        other => unreachable!("{other} has no form"),
    };
    Effect::new(name, parameters)
}
