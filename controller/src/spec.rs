//! A version of the controller as data: which law, with which parameters.
//!
//! In: a version's name and TOML tables of overrides. Out: a checked [`Spec`], or an error that
//! names the key, the value and what is allowed.

use schemas::Scenario;

use crate::params::{Params, nearest};
use crate::version::versions;

/// Which feedback law drives when the person may not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// Law (11) for the kinematic model (1): inputs are velocities.
    Kinematic,
    /// Law (17) for the dynamic model (2): inputs are accelerations.
    Dynamic,
    /// None: the person drives always.
    Human,
}

impl Law {
    /// The name in reports, and of the scenario's table of overrides.
    pub fn name(self) -> &'static str {
        match self {
            Law::Kinematic => "kinematic",
            Law::Dynamic => "dynamic",
            Law::Human => "human",
        }
    }
}

/// A version of the controller, ready to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// Name of the version.
    pub name: String,
    /// Its law.
    pub law: Law,
    /// Its parameters, checked.
    pub params: Params,
}

/// Why a version of the controller cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpecError {
    /// No version has that name.
    #[error("unknown controller `{name}`; did you mean `{nearest}`? there are: {known}")]
    UnknownVersion {
        /// The name asked for.
        name: String,
        /// The existing name nearest to it.
        nearest: &'static str,
        /// All names.
        known: String,
    },
    /// No parameter has that key.
    #[error("unknown parameter `{key}`; did you mean `{nearest}`?")]
    UnknownKey {
        /// The key as given.
        key: String,
        /// The existing key nearest to it.
        nearest: &'static str,
    },
    /// The value is of another type or out of range.
    #[error("parameter `{key}` = {value}: expected {allowed}")]
    Value {
        /// The key.
        key: &'static str,
        /// The value as given.
        value: String,
        /// What it may be.
        allowed: String,
    },
    /// Two values that do not go together.
    #[error("parameter `{key}` = {value}: expected {allowed}, {because}")]
    Together {
        /// The key to change.
        key: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: String,
        /// What it is bound by.
        because: String,
    },
    /// Not TOML.
    #[error("parameters are not TOML")]
    Toml(#[from] toml::de::Error),
}

impl Spec {
    /// The version called `name`, with `overrides` laid over its defaults one after the other.
    ///
    /// # Errors
    /// No such version or parameter, or a value of another type or out of range.
    pub fn resolve(name: &str, overrides: &[&toml::Table]) -> Result<Spec, SpecError> {
        let Some(version) = versions().iter().find(|version| version.name == name) else {
            let names: Vec<&'static str> = versions().iter().map(|version| version.name).collect();
            return Err(SpecError::UnknownVersion {
                name: name.to_owned(),
                nearest: nearest(name, names.iter().copied()),
                known: names.join(", "),
            });
        };
        let mut params = Params::default();
        for (key, setting) in version.differences.iter().copied().flatten() {
            params.set(key, &(*setting).into())?;
        }
        for table in overrides {
            for (key, value) in *table {
                params.set(key, value)?;
            }
        }
        params.check_together()?;
        Ok(Spec { name: version.name.to_owned(), law: version.law, params })
    }

    /// The version called `name` as `scenario` wants it: the scenario's own overrides for that law
    /// over the version's defaults, and `overrides` over both.
    ///
    /// # Errors
    /// As [`Spec::resolve`].
    pub fn for_scenario(
        name: &str,
        scenario: &Scenario,
        overrides: &[&toml::Table],
    ) -> Result<Spec, SpecError> {
        let version = versions().iter().find(|version| version.name == name);
        let own = match version.map(|version| version.law) {
            Some(Law::Dynamic) => &scenario.controller.dynamic,
            _ => &scenario.controller.kinematic,
        };
        Spec::resolve(name, &[&[own], overrides].concat())
    }

    /// Every parameter as TOML, such that [`Spec::from_recorded`] gives back the same bits.
    pub fn params_toml(&self) -> String {
        let mut text = String::new();
        for (row, setting) in Params::table().iter().zip(self.params.settings()) {
            let value = toml::Value::from(setting);
            text.extend([row.key, " = ", &value.to_string(), "\n"]);
        }
        text
    }

    /// The version that a log says drove, with the parameters recorded there. A parameter that is
    /// newer than the log takes the version's default.
    ///
    /// # Errors
    /// Not TOML; otherwise as [`Spec::resolve`].
    pub fn from_recorded(name: &str, params_toml: &str) -> Result<Spec, SpecError> {
        let table: toml::Table = params_toml.parse()?;
        Spec::resolve(name, &[&table])
    }
}

impl Params {
    /// What no range of a single parameter can say.
    fn check_together(&self) -> Result<(), SpecError> {
        let pairs = [
            ("b2_task_m", self.b2_task_m, "b1_task_m", self.b1_task_m),
            ("b2_free_m", self.b2_free_m, "b1_free_m", self.b1_free_m),
        ];
        for (key, value, other, bound) in pairs {
            if value <= bound {
                return Err(SpecError::Together {
                    key,
                    value,
                    allowed: format!("more than {bound}"),
                    because: format!("which is `{other}`"),
                });
            }
        }
        Ok(())
    }
}
