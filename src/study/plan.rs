//! The plan of a study: everything that its chunks need, and the predictions of the expected covariance.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::estimation::Control;
use tautline_core::geometry::Pose;
use tautline_core::planning::{PlanError, plan, random_poses};
use tautline_core::robot::{FrameTransform, Robot};
use tautline_session::{
    Catalogue, Fingerprint, VersionedFile, read_robot, read_versioned, versioned, write_versioned,
};
use tautline_workflow::machines;

use crate::cell::{Cell, options, robot_of};
use crate::chunk::ChunkNumber;
use crate::design::{Combination, combinations};
use crate::file::{Choice, StudyFile, check_faults};
use crate::scaling::size_m;
use crate::{StudyError, create_folder};

/// File of the plan in the folder of a study.
pub const PLAN: &str = "plan.json";
/// Number of feasible candidates from which poses are planned.
const CANDIDATES: usize = 600;

/// A study, ready to run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StudyPlan {
    /// The study.
    pub study: StudyFile,
    /// The robots, in the order of the design.
    pub robots: Vec<Robot>,
    /// Sequences of poses, without home, shared by cells.
    pub poses: Vec<Vec<FrameTransform>>,
    /// The cells.
    pub cells: Vec<PlannedCell>,
}

/// A cell with its expected accuracy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlannedCell {
    /// Its combination.
    pub combination: Combination,
    /// Standard deviation of the laser's readings (m); null without a laser.
    pub laser_sd_m: Option<f64>,
    /// Price of its sensor, if the catalogue states one.
    #[serde(default)]
    pub cost: Option<f64>,
    /// Index of the sequence from which it takes the first poses.
    pub sequence: usize,
    /// Errors predicted by the expected covariance.
    pub expected: ExpectedErrors,
}

/// Errors predicted by the expected covariance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExpectedErrors {
    /// Root mean square error of the entry point coordinates (m); null if the poses leave parameters undetermined.
    pub entry_m: Option<f64>,
    /// Root mean square position error over the workspace (m); also null without home pose.
    pub position_m: Option<f64>,
    /// Root mean square position error per kelvin of warming of a steel frame since calibration (m/K).
    pub position_m_per_kelvin: Option<f64>,
}

impl VersionedFile for StudyPlan {
    const FORMAT: &'static str = "tautline-study-plan";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;
}

impl StudyPlan {
    /// Plans a study with robot files from `folder`. The observer receives the numbers of finished and of all cells.
    ///
    /// # Errors
    /// If a robot or sensor cannot be used, a cell cannot be predicted, or it was cancelled; the message names the field.
    pub fn new(
        study: StudyFile,
        folder: &Path,
        observer: &mut dyn FnMut(usize, usize) -> Control,
    ) -> Result<Self, StudyError> {
        let robots = (study.design.robots.iter().enumerate())
            .map(|(index, name)| robot(name, folder, index))
            .collect::<Result<Vec<_>, _>>()?;
        let robots = know(robots, &study)?;
        check_faults(&study, &robots).map_err(|error| StudyError::Input(error.to_string()))?;
        let catalogue = Catalogue::of_user()?;
        let combinations = combinations(&study)?;
        let mut sequences = Sequences::default();
        let mut cells = Vec::with_capacity(combinations.len());
        let all = combinations.len();
        for (index, combination) in combinations.into_iter().enumerate() {
            if observer(index, all) == Control::Cancel {
                return Err(StudyError::Cancelled);
            }
            let base = &robots[combination.robot];
            let robot = robot_of(base, &combination, &catalogue).map_err(StudyError::Input)?;
            let sequence = sequences.of(&study, base, &combination, &robot)?;
            let poses = sequences.poses[sequence][..combination.poses].to_vec();
            let sensor = catalogue.find(&combination.laser).ok();
            cells.push(PlannedCell {
                laser_sd_m: robot.laser.map(|laser| laser.sd_m),
                cost: sensor.and_then(|sensor| sensor.cost),
                sequence,
                expected: expected(robot, poses, &combination)?,
                combination,
            });
        }
        observer(all, all);
        Ok(Self {
            poses: sequences
                .poses
                .iter()
                .map(|poses| poses.iter().map(transform).collect())
                .collect(),
            study,
            robots,
            cells,
        })
    }

    /// The robot and the poses of a cell.
    ///
    /// # Errors
    /// If they do not exist, as in a plan edited by hand.
    pub fn cell(&self, index: usize) -> Result<Cell, StudyError> {
        let planned = self.cells.get(index);
        let damaged = || {
            StudyError::Input(format!(
                "{PLAN}: cell {index} is damaged, expected a plan written by this program"
            ))
        };
        let planned = planned.ok_or_else(damaged)?;
        let combination = &planned.combination;
        let base = self.robots.get(combination.robot).ok_or_else(damaged)?;
        // The catalogue of another machine may differ, so the standard deviation of the plan is used.
        let known = Combination {
            laser: if combination.laser == "none" {
                "none"
            } else {
                "own"
            }
            .to_owned(),
            ..combination.clone()
        };
        let mut robot =
            robot_of(base, &known, &Catalogue::with(None)?).map_err(StudyError::Input)?;
        if let (Some(laser), Some(sd_m)) = (&mut robot.laser, planned.laser_sd_m) {
            laser.sd_m = sd_m;
        }
        let poses = self
            .poses
            .get(planned.sequence)
            .and_then(|poses| poses.get(..combination.poses));
        let poses = poses
            .ok_or_else(damaged)?
            .iter()
            .map(FrameTransform::pose)
            .collect();
        Cell::new(robot, poses, combination.method.of_solver())
            .map_err(|error| input(combination, &error))
    }

    /// The cells that are simulated.
    #[must_use]
    pub fn simulated(&self) -> Vec<usize> {
        let is_simulated = |index: &usize| self.cells[*index].combination.is_simulated;
        (0..self.cells.len()).filter(is_simulated).collect()
    }

    /// Number of calibrations of the whole study.
    #[must_use]
    pub fn calibrations(&self) -> u64 {
        self.simulated().len() as u64 * self.study.simulation.calibrations
    }

    /// Default number of chunks.
    #[must_use]
    pub fn chunks(&self) -> u64 {
        self.calibrations().div_ceil(self.study.simulation.chunk)
    }

    /// The chunks to run: the one named by `chunk`, such as `3/7`, or all of the default division.
    ///
    /// # Errors
    /// If the text is malformed.
    pub fn parts(&self, chunk: Option<&str>) -> Result<Vec<ChunkNumber>, String> {
        let of = self.chunks();
        match chunk {
            Some(text) => Ok(vec![ChunkNumber::parse(text)?]),
            None => Ok((1..=of).map(|number| ChunkNumber { number, of }).collect()),
        }
    }

    /// Fingerprint of everything on which results depend.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        let text = serde_json::to_string(&versioned(self)).unwrap_or_default();
        Fingerprint::of(text.as_bytes()).to_hex()
    }

    /// Writes the plan into the folder of the study.
    ///
    /// # Errors
    /// If it cannot be written, or the folder holds that of another study.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, StudyError> {
        let path = folder.join(PLAN);
        if path.exists() && read_plan(folder)?.fingerprint() != self.fingerprint() {
            return Err(StudyError::Input(format!(
                "{}: belongs to another study, expected an empty folder",
                path.display()
            )));
        }
        create_folder(folder)?;
        write_versioned(&path, self)?;
        Ok(path)
    }
}

/// Reads the plan of a study from its folder.
///
/// # Errors
/// If it is missing or invalid.
pub fn read_plan(folder: &Path) -> Result<StudyPlan, StudyError> {
    Ok(read_versioned::<StudyPlan>(&folder.join(PLAN))?.value)
}

fn robot(name: &str, folder: &Path, index: usize) -> Result<Robot, StudyError> {
    if let Some(machine) = machines::find(name) {
        return Ok(machine.robot);
    }
    let path = folder.join(name);
    if !path.exists() {
        let names = machines::names().join(", ");
        return Err(StudyError::Input(format!(
            "/design/robots/{index}: found \"{name}\", expected a robot.json or one of {names}"
        )));
    }
    let robot = read_robot(&path)?.value;
    if !robot.effects.is_empty() {
        return Err(StudyError::Input(format!(
            "{}: found a model with effects, expected a robot without effects; list hidden effects as faults",
            path.display()
        )));
    }
    Ok(robot)
}

/// The robots with the hypotheses of a study.
fn know(mut robots: Vec<Robot>, study: &StudyFile) -> Result<Vec<Robot>, StudyError> {
    for robot in &mut robots {
        for hypothesis in &study.hypotheses {
            let added = robot.add_hypothesis(hypothesis);
            added.map_err(|error| StudyError::Input(format!("/hypotheses: {error}")))?;
        }
    }
    Ok(robots)
}

/// Cache of pose sequences, by robot, selection and number.
#[derive(Default)]
struct Sequences {
    poses: Vec<Vec<Pose>>,
    keys: Vec<String>,
}

impl Sequences {
    /// Index of the sequence of a cell: planned poses are chosen once per robot with its own instruments, so that
    /// cells differ only in their combination; random poses are drawn once for all numbers of poses.
    fn of(
        &mut self,
        study: &StudyFile,
        base: &Robot,
        cell: &Combination,
        robot: &Robot,
    ) -> Result<usize, StudyError> {
        let most = study
            .design
            .poses
            .iter()
            .copied()
            .max()
            .unwrap_or(cell.poses);
        let count = match cell.choice {
            Choice::Planned => cell.poses,
            Choice::Random => most,
        };
        let has_laser = robot.laser.is_some();
        let key = format!(
            "{} {:?} {:?} {count} {has_laser}",
            cell.robot,
            cell.size_m.map(f64::to_bits),
            cell.choice
        );
        if let Some(known) = self.keys.iter().position(|other| *other == key) {
            return Ok(known);
        }
        let own = Combination {
            laser: if has_laser { "own" } else { "none" }.to_owned(),
            home_sd_m: None,
            inclinometer_sd_rad: None,
            length_sd_m: None,
            tension_sd_n: None,
            ..cell.clone()
        };
        let robot = robot_of(base, &own, &Catalogue::with(None)?).map_err(StudyError::Input)?;
        let mut options = options(count, study.seed, size_m(&robot));
        options.candidates = CANDIDATES.max(count);
        let poses = match cell.choice {
            Choice::Planned => plan(&robot, &options, &mut |_| Control::Continue)
                .map(|planned| planned.poses.iter().map(|planned| planned.pose).collect()),
            Choice::Random => random_poses(&robot, &options),
        };
        self.poses.push(poses.map_err(|error| input(cell, &error))?);
        self.keys.push(key);
        Ok(self.poses.len() - 1)
    }
}

fn expected(
    robot: Robot,
    poses: Vec<Pose>,
    combination: &Combination,
) -> Result<ExpectedErrors, StudyError> {
    let cell = Cell::new(robot, poses, combination.method.of_solver())
        .map_err(|error| input(combination, &error))?;
    let criteria = cell.expected().criteria;
    Ok(ExpectedErrors {
        entry_m: criteria.mean_m,
        position_m: criteria.platform_m,
        position_m_per_kelvin: cell.position_m_per_kelvin(),
    })
}

fn input(cell: &Combination, error: &PlanError) -> StudyError {
    let size = cell
        .size_m
        .map_or_else(String::new, |size| format!(" of {size} m"));
    StudyError::Input(format!(
        "/design: robot {}{size} with {} poses: {error}",
        cell.robot + 1,
        cell.poses
    ))
}

fn transform(pose: &Pose) -> FrameTransform {
    FrameTransform {
        position_m: pose.position.into(),
        orientation_wxyz: pose.orientation_wxyz(),
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::effect::{Hypothesis, every_effect};
    use tautline_core::estimation::Method;
    use tautline_session::parse_versioned_toml;

    use super::*;
    use crate::calibration::{Outcome, Simulator};

    /// A study whose machines have a fault in every calibration.
    fn study(fault: &str, hypotheses: &[String]) -> StudyFile {
        let text = format!(
            "format = \"tautline-study\"\nversion = 1\nname = \"s\"\n\
             [design]\nrobots = [\"planar\"]\nposes = [12]\nchoice = [\"random\"]\n\
             [[faults]]\neffect = \"{fault}\"\nrate = 1.0\n"
        );
        let read = parse_versioned_toml::<StudyFile>(text.as_bytes(), "s.toml").expect("a study");
        let mut study = read.value;
        let parsed = hypotheses.iter().map(|text| Hypothesis::parse(text));
        study.hypotheses = parsed.collect::<Result<_, _>>().expect("hypotheses");
        study
    }

    fn planned(study: StudyFile) -> Result<StudyPlan, StudyError> {
        StudyPlan::new(study, Path::new("."), &mut |_, _| Control::Continue)
    }

    #[test]
    fn a_fault_may_be_a_hypothesis() {
        let robot = machines::find("planar").expect("a machine").robot;
        let mut effects = every_effect();
        let scale = effects
            .find(|effect| effect.id() == "winch_scale")
            .expect("an effect");
        let text = scale.as_text(&robot).expect("a text");
        let plan = planned(study("my_winch_scale", &[text])).expect("a plan");
        let cell = plan.cell(0).expect("a cell");
        let simulator = Simulator::new(&plan.study, &cell, Method::Joint).expect("held");
        let of_text = simulator.calibrate(3, 0);
        assert_eq!((of_text.outcome, of_text.faults), (Outcome::Converged, 1));

        // The same fault of the catalogue, with the same random numbers.
        let plan = planned(study("winch_scale", &[])).expect("a plan");
        let cell = plan.cell(0).expect("a cell");
        let simulator = Simulator::new(&plan.study, &cell, Method::Joint).expect("held");
        let of_catalogue = simulator.calibrate(3, 0);
        assert!((of_text.chi2 / of_catalogue.chi2 - 1.0).abs() < 1e-9);
        assert!(
            of_text.chi2 > 2.0 * of_text.degrees_of_freedom,
            "a fault that shows"
        );
    }

    #[test]
    fn a_fault_that_no_robot_knows_is_refused() {
        let error = planned(study("rust", &[]))
            .expect_err("refused")
            .to_string();
        assert_eq!(
            error,
            "/faults/0/effect: found \"rust\", expected an effect that the command effects lists"
        );
        let error = planned(study("cable_swap", &[]))
            .expect_err("refused")
            .to_string();
        assert!(
            error.ends_with("expected an effect of one cable or of the robot"),
            "{error}"
        );
    }
}
