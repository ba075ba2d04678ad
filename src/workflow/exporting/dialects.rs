//! A model as a text of another program, and how much of the model the text expresses.

use tautline_core::estimation::Solution;
use tautline_core::geometry::{Coordinate, Pose};
use tautline_core::projection::{ExpectedLengths, ProjectionErrors};
use tautline_core::robot::Robot;
use tautline_core::simulation::{SimulationError, Workspace};
use tautline_import::{Dialect, ForeignRobot, Meaning, Parameter};
use tautline_session::ReadError;

use crate::identification::Identification;

/// Number of poses of the workspace at which model and text are compared.
const POSES: usize = 100;
/// Smallest part of the error of a text that is said of one cause (m).
const LEAST_PART_M: f64 = 1e-5;

/// Why a model cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum DialectError {
    /// The text of the user, or a new one, cannot be read.
    #[error(transparent)]
    Text(#[from] ReadError),
    /// The dialect cannot describe such a robot.
    #[error("{0}")]
    Robot(String),
    /// The model cannot be evaluated.
    #[error("{0}")]
    Model(#[from] SimulationError),
}

/// A number that is written.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenValue {
    /// Name in the text.
    pub key: String,
    /// Value before; `None` in a new text.
    pub old: Option<f64>,
    /// Value as it is written.
    pub new: String,
    /// Standard deviation in the unit of the text, if it is known.
    pub sd: Option<f64>,
    /// Unit of the text.
    pub unit: &'static str,
    /// What the value follows from.
    pub reason: String,
}

/// A model as a text of another program.
#[derive(Debug, Clone, PartialEq)]
pub struct DialectText {
    /// The text.
    pub text: String,
    /// The numbers that differ from those of the user's text; all in a new one.
    pub values: Vec<WrittenValue>,
    /// Errors of the user's text as it is.
    pub before: Option<ProjectionErrors>,
    /// Errors of the text that is written, by what it cannot express.
    pub after: ProjectionErrors,
    /// Expected position error of the model itself (m), if it was identified from measurements.
    pub model_sd_m: Option<f64>,
    /// What the text cannot express, with its part of the position error (m), the largest first.
    pub inexpressible: Vec<(String, f64)>,
    /// What was assumed about the text.
    pub notices: Vec<String>,
}

impl DialectText {
    /// Expected position error of a machine with this text (m).
    #[must_use]
    pub fn expected_m(&self) -> f64 {
        self.after
            .position_rms_m()
            .hypot(self.model_sd_m.unwrap_or(0.0))
    }

    /// Expected errors and what the text cannot express, in sentences.
    #[must_use]
    pub fn loss_in_words(&self) -> String {
        let mut text = match &self.before {
            Some(before) => format!(
                "The text as it is: {} expected. ",
                in_mm(before.position_rms_m())
            ),
            None => String::new(),
        };
        text += &format!("These lines: {} expected", in_mm(self.expected_m()));
        text += &match self.model_sd_m {
            Some(sd_m) => format!("; the full model: {}.", in_mm(sd_m)),
            None => format!(
                ", {} at most, by what they cannot express.",
                in_mm(self.after.largest_position_m())
            ),
        };
        if !self.inexpressible.is_empty() {
            let parts = self.inexpressible.iter();
            let parts = parts.map(|(name, part_m)| format!("{name} ({})", in_mm(*part_m)));
            text += &format!(
                " Not expressible: {}.",
                parts.collect::<Vec<_>>().join(", ")
            );
        }
        text
    }
}

fn in_mm(metres: f64) -> String {
    format!("{:.2} mm", 1e3 * metres)
}

/// Writes a model as a text in a dialect: the numbers in the user's text, which has this name, or a new text. With the identification
/// from which the model comes, the text fits the box of the measured poses and standard deviations are known.
///
/// # Errors
/// If the text cannot be read, is of another robot, or the dialect cannot describe the model.
pub fn dialect_text(
    model: &Robot,
    fit: Option<&Identification>,
    dialect: &Dialect,
    onto: Option<(&str, &str)>,
) -> Result<DialectText, DialectError> {
    let (file, text) = match onto {
        Some((file, text)) => (file.to_owned(), text.to_owned()),
        None => {
            let new = dialect.new_text(model).map_err(DialectError::Robot)?;
            (dialect.title.to_owned(), new)
        }
    };
    let read = dialect.read(&file, &text)?;
    let model = comparable(model, &read.robot, &file)?;
    let target = |values: &[f64]| {
        let text = read.exact_text(&text, values);
        let robot = dialect.read(&file, &text).ok()?.robot;
        Some(with_home_of(&model, robot))
    };
    let workspace = workspace(&model, &read.robot, fit);
    let start: Vec<f64> = read.parameters.iter().map(|one| one.value).collect();
    let ranges: Vec<f64> = read.parameters.iter().map(|one| one.range).collect();
    let expected = ExpectedLengths::of(&model, workspace, POSES)?;
    let values = expected.project(&target, &start, &ranges);
    let written = read.text_with(&text, &values);
    let robot = with_home_of(&model, dialect.read(&file, &written)?.robot);
    let after = expected.errors_of(&robot)?;
    let mut inexpressible = Vec::new();
    for (name, simpler) in simpler_models(&model) {
        let expected = ExpectedLengths::of(&simpler, workspace, POSES)?;
        let best = target(&expected.project(&target, &values, &ranges)).unwrap_or(robot.clone());
        let rest_m = expected.errors_of(&best)?.position_rms_m();
        let part_m = (after.position_rms_m().powi(2) - rest_m.powi(2))
            .max(0.0)
            .sqrt();
        if part_m > LEAST_PART_M {
            inexpressible.push((name, part_m));
        }
    }
    inexpressible.sort_by(|a, b| b.1.total_cmp(&a.1));
    let before = onto.map(|_| expected.errors_of(&with_home_of(&model, read.robot.clone())));
    Ok(DialectText {
        text: written,
        values: written_values(&model, fit, &read, &values, onto.is_some()),
        before: before.transpose()?,
        after,
        model_sd_m: fit
            .and_then(Identification::budget)
            .and_then(|budget| Some(budget.position?.sd_m())),
        inexpressible,
        notices: read.notices,
    })
}

/// The model in the frame of the text, whose origin is the home pose if the text states one.
fn comparable(model: &Robot, read: &Robot, file: &str) -> Result<Robot, DialectError> {
    let (found, expected) = (model.cable_count(), read.cable_count());
    if found != expected {
        let message =
            format!("found {found} cables in the model, expected the {expected} of {file}");
        return Err(DialectError::Robot(message));
    }
    let mut model = model.clone();
    if let (Some(home), Some(own)) = (&mut model.home, &read.home) {
        let shift = [0, 1, 2].map(|k| own.position_m[k] - home.position_m[k]);
        let add = |point: &mut [f64; 3]| (0..3).for_each(|k| point[k] += shift[k]);
        add(&mut home.position_m);
        model
            .cables
            .iter_mut()
            .for_each(|cable| add(&mut cable.pulley.entry_point_m));
        if let Some(workspace) = model
            .limits
            .as_mut()
            .and_then(|limits| limits.workspace.as_mut())
        {
            add(&mut workspace.center.position_m);
        }
    }
    Ok(model)
}

/// The robot of a text, at home where the model is.
fn with_home_of(model: &Robot, robot: Robot) -> Robot {
    Robot {
        home: model.home,
        limits: model.limits,
        ..robot
    }
}

/// The poses at which the text is to be good: the box of the measured ones, else the workspace; without rotation if the text
/// knows none.
fn workspace(model: &Robot, read: &Robot, fit: Option<&Identification>) -> Workspace {
    let measured = fit.and_then(|fit| around(&fit.solution, model));
    let mut workspace = measured.unwrap_or_else(|| Workspace::of(model));
    let is_rotation = |coordinate: &Coordinate| coordinate.index() >= 3;
    if !read.platform.free.iter().any(is_rotation) {
        workspace.half_rotation_rad = 0.0;
    }
    workspace
}

/// The box of the estimated poses, in the frame of a model that was moved to its home.
fn around(solution: &Solution, model: &Robot) -> Option<Workspace> {
    let home = model.home.map(|home| home.pose().position);
    let shift = home.map(|home| home - solution.globals.home.position);
    let moved = |pose: &Pose| Pose {
        position: pose.position + shift.unwrap_or_default(),
        ..*pose
    };
    let poses: Vec<Pose> = solution.poses.iter().map(|(_, pose)| moved(pose)).collect();
    Workspace::around(poses.iter())
}

/// The model without one of the things that a text may lack, each with its name.
fn simpler_models(model: &Robot) -> Vec<(String, Robot)> {
    let mut models = Vec::new();
    for (index, setting) in model.effects.iter().enumerate() {
        let mut simpler = model.clone();
        simpler.effects.remove(index);
        let title = model
            .effect(&setting.effect)
            .map_or(setting.effect.as_str(), |effect| effect.title());
        let name = match setting.targets.len() {
            0 => title.to_owned(),
            _ => format!("{title} of {}", setting.targets.join(", ")),
        };
        models.push((name, simpler));
    }
    if !model.deviations.is_empty() {
        let simpler = Robot {
            deviations: Vec::new(),
            ..model.clone()
        };
        models.push((
            "deviations of parts within their tolerances".to_owned(),
            simpler,
        ));
    }
    if model.cables.iter().any(|cable| cable.pulley.radius_m > 0.0) {
        let mut simpler = model.clone();
        simpler
            .cables
            .iter_mut()
            .for_each(|cable| cable.pulley.radius_m = 0.0);
        models.push(("pulleys".to_owned(), simpler));
    }
    models
}

fn written_values(
    model: &Robot,
    fit: Option<&Identification>,
    read: &ForeignRobot,
    values: &[f64],
    has_old: bool,
) -> Vec<WrittenValue> {
    let all = read.parameters.iter().zip(values);
    let written = all.filter(|(parameter, value)| !has_old || !parameter.is_unchanged(**value));
    written
        .map(|(parameter, value)| {
            let name = parameter.cable.as_deref();
            let cable = name.and_then(|name| read.robot.cable_index(name));
            WrittenValue {
                key: parameter.key.clone(),
                old: has_old.then_some(parameter.value),
                new: parameter.written(*value),
                sd: cable.and_then(|cable| sd(model, fit, parameter, cable, *value)),
                unit: parameter.unit.0,
                reason: reason(model, parameter, cable),
            }
        })
        .collect()
}

/// Standard deviation of a value in the unit of the text.
fn sd(
    model: &Robot,
    fit: Option<&Identification>,
    parameter: &Parameter,
    cable: usize,
    value: f64,
) -> Option<f64> {
    let cable = model.cables.get(cable)?;
    match parameter.meaning {
        Meaning::EntryPoint(axis) => {
            Some(cable.pulley.entry_point_sd_m.each()[axis]? / parameter.unit.1)
        }
        Meaning::CablePerRevolution => {
            let effects = fit?.effects();
            let is_scale = |effect: &str| effect == "winch_scale";
            let scale = effects
                .iter()
                .find(|one| is_scale(&one.effect) && one.targets.contains(&cable.name))?;
            Some(scale.sd? * value.abs())
        }
        Meaning::BuildUp | Meaning::Stiffness | Meaning::Other => None,
    }
}

/// What a value follows from.
fn reason(model: &Robot, parameter: &Parameter, cable: Option<usize>) -> String {
    let cable = cable.and_then(|cable| model.cables.get(cable));
    let name = cable.map_or("all cables", |cable| cable.name.as_str());
    match parameter.meaning {
        Meaning::EntryPoint(_) => match cable.map(|cable| cable.pulley.radius_m) {
            Some(radius_m) if radius_m > 0.0 => format!(
                "entry point of {name}, as a point for its pulley of {:.1} mm",
                1e3 * radius_m
            ),
            _ => format!("entry point of {name}"),
        },
        Meaning::CablePerRevolution => format!("cable per revolution of {name}"),
        Meaning::BuildUp => "build-up of the drums".to_owned(),
        Meaning::Stiffness => "stiffness of the cables".to_owned(),
        Meaning::Other => String::new(),
    }
}
