//! Hypotheses: effects whose physics is a text, written by the user.
//!
//! A [`Hypothesis`] is parsed, checked and compiled once. The registry is the list `Robot::hypotheses` of texts: what is
//! attached to a robot knows the catalogue and the hypotheses of that robot, no other. As an [`Effect`] it is the same for
//! every robot that carries the same text, as the effects of the catalogue are, and lives as long as they do.

mod as_text;
mod check;
mod fault;
mod file;
mod formula;
mod known;
mod quantity;
mod unit;

use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{CablePort, PlatformPort, Scope, Search, Stage};
use super::{CablePorts, Dual, Effect, EffectParameter, PlatformPorts, RowContexts, TextPhysics};
use crate::measurement::Variable;
pub use as_text::NotAsText;
pub use fault::{HypothesisError, line_and_column};
pub use formula::formula_functions;
use formula::{Circumstances, Program};
pub use known::{HypothesisNotAdded, MAX_HYPOTHESES};
pub use quantity::{FORMULA_QUANTITIES, FORMULA_TARGETS, FormulaQuantity, FormulaTarget};

#[cfg(test)]
pub(crate) use tests::CROSSTALK;

/// Most bytes of a hypothesis file.
pub const MAX_HYPOTHESIS_BYTES: usize = 64 * 1024;

/// A hypothesis of the user: an effect whose physics is a text.
#[derive(Clone)]
pub struct Hypothesis {
    definition: Arc<Definition>,
}

/// Formulas of the ports that a hypothesis changes.
#[derive(Debug, Clone, Default)]
struct Formulas {
    cable: Vec<(CablePort, Program)>,
    platform: Vec<(PlatformPort, Program)>,
}

/// A parameter, with texts that it owns.
#[derive(Debug, Clone)]
struct ParameterDefinition {
    name: String,
    unit: String,
    /// All but its name and unit.
    values: EffectParameter,
}

/// A checked hypothesis.
#[derive(Debug, Clone)]
struct Definition {
    text: String,
    id: String,
    title: String,
    scope: Scope,
    cause: String,
    workshop: String,
    check: Option<String>,
    source: Option<String>,
    stage: Stage,
    search: Search,
    variable: Option<Variable>,
    is_damage: bool,
    parameters: Vec<ParameterDefinition>,
    formulas: Formulas,
    /// Prior expectation of the number of such causes, if the file states one.
    prior: Option<f64>,
}

impl Hypothesis {
    /// Parses and checks the text of a hypothesis file.
    ///
    /// # Errors
    /// The first mistake, with its line and column.
    pub fn parse(text: &str) -> Result<Self, HypothesisError> {
        let definition = file::parse(text).map_err(|fault| fault.in_text(text))?;
        Ok(Self {
            definition: Arc::new(definition),
        })
    }

    /// The text of the file.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.definition.text
    }

    /// Identifier, used like that of an effect of the catalogue.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.definition.id
    }

    /// Plain title.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.definition.title
    }

    /// Prior expectation of the number of such causes that the file asks for.
    #[must_use]
    pub fn prior(&self) -> Option<f64> {
        self.definition.prior
    }

    /// The effect. The same text is always the same effect, so that effects can be compared by address; its memory is never
    /// freed, like that of the catalogue.
    #[must_use]
    pub fn effect(&self) -> &'static Effect {
        let mut effects = EFFECTS.lock().unwrap_or_else(PoisonError::into_inner);
        let effects = effects.get_or_insert_default();
        if let Some(effect) = effects.get(self.text()) {
            return effect;
        }
        let effect = Definition::clone(&self.definition).into_effect();
        effects.insert(self.text().to_owned(), effect);
        effect
    }
}

/// The effects of all texts that were used as one.
static EFFECTS: Mutex<Option<HashMap<String, &'static Effect>>> = Mutex::new(None);

/// The effect of a text; `None` if it is no hypothesis.
fn effect_of(text: &str) -> Option<&'static Effect> {
    let effects = EFFECTS.lock().unwrap_or_else(PoisonError::into_inner);
    let known = effects
        .as_ref()
        .and_then(|effects| effects.get(text).copied());
    drop(effects);
    known.or_else(|| Some(Hypothesis::parse(text).ok()?.effect()))
}

impl Definition {
    /// The effect, for the rest of the program's life.
    fn into_effect(self) -> &'static Effect {
        let definition: &'static Self = Box::leak(Box::new(self));
        let parameters = definition.parameters.iter().map(|p| EffectParameter {
            name: &p.name,
            unit: &p.unit,
            ..p.values
        });
        let parameters: Vec<EffectParameter> = parameters.collect();
        Box::leak(Box::new(Effect {
            id: &definition.id,
            title: &definition.title,
            scope: definition.scope,
            parameters: parameters.leak(),
            cause: |found| found.say(found.sentences_of_text()[0]),
            workshop: |found| found.say(found.sentences_of_text()[1]),
            check: definition.check.as_deref(),
            source: definition
                .source
                .as_deref()
                .unwrap_or("Hypothesis of the user"),
            stage: definition.stage,
            search: definition.search,
            variable: definition.variable,
            is_damage: definition.is_damage,
            needs_sag: definition.formulas.changes(CablePort::Weight),
            text_physics: Some(definition),
            ..Effect::NEUTRAL
        }))
    }
}

impl Formulas {
    /// Whether any formula changes this port of the cables.
    fn changes(&self, port: CablePort) -> bool {
        self.cable.iter().any(|(changed, _)| *changed == port)
    }

    /// Largest number of a cable in the formulas, counted from 1; 0 without one.
    fn highest_cable(&self) -> usize {
        let named = self.programs().map(|program| program.highest_cable);
        named.max().unwrap_or(0)
    }

    fn programs(&self) -> impl Iterator<Item = &Program> {
        let of_cable = self.cable.iter().map(|(_, program)| program);
        of_cable.chain(self.platform.iter().map(|(_, program)| program))
    }
}

impl TextPhysics for Definition {
    fn text(&self) -> &str {
        &self.text
    }

    fn sentences(&self) -> [&str; 2] {
        [&self.cause, &self.workshop]
    }

    fn prior(&self) -> Option<f64> {
        self.prior
    }

    fn needs_motion(&self) -> bool {
        self.formulas.programs().any(|program| program.uses_motion)
    }

    fn highest_cable(&self) -> usize {
        self.formulas.highest_cable()
    }

    /// A formula without a finite value, as after a division by a missing reading, changes nothing.
    fn change_cable(
        &self,
        values: &[Dual],
        row: RowContexts<'_>,
        (cable, targets): (usize, &[usize]),
        ports: &mut CablePorts,
    ) {
        let at = Circumstances {
            cables: row.cables,
            platform: row.platform,
            cable: Some(cable),
            targets,
        };
        for (port, program) in &self.formulas.cable {
            if let Some(value) = program.evaluate(values, ports.get(*port), &at) {
                *ports.get_mut(*port) = value;
            }
        }
    }

    fn change_platform(&self, values: &[Dual], row: RowContexts<'_>, ports: &mut PlatformPorts) {
        let at = Circumstances {
            cables: row.cables,
            platform: row.platform,
            cable: None,
            targets: &[],
        };
        for (port, program) in &self.formulas.platform {
            if let Some(value) = program.evaluate(values, ports.get(*port), &at) {
                *ports.get_mut(*port) = value;
            }
        }
    }
}

impl PartialEq for Hypothesis {
    fn eq(&self, other: &Self) -> bool {
        self.text() == other.text()
    }
}

impl fmt::Debug for Hypothesis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Hypothesis").field(&self.id()).finish()
    }
}

impl Serialize for Hypothesis {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.text())
    }
}

impl<'de> Deserialize<'de> for Hypothesis {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Self::parse(&text).map_err(D::Error::custom)
    }
}

impl JsonSchema for Hypothesis {
    fn schema_name() -> Cow<'static, str> {
        "Hypothesis".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "string",
            "description": "Text of a hypothesis file (TOML): an effect whose physics is a text."
        })
    }
}

#[cfg(test)]
mod tests;
