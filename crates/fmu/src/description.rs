//! `modelDescription.xml` of an FMU.

use super::IDENTIFIER;
use super::variables::{Kind, Role, Variable};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// The units of inputs and outputs, by SI: exponents and factor.
const UNITS: &str = r#"  <UnitDefinitions>
    <Unit name="%"><BaseUnit factor="0.01"/></Unit>
    <Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>
    <Unit name="mm/s"><BaseUnit m="1" s="-1" factor="0.001"/></Unit>
    <Unit name="mm/s2"><BaseUnit m="1" s="-2" factor="0.001"/></Unit>
    <Unit name="rpm"><BaseUnit rad="1" s="-1" factor="0.10471975511965977"/></Unit>
  </UnitDefinitions>
"#;

/// The description of an FMU: its variables, and the period of its loop in seconds. The same content gives the same
/// text, its identifier included.
pub(super) fn description(variables: &[Variable], name: &str, period_s: f64, resources: &str) -> String {
    let body = body(variables, period_s);
    let digest: String =
        Sha256::digest([body.as_str(), resources].concat()).iter().take(16).map(|byte| format!("{byte:02x}")).collect();
    let version = env!("CARGO_PKG_VERSION");
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{{{digest}}}" generationTool="airball {version}"
  description="A ball held in a pipe by a fan: duty in, reading of the position out"
  variableNamingConvention="structured">
  <CoSimulation modelIdentifier="{IDENTIFIER}"
    canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true"/>
{body}</fmiModelDescription>
"#,
        name = escaped(name),
    )
}

fn body(variables: &[Variable], period_s: f64) -> String {
    let mut text = String::from(UNITS);
    // Writing to a text does not fail.
    let _ = writeln!(text, "  <DefaultExperiment startTime=\"0.0\" stopTime=\"60.0\" stepSize=\"{period_s:?}\"/>");
    text.push_str("  <ModelVariables>\n");
    for variable in variables {
        text.push_str(&line(variable));
    }
    text.push_str("  </ModelVariables>\n  <ModelStructure>\n    <Outputs>\n");
    let outputs = variables.iter().enumerate().filter(|(_, variable)| variable.role == Role::Output);
    let unknowns: String =
        outputs.map(|(at, _)| format!("      <Unknown index=\"{}\" dependencies=\"\"/>\n", at + 1)).collect();
    let _ = write!(text, "{unknowns}    </Outputs>\n    <InitialUnknowns>\n{unknowns}    </InitialUnknowns>\n");
    text.push_str("  </ModelStructure>\n");
    text
}

fn line(variable: &Variable) -> String {
    let Variable { name, reference, kind, role, unit, description, start } = variable;
    let (causality, variability) = match (role, kind) {
        (Role::Input, Kind::Real) => ("input", "continuous"),
        (Role::Input, _) => ("input", "discrete"),
        (Role::Output, Kind::Real) => ("output", "continuous"),
        (Role::Output, _) => ("output", "discrete"),
        (Role::Parameter, _) => ("parameter", "fixed"),
    };
    // Every output follows from the parameters, and has no value before.
    let start = match (role, kind) {
        (Role::Output, _) => String::new(),
        (_, Kind::Real) => format!(" start=\"{start:?}\""),
        (_, Kind::Integer) => format!(" start=\"{start:.0}\""),
        (_, Kind::Boolean) => format!(" start=\"{}\"", *start != 0.0),
    };
    let initial = match role {
        Role::Output => " initial=\"calculated\"",
        Role::Parameter => " initial=\"exact\"",
        Role::Input => "",
    };
    let unit = unit.map_or(String::new(), |unit| format!(" unit=\"{unit}\""));
    let tag = match kind {
        Kind::Real => "Real",
        Kind::Integer => "Integer",
        Kind::Boolean => "Boolean",
    };
    format!(
        "    <ScalarVariable name=\"{}\" valueReference=\"{reference}\" causality=\"{causality}\" \
         variability=\"{variability}\"{initial} description=\"{}\"><{tag}{start}{unit}/></ScalarVariable>\n",
        escaped(name),
        escaped(description)
    )
}

/// Text inside an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
