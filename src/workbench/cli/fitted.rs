//! A solved problem in the forms in which it is shown: JSON, model file, report.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::estimation::{
    Analysis, Deficiency, Method, ParameterId, Problem, ReadingKind, Solution,
};
use tautline_core::robot::{FieldError, PerAxis, Robot};
use tautline_session::Document;

use super::table;
use crate::cli::output::say;

/// Machine form of an identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Identification {
    /// joint, simple or published.
    pub method: String,
    /// Whether the solver converged.
    pub converged: bool,
    /// Number of steps.
    pub iterations: usize,
    /// Time of the solve alone (s).
    pub seconds: f64,
    /// Chi-square at the solution, priors included.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: f64,
    /// Probability of a chi-square at least as large if model and noise are right.
    pub p_value: Option<f64>,
    /// Entry point of each cable (m).
    pub entry_points_m: Vec<[f64; 3]>,
    /// Their standard deviations (m); 0 where a coordinate was given, null where it is not determined.
    pub entry_points_sd_m: Vec<[Option<f64>; 3]>,
    /// Root mean square residuals; null where nothing was measured.
    pub rms: Rms,
    /// The poses, home first.
    pub poses: Vec<FittedPose>,
    /// Estimated effects.
    #[serde(default)]
    pub effects: Vec<FittedEffect>,
    /// What the data leave open, in words.
    #[serde(default)]
    pub undetermined: Vec<String>,
    /// Readings that do not fit, in words, the worst first.
    #[serde(default)]
    pub suspect_readings: Vec<String>,
}

/// Root mean square residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Rms {
    /// Of the length readings (m).
    pub length_m: Option<f64>,
    /// Of the laser readings (m).
    pub laser_m: Option<f64>,
    /// Of the tension readings (N).
    pub tension_n: Option<f64>,
}

/// One fitted pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedPose {
    /// Label of the row.
    pub pose: i64,
    /// Platform origin in the base frame (m).
    pub position_m: [f64; 3],
    /// Orientation, quaternion w first.
    pub orientation_wxyz: [f64; 4],
}

/// One estimated parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedEffect {
    /// Effect of the catalogue.
    pub effect: String,
    /// Cables; empty for all.
    pub targets: Vec<String>,
    /// Name of the parameter.
    pub parameter: String,
    /// Value (SI).
    pub value: f64,
    /// Unit.
    pub unit: String,
    /// Standard deviation; null where it is not determined.
    pub sd: Option<f64>,
}

impl Document for Identification {
    const FORMAT: &'static str = "tautline-identification";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;

    fn check(&self) -> Result<(), FieldError> {
        Ok(())
    }
}

/// A solved problem.
pub struct Fitted<'a> {
    pub problem: &'a Problem<'a>,
    pub solution: &'a Solution,
    pub analysis: &'a Analysis,
    pub open: Vec<Deficiency>,
    pub seconds: f64,
}

/// Level for all readings together at which single readings are called suspect.
const SUSPECT_LEVEL: f64 = 0.01;
/// Most suspect readings that a report lists.
const SUSPECTS_SHOWN: usize = 10;

impl Fitted<'_> {
    fn robot(&self) -> &Robot {
        &self.problem.dataset.robot
    }

    fn entry_point_sd(&self, cable: usize, axis: usize) -> Option<f64> {
        let id = ParameterId::EntryPoint { cable, axis };
        match self.solution.parameters.iter().position(|p| p.id == id) {
            Some(index) => self.solution.standard_deviation(index),
            None => Some(0.0),
        }
    }

    fn effects(&self) -> Vec<FittedEffect> {
        let held = self.problem.held_effects.len();
        let mut effects = Vec::new();
        for (index, parameter) in self.solution.parameters.iter().enumerate() {
            let ParameterId::Effect {
                effect,
                parameter: which,
            } = parameter.id
            else {
                continue;
            };
            let bound = &self.solution.globals.effects[held + effect];
            let description = bound.effect.parameters()[which];
            effects.push(FittedEffect {
                effect: bound.effect.id().to_owned(),
                targets: bound.setting(self.robot()).targets,
                parameter: description.name.to_owned(),
                value: bound.values[which],
                unit: description.unit.to_owned(),
                sd: self.solution.standard_deviation(index),
            });
        }
        effects
    }

    /// Suspect readings in words.
    fn suspects(&self) -> Vec<String> {
        let labels = &self.problem.dataset.measurements.labels;
        let suspects = self.analysis.suspects(SUSPECT_LEVEL);
        let words = |reading: &tautline_core::estimation::Reading| {
            let size = reading.normalised().unwrap_or(f64::NAN);
            let what = self.reading_name(reading.kind);
            format!(
                "pose {}, {what}: off by {size:+.1} standard deviations",
                labels[reading.row]
            )
        };
        suspects.iter().map(words).collect()
    }

    fn reading_name(&self, kind: ReadingKind) -> String {
        let cable = |index: usize| self.robot().cables[index].name.as_str();
        let axis = |k: usize| ["x", "y", "z"][k];
        match kind {
            ReadingKind::Length(index) => format!("length of {}", cable(index)),
            ReadingKind::Equilibrium(c) => format!("tensions, balance of {}", c.describe()),
            ReadingKind::Laser => "laser distance".to_owned(),
            ReadingKind::Swivel(index) => format!("swivel angle of {}", cable(index)),
            ReadingKind::TrackerPosition(k) => format!("measured position {}", axis(k)),
            ReadingKind::TrackerOrientation(k) => format!("measured rotation about {}", axis(k)),
            ReadingKind::Inclination(k) => ["roll", "pitch", "yaw"][k].to_owned(),
        }
    }

    /// Machine form.
    pub fn identification(&self) -> Identification {
        let labels = &self.problem.dataset.measurements.labels;
        let cables = self.robot().cable_count();
        let length = |kind| matches!(kind, ReadingKind::Length(_));
        let latent = self.problem.has_latent_tension();
        Identification {
            method: match self.problem.method {
                Method::Joint => "joint",
                Method::Simple => "simple",
            }
            .to_owned(),
            converged: self.solution.converged(),
            iterations: self.solution.iterations,
            seconds: self.seconds,
            chi2: self.solution.chi2,
            dof: self.solution.degrees_of_freedom,
            p_value: self.solution.p_value(),
            entry_points_m: self.solution.globals.entry_points.clone(),
            entry_points_sd_m: (0..cables)
                .map(|cable| [0, 1, 2].map(|axis| self.entry_point_sd(cable, axis)))
                .collect(),
            rms: Rms {
                length_m: self.analysis.rms(length),
                laser_m: self.analysis.rms(|kind| kind == ReadingKind::Laser),
                tension_n: self.analysis.tension_rms_n().filter(|_| latent),
            },
            poses: self
                .solution
                .poses
                .iter()
                .map(|(row, pose)| FittedPose {
                    pose: labels[*row],
                    position_m: pose.position.into(),
                    orientation_wxyz: pose.orientation_wxyz(),
                })
                .collect(),
            effects: self.effects(),
            undetermined: self.open.iter().map(|d| d.sentence.clone()).collect(),
            suspect_readings: self.suspects(),
        }
    }

    /// The robot with the identified values; standard deviations become those of the solution.
    pub fn model(&self) -> Robot {
        let mut model = self.robot().clone();
        let globals = &self.solution.globals;
        for (index, cable) in model.cables.iter_mut().enumerate() {
            cable.pulley.entry_point_m = globals.entry_points[index];
            let sds = [0, 1, 2].map(|axis| self.entry_point_sd(index, axis));
            if let [Some(x), Some(y), Some(z)] = sds {
                cable.pulley.entry_point_sd_m = Some(PerAxis::Each([x, y, z]));
            }
        }
        if let Some(laser) = &mut model.laser {
            laser.target_plane.offset_m = globals.plane_offset_m;
            let plane = |id: &ParameterId| *id == ParameterId::PlaneOffset;
            if let Some(k) = self.solution.parameters.iter().position(|p| plane(&p.id)) {
                let sd = self.solution.standard_deviation(k);
                laser.target_plane.offset_sd_m = sd.or(laser.target_plane.offset_sd_m);
            }
        }
        if let Some(home) = &mut model.home {
            home.position_m = globals.home.position.into();
            home.orientation_wxyz = globals.home.orientation_wxyz();
        }
        model.effects = globals
            .effects
            .iter()
            .map(|b| b.setting(self.robot()))
            .collect();
        model
    }
}

/// The readable report.
pub fn print_report(fitted: &Fitted<'_>, identification: &Identification) {
    let solution = fitted.solution;
    say!("{}", headline(fitted, identification));
    say!("{}", adequacy(identification));
    let mut points = table::numbers(&[
        "Cable", "x mm", "y mm", "z mm", "sd x", "sd y", "sd z", "moved mm",
    ]);
    for (index, cable) in fitted.robot().cables.iter().enumerate() {
        let point = solution.globals.entry_points[index];
        let nominal = cable.pulley.entry_point_m;
        let sds = identification.entry_points_sd_m[index];
        let moved = (0..3)
            .map(|k| (point[k] - nominal[k]).powi(2))
            .sum::<f64>()
            .sqrt();
        let mut cells = vec![cable.name.clone()];
        cells.extend(point.map(|v| table::mm(v, 2)));
        cells.extend(sds.map(|sd| sd.map_or("open".to_owned(), |sd| table::mm(sd, 2))));
        cells.push(table::mm(moved, 2));
        table::push(&mut points, &cells);
    }
    say!("{points}");
    if !identification.effects.is_empty() {
        let mut effects = table::numbers(&["Effect", "value", "sd", "unit"]);
        for effect in &identification.effects {
            let on = effect.targets.join(", ");
            let name = format!("{} {} {on}", effect.effect, effect.parameter);
            let sd = effect
                .sd
                .map_or("open".to_owned(), |sd| format!("{sd:.3e}"));
            let cells = [
                name,
                format!("{:.5e}", effect.value),
                sd,
                effect.unit.clone(),
            ];
            table::push(&mut effects, &cells);
        }
        say!("{effects}");
    }
    let rms = &identification.rms;
    let show = |name: &str, value: Option<f64>, scale: f64, unit: &str| {
        if let Some(value) = value {
            say!("rms residual {name}: {:.3} {unit}", value * scale);
        }
    };
    show("of lengths", rms.length_m, 1e3, "mm");
    show("of the laser", rms.laser_m, 1e3, "mm");
    show("of tensions", rms.tension_n, 1.0, "N");
    for sentence in &identification.undetermined {
        say!("open: {sentence}");
    }
    let suspects = &identification.suspect_readings;
    for suspect in suspects.iter().take(SUSPECTS_SHOWN) {
        say!("suspect: {suspect}");
    }
    if suspects.len() > SUSPECTS_SHOWN {
        say!(
            "... and {} more suspect readings",
            suspects.len() - SUSPECTS_SHOWN
        );
    }
}

fn headline(fitted: &Fitted<'_>, identification: &Identification) -> String {
    let end = if identification.converged {
        "converged"
    } else {
        "did NOT converge"
    };
    format!(
        "{}: {} poses, {} method {end} after {} iterations in {:.3} ms",
        fitted.robot().name,
        identification.poses.len(),
        identification.method,
        identification.iterations,
        identification.seconds * 1e3
    )
}

/// Whether the model explains the data, in words.
fn adequacy(identification: &Identification) -> String {
    let (chi2, dof) = (identification.chi2, identification.dof);
    let figures = format!("chi-square {chi2:.1} for {dof:.0} degrees of freedom");
    match identification.p_value {
        None => format!("{figures}: the data cannot be checked, nothing is redundant"),
        Some(p) if p < 1e-4 => format!("{figures}: the model does NOT explain the data"),
        Some(p) if p < 0.01 => {
            format!("{figures} (p = {p:.4}): the model hardly explains the data")
        }
        Some(p) if p > 0.9999 => {
            format!("{figures}: the data scatter less than the stated noise")
        }
        Some(p) => format!("{figures} (p = {p:.3}): the model explains the data"),
    }
}
