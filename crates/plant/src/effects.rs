//! The catalogue of effects. A new effect is its module here and one line in the list below; config file,
//! simulator, diagnosis and report pick it up.

mod dead_zone;
mod fan_lag;

pub use dead_zone::DeadZone;
pub use fan_lag::FanLag;

use crate::effect::{Effect, Entry};
use control::OutOfRange;
use serde::{Deserialize, Serialize};

macro_rules! catalogue {
    ($($name:ident: $effect:ty),* $(,)?) => {
        /// The effects that are on. `None` is off; there are no other switches.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Effects {
            $(
                #[doc = concat!("See [`", stringify!($effect), "`].")]
                #[serde(default, skip_serializing_if = "Option::is_none")]
                pub $name: Option<$effect>,
            )*
        }

        impl Effects {
            /// Every effect there is, in the order of the signal path.
            pub const CATALOGUE: &[Entry] = &[$(<$effect>::ENTRY),*];

            /// Checks the numbers of every effect that is on.
            ///
            /// # Errors
            /// The effect's name and its first number outside its bounds.
            pub fn check(&self) -> Result<(), (&'static str, OutOfRange)> {
                $(
                    if let Some(effect) = &self.$name {
                        effect.check().map_err(|error| (stringify!($name), error))?;
                    }
                )*
                Ok(())
            }

            /// The values of the effect `name`, in the order of its entry's parameters. `None`: it is off, or there is none.
            #[must_use]
            pub fn values(&self, name: &str) -> Option<Vec<f64>> {
                match name {
                    $(stringify!($name) => self.$name.as_ref().map(Effect::values),)*
                    _ => None,
                }
            }

            /// Switches the effect `name` on with these values. A name that is not in the catalogue changes nothing.
            pub fn set(&mut self, name: &str, values: &[f64]) {
                match name {
                    $(stringify!($name) => self.$name = Some(Effect::from_values(values)),)*
                    _ => {}
                }
            }

            /// Switches the effect `name` off.
            pub fn remove(&mut self, name: &str) {
                match name {
                    $(stringify!($name) => self.$name = None,)*
                    _ => {}
                }
            }

            /// The entries of the effects that are on, in the order of the signal path.
            #[must_use]
            pub fn present(&self) -> Vec<Entry> {
                let mut present = Vec::new();
                $(
                    if self.$name.is_some() {
                        present.push(<$effect>::ENTRY);
                    }
                )*
                present
            }
        }
    };
}

catalogue! {
    dead_zone: DeadZone,
    fan_lag: FanLag,
}

#[cfg(test)]
mod tests {
    use super::{Effects, FanLag};
    use crate::effect::{Effect, Stage};

    #[test]
    fn every_table_of_the_config_has_the_name_of_its_entry() {
        let effects = Effects { fan_lag: Some(FanLag { time_constant_s: 0.3 }), ..Effects::default() };
        assert_eq!(effects.present(), [FanLag::ENTRY]);
        assert_eq!(FanLag::ENTRY.name, "fan_lag");
    }

    #[test]
    fn the_catalogue_follows_the_signal_path_and_explains_every_entry() {
        let order = [Stage::Actuator, Stage::Air, Stage::Ball, Stage::Sensor];
        let place = |stage| order.iter().position(|s| *s == stage);
        assert!(Effects::CATALOGUE.is_sorted_by_key(|entry| place(entry.stage)));
        for entry in Effects::CATALOGUE {
            assert!(!entry.params.is_empty() && entry.in_a_log.len() > 20 && entry.mend.len() > 20, "{}", entry.name);
            for param in entry.params {
                assert!((param.min..=param.max).contains(&param.neutral), "{}.{}", entry.name, param.name);
            }
        }
    }

    #[test]
    fn a_number_outside_its_bounds_is_refused_by_effect_and_key() {
        let effects = Effects { fan_lag: Some(FanLag { time_constant_s: -0.1 }), ..Effects::default() };
        let (effect, error) = effects.check().unwrap_err();
        assert_eq!((effect, error.key, error.value), ("fan_lag", "time_constant_s", -0.1));
    }
}
