//! A model as a text of another program, and the error of the text.

use tautline_core::kinematics::{LengthBreakdownError, effective_geometry};
use tautline_core::projection::ExpectedLengths;
use tautline_core::robot::{CableMaterial, Robot};
use tautline_core::simulation::{SimulationError, Workspace};
use tautline_files::ReadError;
use tautline_import::{Dialect, ForeignRobot, Meaning, Parameter};

use crate::identification::{FitVerdict, Identification, effects_title, without_each_effect};

/// Number of poses of the workspace at which model and text are compared.
const POSES: usize = 100;
/// Smallest part of the error of a text that is attributed to one cause (m), and relative to the whole.
const LEAST_PART: [f64; 2] = [5e-5, 0.1];

/// Errors of writing a model as a text of another program.
#[derive(Debug, thiserror::Error)]
pub enum DialectError {
    /// The text of the user, or a new one, cannot be read.
    #[error(transparent)]
    Text(#[from] ReadError),
    /// The text describes another robot.
    #[error("found {found} cables in the model, expected the {expected} of {file}")]
    Cables {
        /// Number of cables of the model.
        found: usize,
        /// Number of cables of the text.
        expected: usize,
        /// Name of the text.
        file: String,
    },
    /// The model cannot be evaluated.
    #[error(transparent)]
    Model(#[from] SimulationError),
    /// The model has no geometry at its home pose.
    #[error(transparent)]
    Geometry(#[from] LengthBreakdownError),
}

/// A number that is written.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenValue {
    /// The number in the original text.
    pub parameter: Parameter,
    /// The written value.
    pub new: String,
    /// Standard deviation in the unit of the text, if it is known.
    pub sd: Option<f64>,
    /// Part of the position error that returns if this value alone stays as it was in the user's text (m).
    pub gain_m: Option<f64>,
    /// Origin of the value.
    pub reason: String,
}

/// A model as a text of another program. Errors are those of the platform's position (m), root mean square over the workspace.
#[derive(Debug, Clone, PartialEq)]
pub struct DialectText {
    /// The text.
    pub text: String,
    /// The numbers that differ from those in the user's text; all in a new one.
    pub values: Vec<WrittenValue>,
    /// Error of the original text of the user.
    pub before_m: Option<f64>,
    /// Error of the written text: the part of the model that it cannot express.
    pub after_m: f64,
    /// Standard deviation of the position of the model itself, if it was identified from measurements.
    pub model_sd_m: Option<f64>,
    /// Effects that the text cannot express, each with its part of the error, largest first.
    pub inexpressible: Vec<(String, f64)>,
    /// Effects of which the text has only the change of the geometry at home.
    pub at_home_only: Vec<String>,
    /// Whether the standard deviations of the model are valid; they are too small if the model does not explain the readings.
    pub sd_holds: bool,
}

impl DialectText {
    /// The lines that differ from those of the user's text, which has as many.
    #[must_use]
    pub fn changed_lines(&self, text: &str) -> String {
        let lines = self.text.lines().zip(text.lines());
        let changed = lines.filter(|(new, old)| new != old);
        changed.map(|(new, _)| format!("{new}\n")).collect()
    }

    /// Sentences on expected errors and effects that the text cannot express.
    #[must_use]
    pub fn loss_in_words(&self) -> String {
        let mm = |metres: f64| format!("{:.2} mm", 1e3 * metres);
        let sd_m = self.model_sd_m.unwrap_or(0.0);
        let before = self.before_m.map(|before| mm(before.hypot(sd_m)));
        let before = before.map_or_else(String::new, |mm| {
            format!("The text as it is: {mm} expected. ")
        });
        let model = match self.model_sd_m {
            Some(sd_m) => format!("the full model: {}", mm(sd_m)),
            None => "the model itself counts as exact".to_owned(),
        };
        let after = mm(self.after_m.hypot(sd_m));
        let parts = self.inexpressible.iter();
        let parts = parts.map(|(name, part_m)| format!("{name} ({})", mm(*part_m)));
        let parts = parts.collect::<Vec<_>>().join(", ");
        let parts = if parts.is_empty() {
            parts
        } else {
            format!(" Not expressible: {parts}.")
        };
        let at_home = match self.at_home_only.join(", ") {
            names if names.is_empty() => names,
            names => format!(" A text of geometry has only what these change at home: {names}."),
        };
        let doubt = match self.sd_holds {
            true => "",
            false => {
                " The model does NOT explain the readings, so expect more than these figures; a diagnosis looks for the cause."
            }
        };
        format!("{before}These lines: {after} expected; {model}.{parts}{at_home}{doubt}")
    }
}

/// Writes a model as a text in a dialect: the numbers in the user's text, which has this name, or a new text. With the identification
/// from which the model comes, more standard deviations are known.
///
/// # Errors
/// If the text cannot be read, is of another robot, or the model cannot be evaluated in its workspace.
pub fn dialect_text(
    model: &Robot,
    fit: Option<&Identification>,
    dialect: &Dialect,
    onto: Option<(&str, &str)>,
) -> Result<DialectText, DialectError> {
    let new = match onto {
        Some(_) => String::new(),
        None => (dialect.new_text)(&expressible(model, dialect)?),
    };
    let (file, text) = onto.unwrap_or((dialect.name, &new));
    let target = Target::new(dialect, (file, text), model)?;
    let parameters = &target.read.parameters;
    let start: Vec<f64> = parameters.iter().map(|one| one.value).collect();
    let (expected, values, least_m) = target.best(model, &start)?;
    let is_written = |one: &Parameter, value: f64| onto.is_none() || !one.is_unchanged(value);
    let written = target.read.text_with(text, &values, &|one, value| {
        is_written(one, value).then(|| one.written(value))
    });
    let error_m = |text: &str| -> Result<f64, DialectError> {
        Ok(expected.position_error_m(&target.robot_of(text)?)?)
    };
    let after_m = error_m(&written)?;
    let mut changed = Vec::new();
    for (one, &value) in parameters.iter().zip(&values) {
        if !is_written(one, value) {
            continue;
        }
        let without = target.read.text_with(text, &values, &|other, value| {
            (other != one && is_written(other, value)).then(|| other.written(value))
        });
        let gain_m = onto.map(|_| error_m(&without)).transpose()?;
        changed.push(WrittenValue {
            gain_m: gain_m.map(|without_m| without_m - after_m),
            ..written_value(model, &target.read.robot, fit, one, value)
        });
    }
    let budget = fit.and_then(Identification::budget);
    Ok(DialectText {
        values: changed,
        before_m: onto.map(|_| error_m(text)).transpose()?,
        after_m,
        model_sd_m: budget.and_then(|budget| Some(budget.position?.sd_m())),
        inexpressible: target.inexpressible(model, &values, least_m)?,
        at_home_only: match dialect.has_winches {
            true => Vec::new(),
            false => (model.effects.iter())
                .map(|effect| effects_title(model, std::slice::from_ref(effect)))
                .collect(),
        },
        sd_holds: fit.is_none_or(|fit| FitVerdict::of(fit.solution.p_value()).holds()),
        text: written,
    })
}

/// The model, or its geometry at home if the dialect states geometry only.
fn expressible(model: &Robot, dialect: &Dialect) -> Result<Robot, DialectError> {
    if dialect.has_winches {
        return Ok(model.clone());
    }
    let home = model.home.map(|home| home.pose());
    let home = home.unwrap_or_else(|| Workspace::of(model).centre);
    Ok(effective_geometry(model, &home)?)
}

/// A text in which a model is expressed.
struct Target<'a> {
    dialect: &'a Dialect,
    file: &'a str,
    text: &'a str,
    read: ForeignRobot,
    /// The model in the frame of the text.
    model: Robot,
}

impl<'a> Target<'a> {
    fn new(
        dialect: &'a Dialect,
        (file, text): (&'a str, &'a str),
        model: &Robot,
    ) -> Result<Self, DialectError> {
        let read = (dialect.read)(file, text)?;
        let (found, expected) = (model.cable_count(), read.robot.cable_count());
        if found != expected {
            let file = file.to_owned();
            return Err(DialectError::Cables {
                found,
                expected,
                file,
            });
        }
        let model = in_frame_of(expressible(model, dialect)?, &read.robot, dialect);
        Ok(Self {
            dialect,
            file,
            text,
            read,
            model,
        })
    }

    /// The robot of a changed text, with the drive of the model.
    fn robot_of(&self, text: &str) -> Result<Robot, DialectError> {
        let read = (self.dialect.read)(self.file, text)?;
        Ok(driven_as(&self.model, self.dialect, read))
    }

    /// The robot of the text with exactly these values.
    fn robot_with(&self, values: &[f64]) -> Result<Robot, DialectError> {
        let exact = |_: &Parameter, value: f64| Some(value.to_string());
        self.robot_of(&self.read.text_with(self.text, values, &exact))
    }

    /// The lengths predicted by a model, the values near `start` for which the text has the smallest error, and that error (m).
    fn best(
        &self,
        model: &Robot,
        start: &[f64],
    ) -> Result<(ExpectedLengths, Vec<f64>, f64), DialectError> {
        let model = in_frame_of(
            expressible(model, self.dialect)?,
            &self.read.robot,
            self.dialect,
        );
        let workspace = workspace(&model, &self.read.robot);
        let expected = ExpectedLengths::of(&model, workspace, POSES)?;
        let parameters = self.read.parameters.iter().zip(start);
        let start: Vec<f64> = parameters
            .map(|(one, start)| self.anchor(&model, one).unwrap_or(*start))
            .collect();
        let ranges: Vec<f64> = self
            .read
            .parameters
            .iter()
            .map(|one| one.row.range)
            .collect();
        let values = expected.project(&|values| self.robot_with(values).ok(), &start, &ranges);
        let error_m = expected.position_error_m(&self.robot_with(&values)?)?;
        Ok((expected, values, error_m))
    }

    /// The value of a parameter that is a coordinate of a platform anchor.
    fn anchor(&self, model: &Robot, parameter: &Parameter) -> Option<f64> {
        let (axis, from_m) = match parameter.row.meaning {
            Meaning::Anchor(axis) => (axis, 0.0),
            Meaning::AnchorFromMass(axis) => (axis, model.platform.center_of_mass_m[axis]),
            _ => return None,
        };
        let cable = self.read.robot.cable_index(&parameter.cable)?;
        let anchor_m = model.cables[cable].platform_anchor_m[axis] - from_m;
        Some(anchor_m * parameter.row.unit.1)
    }

    /// Parts of the error `least_m` of the best values, each by something that the text cannot express, the largest first.
    fn inexpressible(
        &self,
        model: &Robot,
        values: &[f64],
        least_m: f64,
    ) -> Result<Vec<(String, f64)>, DialectError> {
        let mut parts = Vec::new();
        for (name, simpler) in simpler_models(model) {
            let rest_m = self.best(&simpler, values)?.2;
            let part_m = (least_m.powi(2) - rest_m.powi(2)).max(0.0).sqrt();
            if part_m > LEAST_PART[0].max(LEAST_PART[1] * least_m) {
                parts.push((name, part_m));
            }
        }
        parts.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(parts)
    }
}

/// The model in the frame of a text, whose origin is the home pose if it states winches; without elasticity for geometry alone.
fn in_frame_of(mut model: Robot, read: &Robot, dialect: &Dialect) -> Robot {
    if !dialect.has_winches {
        let cables = model.cables.iter_mut();
        cables.for_each(|cable| cable.cable = CableMaterial::default());
    } else if let (Some(home), Some(own)) = (&mut model.home, &read.home) {
        let shift = [0, 1, 2].map(|k| own.position_m[k] - home.position_m[k]);
        let add = |point: &mut [f64; 3]| (0..3).for_each(|k| point[k] += shift[k]);
        add(&mut home.position_m);
        let cables = model.cables.iter_mut();
        cables.for_each(|cable| add(&mut cable.pulley.entry_point_m));
        let workspace = model
            .limits
            .as_mut()
            .and_then(|limits| limits.workspace.as_mut());
        workspace
            .into_iter()
            .for_each(|limits| add(&mut limits.center.position_m));
    }
    model
}

/// The robot of a text, with home and centre of mass of the model. If the text states no winches, it is driven by those of the model along
/// its coordinates.
fn driven_as(model: &Robot, dialect: &Dialect, read: ForeignRobot) -> Robot {
    let mut robot = read.robot;
    (robot.home, robot.limits) = (model.home, model.limits);
    for one in read.parameters {
        let cable = robot.cable_index(&one.cable);
        if let (Meaning::AnchorFromMass(axis), Some(cable)) = (one.row.meaning, cable) {
            robot.cables[cable].platform_anchor_m[axis] += model.platform.center_of_mass_m[axis];
        }
    }
    if !dialect.has_winches {
        robot.platform.free.clone_from(&model.platform.free);
        for (cable, own) in robot.cables.iter_mut().zip(&model.cables) {
            (cable.winch, cable.cable) = (own.winch, own.cable.clone());
        }
    }
    robot
}

/// The workspace of a model, without rotation if the text knows none.
fn workspace(model: &Robot, read: &Robot) -> Workspace {
    let mut workspace = Workspace::of(model);
    if !read.platform.turns() {
        workspace.half_rotation_rad = 0.0;
    }
    workspace
}

/// The model without one of the things that a text may lack, each with its name.
fn simpler_models(model: &Robot) -> Vec<(String, Robot)> {
    let mut models = without_each_effect(model);
    let mut eyelets = model.clone();
    let cables = eyelets.cables.iter_mut();
    cables.for_each(|cable| cable.pulley.radius_m = 0.0);
    models.extend((eyelets != *model).then_some(("pulleys".to_owned(), eyelets)));
    models
}

fn written_value(
    model: &Robot,
    read: &Robot,
    fit: Option<&Identification>,
    parameter: &Parameter,
    value: f64,
) -> WrittenValue {
    let cable = read
        .cable_index(&parameter.cable)
        .map(|index| &model.cables[index]);
    let name = cable.map_or("all cables", |cable| cable.name.as_str());
    let (sd, reason) = match (parameter.row.meaning, cable) {
        (Meaning::EntryPoint(axis), Some(cable)) => {
            let sd_m = cable.pulley.entry_point_sd_m.each()[axis];
            let radius_mm = 1e3 * cable.pulley.radius_m;
            let pulley = match radius_mm > 0.0 {
                true => format!(", with its pulley of {radius_mm:.1} mm"),
                false => String::new(),
            };
            let sd = sd_m.map(|sd_m| sd_m * parameter.row.unit.1);
            (sd, format!("entry point of {name}{pulley}"))
        }
        (Meaning::Anchor(_) | Meaning::AnchorFromMass(_), Some(_)) => {
            (None, format!("platform anchor of {name}"))
        }
        (Meaning::CablePerRevolution, Some(cable)) => {
            let effects = fit.map(Identification::effects).unwrap_or_default();
            let mut scales = effects.iter().filter(|one| one.effect == "winch_scale");
            let scale = scales.find(|one| one.targets.contains(&cable.name));
            let sd = scale.and_then(|one| one.sd).map(|sd| sd * value.abs());
            (sd, format!("cable per revolution of {name}"))
        }
        (Meaning::BuildUp, _) => (None, "build-up of the drums".to_owned()),
        (Meaning::Stiffness, _) => (None, "stiffness of the cables".to_owned()),
        _ => (None, name.to_owned()),
    };
    WrittenValue {
        new: parameter.written(value),
        parameter: parameter.clone(),
        sd,
        gain_m: None,
        reason,
    }
}
