use crate::gallery::{Gallery, apart, values};
use crate::page;
use airball::book::{Desk, Tables};
use plant::Effects;

fn project() -> Tables {
    toml::from_str(include_str!("../../config.toml")).unwrap()
}

#[test]
fn every_effect_of_the_catalogue_is_sound_at_the_size_that_is_shown_and_is_what_the_two_models_differ_by() {
    let model = project().plant.unwrap();
    for entry in Effects::CATALOGUE {
        let (belief, rig) = apart(entry, &model, &values(entry, &model));
        assert!(belief.effects.check().is_ok() && rig.effects.check().is_ok(), "{}", entry.name);
        assert!(belief.effects.values(entry.name).is_none() && rig.effects.values(entry.name).is_some());
        assert_ne!(values(entry, &model), entry.neutral(&model), "{} does nothing", entry.name);
    }
}

#[test]
fn a_page_has_the_equations_the_numbers_the_answer_and_the_mend_of_its_effect() {
    let tables = project();
    let gallery = Gallery::new(Desk::of(&tables), tables.plant.as_ref().unwrap(), 1).unwrap();
    let entry = Effects::built_in("dead_zone").unwrap();
    let exhibit = gallery.exhibit(entry).unwrap();
    let text = page::page(&exhibit);
    for part in ["u' = u − upper", "| `lower_percent` | -0.4 | -100 to 0 | 0 |", "**dead zone**", entry.mend] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let first = entry.similar[0];
    let told = text.find(&format!("- [wall friction](wall_friction.md): {}.", first.distinguished_by));
    assert!(told.is_some() && told < text.find("| effect | stage | gain, nats |"), "{text}");
    assert!(page::list(&[exhibit]).contains("| [dead zone](dead_zone.md) | actuator |"));
}

#[test]
fn a_config_that_cannot_fly_has_no_gallery() {
    let model = project().plant.unwrap();
    assert!(Gallery::new(None, &model, 1).unwrap_err().to_string().contains("[controller]"));
}
