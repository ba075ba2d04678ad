//! Hypothesis files: the keys and their permitted values.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::super::found::unknown_field;
use super::super::{EffectParameter, Scope, Search, Stage, find};
use super::check;
use super::fault::{Fault, nearest};
use super::formula::{Names, Program, Variable, is_reserved};
use super::quantity::{FORMULA_TARGETS, Port, target};
use super::unit::{Dimension, Unit};
use super::{Definition, Formulas, MAX_HYPOTHESIS_BYTES, ParameterDefinition};
use crate::measurement;

/// Most parameters, and most characters of a sentence.
const MAX_PARAMETERS: usize = 8;
const MAX_CHARACTERS: usize = 1000;
/// Unit of a parameter that is the label of a pose.
const POSE: &str = "pose";
/// Largest prior that a file may ask for.
const MAX_PRIOR: f64 = 1.0;

type Text = Spanned<String>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    id: Option<Text>,
    title: Option<Text>,
    scope: Option<Text>,
    cause: Option<Text>,
    workshop: Option<Text>,
    check: Option<Text>,
    source: Option<Text>,
    stage: Option<Text>,
    variable: Option<Text>,
    #[serde(default)]
    damage: bool,
    prior: Option<Spanned<f64>>,
    #[serde(default)]
    parameters: BTreeMap<Text, ParameterEntry>,
    #[serde(default)]
    change: BTreeMap<Text, Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParameterEntry {
    unit: Option<Text>,
    typical: Option<Spanned<[f64; 2]>>,
    neutral: Option<Spanned<f64>>,
    start: Option<Spanned<f64>>,
    bounds: Option<Spanned<[f64; 2]>>,
    prior_sd: Option<Spanned<f64>>,
    role: Option<Text>,
}

/// Role of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Role {
    Size,
    Phase,
    Period,
    Pose,
}

/// A parameter of the file, with the place of its name.
struct Parameter {
    definition: ParameterDefinition,
    unit: Unit,
    role: Role,
    at: usize,
}

/// Target and permitted formulas of a scope in a file.
struct FileScope {
    scope: Scope,
    /// Whether formulas of this scope may change the quantity with a name.
    permits: fn(&str) -> bool,
    /// The permitted quantities, for messages.
    permitted: &'static str,
}

static SCOPES: [(&str, FileScope); 6] = [
    ("cable", of_cables(Scope::Cable)),
    ("cable_or_all", of_cables(Scope::CableOrAll)),
    ("cable_pair", of_cables(Scope::Pair)),
    (
        "tension",
        FileScope {
            scope: Scope::Cable,
            permits: |name| name == "tension",
            permitted: "tension",
        },
    ),
    (
        "laser",
        FileScope {
            scope: Scope::Robot,
            permits: |name| name.starts_with("laser_"),
            permitted: "laser_gain or laser_bias",
        },
    ),
    (
        "robot",
        FileScope {
            scope: Scope::Robot,
            permits: |_| true,
            permitted: "",
        },
    ),
];

const fn of_cables(scope: Scope) -> FileScope {
    FileScope {
        scope,
        permits: |name| target(name).is_some_and(|t| t.is_of_cable()),
        permitted: "a quantity of the cables such as paid",
    }
}

/// Parses and checks the text of a hypothesis file.
pub(super) fn parse(text: &str) -> Result<Definition, Fault> {
    if text.len() > MAX_HYPOTHESIS_BYTES {
        let message = format!(
            "found {} bytes, expected at most {MAX_HYPOTHESIS_BYTES}",
            text.len()
        );
        return Err(Fault::new(0, message));
    }
    let file: File = toml::from_str(text).map_err(|error| not_toml(&error))?;
    let reader = Reader { text };
    let id = reader.id(&file)?;
    let title = reader.sentence(&file.title, "title")?;
    let scope = reader.scope(&file)?;
    let parameters = reader.parameters(&file)?;
    let formulas = reader.formulas(&file, scope, &parameters)?;
    let search = search(&formulas, &parameters)?;
    let stage = reader.stage(&file, &formulas)?;
    let names: Vec<&str> = parameters
        .iter()
        .map(|p| p.definition.name.as_str())
        .collect();
    let [cause, workshop] = [("cause", &file.cause), ("workshop", &file.workshop)].map(
        |(key, value)| -> Result<String, Fault> {
            let sentence = reader.sentence(value, key)?;
            match (value, unknown_field(&sentence, &names)) {
                (Some(value), Some((at, field))) => {
                    let at = reader.within(value, at);
                    let message = format!(
                        "found the field {{{field}}}, expected a parameter, cable, winch, pulley, force sensor or a choice one|several"
                    );
                    Err(Fault::new(at, message))
                }
                _ => Ok(sentence),
            }
        },
    );
    let optional = |value: &Option<Text>, key| match value {
        Some(_) => reader.sentence(value, key).map(Some),
        None => Ok(None),
    };
    let places: Vec<(usize, &ParameterDefinition)> =
        parameters.iter().map(|p| (p.at, &p.definition)).collect();
    check::formulas(&formulas, &places, (scope.scope, search))?;
    Ok(Definition {
        text: text.to_owned(),
        id,
        title,
        scope: scope.scope,
        cause: cause?,
        workshop: workshop?,
        check: optional(&file.check, "check")?,
        source: optional(&file.source, "source")?,
        stage,
        search,
        variable: reader.variable(&file)?,
        is_damage: file.damage,
        prior: reader.prior(&file)?,
        parameters: parameters.into_iter().map(|p| p.definition).collect(),
        formulas,
    })
}

fn not_toml(error: &toml::de::Error) -> Fault {
    let is_shown = |c: char| if c.is_control() { ' ' } else { c };
    let message: String = error.message().chars().take(300).map(is_shown).collect();
    let at = error.span().map_or(0, |span| span.start);
    Fault::new(at, format!("not a hypothesis ({message})"))
}

struct Reader<'t> {
    text: &'t str,
}

impl Reader<'_> {
    /// Offset in the file of an offset in a string; the start of the string if escapes make that unknown.
    fn within(&self, value: &Text, at: usize) -> usize {
        let Range { start, end } = value.span();
        let source = self.text.get(start..end).unwrap_or_default();
        source
            .find(value.get_ref().as_str())
            .map_or(start, |from| start + from + at)
    }

    fn sentence(&self, value: &Option<Text>, key: &str) -> Result<String, Fault> {
        let Some(value) = value else {
            return Err(Fault::new(
                0,
                format!("found no {key}, expected {key} = \"...\""),
            ));
        };
        let text = value.get_ref().trim();
        if text.is_empty()
            || text.chars().count() > MAX_CHARACTERS
            || text.contains(char::is_control)
        {
            let message = format!("expected one line of 1 to {MAX_CHARACTERS} characters as {key}");
            return Err(Fault::new(value.span().start, message));
        }
        Ok(text.to_owned())
    }

    fn id(&self, file: &File) -> Result<String, Fault> {
        let id = self.sentence(&file.id, "id")?;
        let at = file.id.as_ref().map_or(0, |id| id.span().start);
        if !is_name(&id) {
            let message = format!(
                "found \"{}\", expected small letters, digits and _",
                id.escape_debug()
            );
            return Err(Fault::new(at, message));
        }
        match find(&id) {
            Some(_) => {
                let message = format!(
                    "found \"{id}\", which is an effect of the catalogue; expected another id"
                );
                Err(Fault::new(at, message))
            }
            None => Ok(id),
        }
    }

    fn scope(&self, file: &File) -> Result<&'static FileScope, Fault> {
        let found = self.sentence(&file.scope, "scope")?;
        let at = file.scope.as_ref().map_or(0, |scope| scope.span().start);
        let known = SCOPES.iter().find(|(name, _)| *name == found);
        known.map(|(_, scope)| scope).ok_or_else(|| {
            let message = format!(
                "found \"{}\", expected {}",
                found.escape_debug(),
                one_of(SCOPES.iter().map(|(name, _)| *name))
            );
            Fault::new(at, message)
        })
    }

    fn parameters(&self, file: &File) -> Result<Vec<Parameter>, Fault> {
        let mut entries: Vec<(&Text, &ParameterEntry)> = file.parameters.iter().collect();
        // Their order in the file, which those of a displacement need.
        entries.sort_by_key(|(name, _)| name.span().start);
        match entries.get(MAX_PARAMETERS) {
            Some((name, _)) => {
                let message =
                    format!("found more than {MAX_PARAMETERS} parameters, expected fewer");
                Err(Fault::new(name.span().start, message))
            }
            None => entries
                .into_iter()
                .map(|(name, entry)| self.parameter(name, entry, file))
                .collect(),
        }
    }

    fn parameter(
        &self,
        key: &Text,
        entry: &ParameterEntry,
        file: &File,
    ) -> Result<Parameter, Fault> {
        let at = key.span().start;
        let name = key.get_ref();
        let fail = |message: String| Err(Fault::new(at, message));
        if !is_name(name) {
            let name = name.escape_debug();
            return fail(format!(
                "found \"{name}\", expected small letters, digits and _"
            ));
        }
        if is_reserved(name) || file.change.keys().any(|changed| changed.get_ref() == name) {
            return fail(format!(
                "found the parameter \"{name}\", which is the name of a quantity or function; expected another name"
            ));
        }
        let (Some(unit), Some(typical)) = (&entry.unit, &entry.typical) else {
            return fail(format!(
                "found the parameter \"{name}\" without unit or typical size, expected unit = \"...\" and typical = [smallest, largest]"
            ));
        };
        let role = role_of(entry)?;
        let parsed = match role {
            Role::Pose => Unit::parse("1"),
            _ => Unit::parse(unit.get_ref()),
        };
        let Some(parsed) = parsed else {
            let found = unit.get_ref().escape_debug();
            let message =
                format!("found \"{found}\", expected a unit such as 1, m, N/m, 1/K or pose");
            return Err(Fault::new(unit.span().start, message));
        };
        let values = values_of(entry, typical, role)?;
        Ok(Parameter {
            definition: ParameterDefinition {
                name: name.clone(),
                unit: match role {
                    Role::Pose => "1".to_owned(),
                    _ => unit.get_ref().trim().to_owned(),
                },
                values,
            },
            unit: parsed,
            role,
            at,
        })
    }

    fn formulas(
        &self,
        file: &File,
        scope: &FileScope,
        parameters: &[Parameter],
    ) -> Result<Formulas, Fault> {
        if file.change.is_empty() {
            return Err(Fault::new(
                0,
                "found no formula, expected [change] with a quantity and its formula",
            ));
        }
        let variables: Vec<Variable> = parameters
            .iter()
            .map(|p| Variable {
                name: p.definition.name.clone(),
                unit: p.unit,
                is_pose: p.role == Role::Pose,
            })
            .collect();
        let mut formulas = Formulas::default();
        let mut entries: Vec<(&Text, &Text)> = file.change.iter().collect();
        entries.sort_by_key(|(name, _)| name.span().start);
        for (key, formula) in entries {
            let at = key.span().start;
            let Some(changed) = target(key.get_ref()) else {
                let known = FORMULA_TARGETS.iter().map(|t| t.name);
                let near = nearest(key.get_ref(), known);
                let found = key.get_ref().escape_debug();
                let message =
                    format!("found \"{found}\", expected a quantity that can be changed{near}");
                return Err(Fault::new(at, message));
            };
            if !(scope.permits)(changed.name) {
                let message = format!(
                    "found \"{}\", which this scope cannot change; expected {}",
                    changed.name, scope.permitted
                );
                return Err(Fault::new(at, message));
            }
            let names = Names {
                parameters: &variables,
                own: changed.name,
                own_dimension: Unit::parse(changed.unit).map_or(Dimension::NUMBER, |u| u.dimension),
                of_cable: changed.is_of_cable(),
                of_pair: scope.scope == Scope::Pair,
            };
            let program = Program::compile(formula.get_ref(), names)
                .map_err(|fault| Fault::new(self.within(formula, fault.at), fault.message))?;
            match changed.port {
                Port::Cable(port) => formulas.cable.push((port, program)),
                Port::Platform(port) => formulas.platform.push((port, program)),
            }
        }
        let used = |index: usize| formulas.programs().any(|p| p.parameters.contains(&index));
        let mut all = parameters.iter().enumerate();
        match all.find(|(index, _)| !used(*index)) {
            Some((_, parameter)) => {
                let name = &parameter.definition.name;
                let message = format!("found the parameter \"{name}\", which no formula uses");
                Err(Fault::new(parameter.at, message))
            }
            None => Ok(formulas),
        }
    }

    /// The raw reading if the file says so; a factor if every change of a reading is one; else a term.
    fn stage(&self, file: &File, formulas: &Formulas) -> Result<Stage, Fault> {
        let readings = formulas.cable.iter().filter(|(port, _)| port.is_reading());
        let mut readings = readings
            .map(|(_, program)| program.is_proportional)
            .peekable();
        let is_ratio = readings.peek().is_some() && readings.all(|is| is);
        match &file.stage {
            None if is_ratio => Ok(Stage::Ratio),
            None => Ok(Stage::Addition),
            Some(stage) if stage.get_ref() == "sensor" => Ok(Stage::Sensor),
            Some(stage) => {
                let found = stage.get_ref().escape_debug();
                let message = format!(
                    "found \"{found}\", expected sensor for a change of the raw reading, or no stage"
                );
                Err(Fault::new(stage.span().start, message))
            }
        }
    }

    fn variable(&self, file: &File) -> Result<Option<measurement::Variable>, Fault> {
        let Some(text) = &file.variable else {
            return Ok(None);
        };
        let all = measurement::Variable::ALL;
        let known = all
            .iter()
            .find(|variable| variable.name() == text.get_ref().as_str());
        known.copied().map(Some).ok_or_else(|| {
            let found = text.get_ref().escape_debug();
            let names = one_of(all.iter().map(|variable| variable.name()));
            Fault::new(
                text.span().start,
                format!("found \"{found}\", expected {names}"),
            )
        })
    }

    fn prior(&self, file: &File) -> Result<Option<f64>, Fault> {
        match &file.prior {
            Some(prior) if !(*prior.get_ref() > 0.0 && *prior.get_ref() <= MAX_PRIOR) => {
                let message = format!(
                    "found {}, expected a prior above 0 and at most {MAX_PRIOR}",
                    prior.get_ref()
                );
                Err(Fault::new(prior.span().start, message))
            }
            prior => Ok(prior.as_ref().map(|prior| *prior.get_ref())),
        }
    }
}

fn role_of(entry: &ParameterEntry) -> Result<Role, Fault> {
    let is_pose = entry
        .unit
        .as_ref()
        .is_some_and(|unit| unit.get_ref() == POSE);
    match &entry.role {
        None if is_pose => Ok(Role::Pose),
        None => Ok(Role::Size),
        Some(role) => match role.get_ref().as_str() {
            "phase" => Ok(Role::Phase),
            "period" => Ok(Role::Period),
            found => {
                let message = format!(
                    "found \"{}\", expected phase or period",
                    found.escape_debug()
                );
                Err(Fault::new(role.span().start, message))
            }
        },
    }
}

/// Typical sizes, prior and bounds of a parameter.
fn values_of(
    entry: &ParameterEntry,
    typical: &Spanned<[f64; 2]>,
    role: Role,
) -> Result<EffectParameter, Fault> {
    let [low, high] = *typical.get_ref();
    let are_good = low.is_finite() && high.is_finite() && low < high;
    if !are_good {
        let message =
            format!("found {low} to {high}, expected the smallest and the largest typical size");
        return Err(Fault::new(typical.span().start, message));
    }
    let number = |value: &Option<Spanned<f64>>, default: f64| match value {
        Some(value) if !value.get_ref().is_finite() => {
            let message = format!("found {}, expected a finite number", value.get_ref());
            Err(Fault::new(value.span().start, message))
        }
        Some(value) => Ok(*value.get_ref()),
        None => Ok(default),
    };
    let neutral = number(&entry.neutral, 0.0)?;
    let start = number(&entry.start, neutral)?;
    let prior_sd = number(&entry.prior_sd, low.abs().max(high.abs()))?;
    if let Some(value) = entry.prior_sd.as_ref().filter(|_| prior_sd <= 0.0) {
        let message = format!("found {prior_sd}, expected a standard deviation above 0");
        return Err(Fault::new(value.span().start, message));
    }
    let bounds = entry
        .bounds
        .as_ref()
        .map_or([f64::NEG_INFINITY, f64::INFINITY], |b| *b.get_ref());
    if let Some(stated) = &entry.bounds
        && !(bounds[0] <= neutral
            && neutral <= bounds[1]
            && bounds[0] <= start
            && start <= bounds[1]
            && bounds[0] < bounds[1])
    {
        let message = format!(
            "found {} to {}, expected bounds around the neutral and the start value",
            bounds[0], bounds[1]
        );
        return Err(Fault::new(stated.span().start, message));
    }
    Ok(EffectParameter {
        neutral,
        start,
        bounds,
        discrete: role == Role::Pose,
        ..EffectParameter::new("", "", prior_sd, [low, high])
    })
}

/// The search of a diagnosis for the effect, from the roles of its parameters.
fn search(formulas: &Formulas, parameters: &[Parameter]) -> Result<Search, Fault> {
    let of = |role: Role| parameters.iter().position(|p| p.role == role);
    let events = formulas
        .programs()
        .filter_map(|p| p.from_pose.map(Search::FromPose));
    let at = formulas
        .programs()
        .filter_map(|p| p.at_pose.map(Search::AtPose));
    let mut events: Vec<Search> = events.chain(at).collect();
    events.dedup();
    let place = |index: usize| parameters[index].at;
    match (events.as_slice(), of(Role::Phase), of(Role::Period)) {
        ([], None, None) => Ok(Search::Direct),
        ([event], None, None) => Ok(*event),
        ([], Some(phase), period) => {
            let sizes = parameters.iter().filter(|p| p.role == Role::Size).count();
            let waves = parameters.len() - sizes;
            if sizes == 1 && waves == 1 + usize::from(period.is_some()) {
                return Ok(Search::Wave { phase, period });
            }
            let message = "expected a wave to have one amplitude, one phase and at most one period";
            Err(Fault::new(place(phase), message))
        }
        ([], None, Some(period)) => Err(Fault::new(
            place(period),
            "found a period without a phase, expected both",
        )),
        _ => {
            let message = "found several events, or an event and a wave; expected one step(..), one only(..) or one phase";
            Err(Fault::new(parameters.first().map_or(0, |p| p.at), message))
        }
    }
}

fn is_name(text: &str) -> bool {
    let is_first = text.starts_with(|c: char| c.is_ascii_lowercase());
    let is_inner = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    is_first && text.len() <= 64 && text.chars().all(is_inner)
}

fn one_of<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.collect();
    format!("one of {}", names.join(", "))
}
