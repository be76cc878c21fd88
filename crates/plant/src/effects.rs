//! The catalogue of effects. A new effect is its module and one line in each list below; config file,
//! simulator, diagnosis and report pick it up.

mod dead_zone;
mod duty_quantisation;
mod end_stop;
mod fan_lag;
mod force_asymmetry;
mod gain_drift;
mod height_dependent_flow;
mod hover_drift;
mod hysteresis;
mod quadratic_drag;
mod rate_limit;
mod relative_airflow;
mod saturation;
mod sensor_delay;
mod sensor_lag;
mod sensor_noise;
mod sensor_outliers;
mod sensor_quantisation;
mod spin_asymmetry;
mod stale_samples;
mod thrust_curve;
mod transport_delay;
mod turbulence;
mod wall_friction;

use crate::effect::{Effect, Entry};
use crate::unsound::Unsound;
use crate::written::{Definition, WrittenEffects};
use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};
use std::collections::BTreeMap;

// `$d` is a dollar sign: the macro writes another one, which has metavariables of its own.
macro_rules! catalogue {
    ($d:tt $($name:ident: $effect:ident),* $(,)?) => {
        $(pub use $name::$effect;)*

        /// The effects that are on. `None` is off; there are no other switches.
        #[derive(Clone, Debug, Default, PartialEq, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Effects {
            $(
                #[doc = concat!("See [`", stringify!($effect), "`].")]
                #[serde(default)]
                pub $name: Option<$effect>,
            )*
            /// Those that a user wrote.
            #[serde(skip)]
            pub written: WrittenEffects,
        }

        impl Serialize for Effects {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let mut map = serializer.serialize_map(None)?;
                $(
                    if let Some(effect) = &self.$name {
                        map.serialize_entry(stringify!($name), effect)?;
                    }
                )*
                for entry in self.written.present().map(Definition::entry) {
                    let values = self.values(entry.name).unwrap_or_default();
                    let named: BTreeMap<&str, f64> = entry.params.iter().map(|param| param.name).zip(values).collect();
                    map.serialize_entry(entry.name, &named)?;
                }
                map.end()
            }
        }

        impl Effects {
            /// Every built-in effect, in the order of the signal path.
            pub const CATALOGUE: &[Entry] = &[$(<$effect>::ENTRY.acting(<$effect>::ACTS.summary())),*];

            /// The entries of the effects that are on, in the order of the signal path.
            #[must_use]
            pub fn present(&self) -> Vec<&'static Entry> {
                let built_in = Self::CATALOGUE.iter().filter(|entry| self.values(entry.name).is_some());
                built_in.chain(self.written.present().map(Definition::entry)).collect()
            }

            /// The values of an effect that is on, in the order of its entry.
            #[must_use]
            pub fn values(&self, name: &str) -> Option<Vec<f64>> {
                match name {
                    $(stringify!($name) => self.$name.as_ref().map(Effect::values),)*
                    _ => self.written.values(name),
                }
            }

            /// Switches an effect on with these values, or changes them where it is on.
            /// False, and nothing has changed: there is no effect of that name.
            pub fn set(&mut self, name: &str, values: &[f64]) -> bool {
                match name {
                    $(
                        stringify!($name) => self.$name
                            .get_or_insert_with(|| <$effect>::from_values(values))
                            .set_values(values),
                    )*
                    _ => return self.written.set(name, values),
                }
                true
            }

            /// Switches an effect off. False: it was not on.
            pub fn remove(&mut self, name: &str) -> bool {
                match name {
                    $(stringify!($name) => self.$name.take().is_some(),)*
                    _ => self.written.remove(name),
                }
            }

            /// What an effect is, for people: the head of its module, with its equations in a fenced block; of a written
            /// one its formulas.
            #[must_use]
            pub fn physics(&self, name: &str) -> Option<String> {
                let source = match name {
                    $(stringify!($name) => include_str!(concat!("effects/", stringify!($name), ".rs")),)*
                    _ => return self.written.definition(name).map(Definition::physics),
                };
                let head = source.lines().map_while(|line| line.strip_prefix("//!"));
                Some(head.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>().join("\n"))
            }

            /// Checks the numbers of each effect that is on.
            fn check_each(&self) -> Result<(), (&'static str, Unsound)> {
                $(
                    if let Some(effect) = &self.$name {
                        effect.check().map_err(|error| (stringify!($name), error))?;
                    }
                )*
                self.written.check()
            }
        }

        /// Evaluates an expression for each effect that is on, in the order of the catalogue.
        macro_rules! for_each_effect {
            ($d effects:expr, $d effect:ident => $d body:expr) => {
                $(
                    if let Some($d effect) = &$d effects.$name {
                        $d body
                    }
                )*
            };
        }
        pub(crate) use for_each_effect;
    };
}

catalogue! {
    $
    transport_delay: TransportDelay,
    duty_quantisation: DutyQuantisation,
    rate_limit: RateLimit,
    dead_zone: DeadZone,
    hysteresis: Hysteresis,
    force_asymmetry: ForceAsymmetry,
    thrust_curve: ThrustCurve,
    saturation: Saturation,
    fan_lag: FanLag,
    spin_asymmetry: SpinAsymmetry,
    gain_drift: GainDrift,
    hover_drift: HoverDrift,
    height_dependent_flow: HeightDependentFlow,
    relative_airflow: RelativeAirflow,
    turbulence: Turbulence,
    quadratic_drag: QuadraticDrag,
    wall_friction: WallFriction,
    end_stop: EndStop,
    sensor_lag: SensorLag,
    sensor_delay: SensorDelay,
    sensor_noise: SensorNoise,
    sensor_outliers: SensorOutliers,
    sensor_quantisation: SensorQuantisation,
    stale_samples: StaleSamples,
}

impl Effects {
    /// The entry of the built-in effect of that name.
    #[must_use]
    pub fn built_in(name: &str) -> Option<&'static Entry> {
        Self::CATALOGUE.iter().find(|entry| entry.name == name)
    }

    /// Every effect that can be switched on here: the built-in ones, then those that a user wrote.
    pub fn catalogue(&self) -> impl Iterator<Item = &'static Entry> + use<> {
        let written: Vec<_> = self.written.definitions().map(Definition::entry).collect();
        Self::CATALOGUE.iter().chain(written)
    }

    /// The entry of that name, built-in or written.
    #[must_use]
    pub fn entry(&self, name: &str) -> Option<&'static Entry> {
        Self::built_in(name).or_else(|| self.written.definition(name).map(Definition::entry))
    }

    /// An effect that is on, with the values of its entry's parameters.
    #[must_use]
    pub fn get<E: Effect>(&self) -> Option<E> {
        self.values(E::ENTRY.name).map(|values| E::from_values(&values))
    }

    /// Whether two built-in effects fill the same place of the signal path, and cannot act together.
    #[must_use]
    pub fn exclude_each_other(one: &str, other: &str) -> bool {
        let both = Self::built_in(one).zip(Self::built_in(other));
        one != other && both.is_some_and(|(one, other)| one.acts.excludes(&other.acts))
    }

    /// Checks the numbers of every effect that is on, and that the effects go together.
    ///
    /// # Errors
    /// The effect's name and what is wrong with it.
    pub fn check(&self) -> Result<(), (&'static str, Unsound)> {
        let present = self.present();
        for (number, entry) in present.iter().enumerate() {
            if let Some(other) = present[..number].iter().find(|other| other.acts.excludes(&entry.acts)) {
                return Err((entry.name, Unsound::Exclusive { other: other.name }));
            }
        }
        self.check_each()
    }
}

#[cfg(test)]
mod tests;
