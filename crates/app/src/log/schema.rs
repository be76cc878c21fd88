//! The JSON Schema of a channel, in the subset that viewers support.
//!
//! Foxglove's reader of JSON channels accepts properties with one plain `type` only: a list of types, a `$ref` or a
//! `oneOf` of words makes it refuse the whole channel; it accepts an object of plain properties and a list of numbers.
//! So an optional quantity is a plain number that may be absent, and a word is a string with an `enum`.
//! Source: `parseJsonSchema.ts` of Foxglove Studio, package `mcap-support`.

use schemars::{JsonSchema, Schema, generate::SchemaSettings, transform::transform_subschemas};
use serde_json::{Value, json};

/// The schema of `T` as the bytes of an MCAP schema record.
pub(super) fn of<T: JsonSchema>() -> Vec<u8> {
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true).with_transform(plain);
    settings.into_generator().into_root_schema_for::<T>().to_value().to_string().into_bytes()
}

fn plain(schema: &mut Schema) {
    transform_subschemas(&mut plain, schema);
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|kind| kind != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            schema.insert("type".into(), only);
        }
    }
    if let Some(Value::Array(words)) = schema.get("oneOf") {
        let words: Option<Vec<Value>> = words.iter().map(|word| word.get("const").cloned()).collect();
        if let Some(words) = words {
            schema.remove("oneOf");
            schema.insert("type".into(), json!("string"));
            schema.insert("enum".into(), json!(words));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::of;
    use crate::flight::vocabulary::Cycle;
    use crate::log::event::EventMessage;
    use serde_json::{Value, json};

    /// Whether a viewer takes it: a plain type, an object of such, or a list of numbers.
    fn is_plain(property: &Value) -> bool {
        let one_of = |kinds: &[&str], of: &Value| kinds.iter().any(|kind| of["type"] == **kind);
        let inside = || property["properties"].as_object().is_some_and(|inner| inner.values().all(is_plain));
        let nested = property["type"] == "object" && inside();
        let list = property["type"] == "array" && one_of(&["number", "integer"], &property["items"]);
        property.get("oneOf").is_none() && (one_of(&["number", "string", "boolean"], property) || nested || list)
    }

    #[test]
    fn every_property_has_one_plain_type() {
        for bytes in [of::<Cycle>(), of::<EventMessage>()] {
            let schema: Value = serde_json::from_slice(&bytes).unwrap();
            assert_eq!(schema["type"], "object");
            for (name, property) in schema["properties"].as_object().unwrap() {
                assert!(is_plain(property), "{name}: {property}");
            }
        }
    }

    #[test]
    fn modes_are_listed_and_what_may_be_absent_is_not_required() {
        let schema: Value = serde_json::from_slice(&of::<Cycle>()).unwrap();
        let modes = json!(["waiting", "flying", "open_loop", "coasting", "stopped"]);
        assert_eq!(schema["properties"]["mode"]["enum"], modes);
        let required = schema["required"].as_array().unwrap();
        assert!(required.contains(&json!("duty_percent")) && !required.contains(&json!("position_mm")), "{required:?}");
    }
}
