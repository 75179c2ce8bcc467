//! `C` on the command line: `tandem-kinematic`, `tandem-kinematic:gamma3=2.1`,
//! `tandem-kinematic:PARAMS.toml`, `human`, `recorded`.

use std::fs;
use std::path::Path;
use std::str::FromStr;

use anyhow::{Context as _, Result, anyhow, bail, ensure};
use controller::Spec;
use schemas::{Header, Scenario};
use toml::{Table, Value};

/// Which controller is meant, before a scenario has said its word.
#[derive(Clone, Debug, PartialEq)]
pub enum ControllerChoice {
    /// What is in the log: the recording controller, or its outputs.
    Recorded,
    /// A version by name, with parameters of one's own.
    Version {
        /// As typed, for reports and file names.
        typed: String,
        /// Name of the version.
        name: String,
        /// Parameters set on the command line or in a file.
        overrides: Table,
    },
}

impl ControllerChoice {
    /// As typed.
    pub fn label(&self) -> &str {
        match self {
            ControllerChoice::Recorded => "recorded",
            ControllerChoice::Version { typed, .. } => typed,
        }
    }

    /// The choice with its parameters for a new session in `scenario`.
    pub fn for_scenario(&self, scenario: &Scenario) -> Result<Spec> {
        match self {
            ControllerChoice::Recorded => {
                bail!("`recorded` names the outputs in a log; name a controller to run")
            }
            ControllerChoice::Version { name, overrides, .. } => {
                Ok(Spec::for_scenario(name, scenario, &[overrides])?)
            }
        }
    }

    /// The choice for a replay of a log: the recorded controller comes back with its recorded
    /// parameters, any other with today's defaults, the log's scenario and its own parameters.
    pub fn for_log(&self, header: &Header) -> Result<Spec> {
        match self {
            ControllerChoice::Recorded => {
                Ok(Spec::from_recorded(&header.run.controller, &header.params_toml)?)
            }
            ControllerChoice::Version { .. } => self.for_scenario(&header.scenario),
        }
    }
}

impl FromStr for ControllerChoice {
    type Err = anyhow::Error;

    fn from_str(typed: &str) -> Result<Self> {
        // Whoever prints the error may print its outermost line alone.
        parse(typed).map_err(|error| anyhow!("{error:#}"))
    }
}

fn parse(typed: &str) -> Result<ControllerChoice> {
    if typed == "recorded" {
        return Ok(ControllerChoice::Recorded);
    }
    let (name, parameters) = match typed.split_once(':') {
        None => (typed, None),
        Some((name, parameters)) => (name, Some(parameters)),
    };
    for unsupported in ["rev", "cmd", "wasm"] {
        if name == unsupported && parameters.is_some() {
            bail!("controllers of the kind `{unsupported}:` are not supported by this version");
        }
    }
    let overrides = match parameters {
        None => Table::new(),
        Some(file) if Path::new(file).extension().is_some_and(|e| e == "toml") => {
            let text = fs::read_to_string(file)
                .with_context(|| format!("cannot read parameters {file}"))?;
            toml::from_str(&text).with_context(|| format!("parameters {file}"))?
        }
        Some(list) => parse_assignments(list)?,
    };
    // Name, keys and ranges are wrong whatever the log is: say so before reading one.
    Spec::resolve(name, &[&overrides])?;
    Ok(ControllerChoice::Version { typed: typed.to_owned(), name: name.to_owned(), overrides })
}

/// `key=value,key=value`; a value is a number, a boolean, or a bare word.
fn parse_assignments(list: &str) -> Result<Table> {
    let mut table = Table::new();
    for assignment in list.split(',') {
        let (key, value) = assignment.split_once('=').ok_or_else(|| {
            anyhow!("`{assignment}` is not a parameter: write key=value, or name a .toml file")
        })?;
        let value = value.trim();
        let value = if let Ok(integer) = value.parse::<i64>() {
            Value::Integer(integer)
        } else if let Ok(number) = value.parse::<f64>() {
            Value::Float(number)
        } else if let Ok(flag) = value.parse::<bool>() {
            Value::Boolean(flag)
        } else {
            Value::String(value.to_owned())
        };
        let before = table.insert(key.trim().to_owned(), value);
        ensure!(before.is_none(), "`{}` is given twice: say which value", key.trim());
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assignments_are_typed() {
        let table = parse_assignments("gamma3=2.1, frame=ref").unwrap();
        assert_eq!(table["gamma3"], Value::Float(2.1));
        assert_eq!(table["frame"], Value::String("ref".to_owned()));
        assert!(parse_assignments("gamma3").is_err());
        let twice = parse_assignments("gamma3=1,gamma3=5").unwrap_err();
        assert_eq!(twice.to_string(), "`gamma3` is given twice: say which value");
    }

    #[test]
    fn unknown_names_and_values_out_of_range_are_refused_at_once() {
        assert!("no-such-controller".parse::<ControllerChoice>().is_err());
        assert!("tandem-kinematic:gamma3=-1".parse::<ControllerChoice>().is_err());
        assert!("tandem-kinematic:gama3=2".parse::<ControllerChoice>().is_err());
    }
}
