//! Health checks of simulated robots with known truth: false alarms, what is found as predicted, and what is named.

use std::ops::Range;

use anyhow::Result;
use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, UnitSphere};
use serde::{Deserialize, Serialize};
use tautline_core::effect::{EffectSetting, Scope, every_effect};
use tautline_core::geometry::Pose;
use tautline_core::history::RobotPart;
use tautline_core::measurement::Dataset;
use tautline_core::planning::PlanOptions;
use tautline_core::robot::{PartTolerances, Robot};
use tautline_core::simulation::{
    Recording, SimulationOptions, TensionRange, TrueGeometry, Workspace, record, simulate,
};
use tautline_session::{Session, Timestamp};
use tautline_workflow::health::{Baseline, Checked, HealthVerdict, POSES};

use super::counting::{Share, by_name, median, total};
use super::lives::{ROBOTS, drawing, robot};
use super::markdown::Table;
use super::simulated::{exp_uniform, random_sign, setting, stream, timed};
use super::study::Study;

/// Poses of a baseline.
const BASELINE_POSES: usize = 40;
/// Checks of an unchanged robot for each robot.
const UNCHANGED: usize = 4;
/// Moves of pulleys (m) and sizes of faults over the largest typical one, log-uniform.
const MOVE_M: [f64; 2] = [1e-3, 2e-2];
const FAULT: [f64; 2] = [0.1, 1.0];
/// Bins of the predicted probability of detection.
const BINS: [f64; 6] = [0.0, 0.1, 0.4, 0.7, 0.95, 1.0 + f64::EPSILON];

/// Seed of the first robot.
pub const FIRST_SEED: u64 = 45_000;

/// Robots with these seeds, in turn.
#[derive(Debug)]
pub struct Health(pub Range<u64>);

/// What the check of a changed robot comes to.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Change {
    is_found: bool,
    is_undecided: bool,
    /// Whether the right part is named, if one is.
    is_right: Option<bool>,
}

/// What the checks of one robot come to.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    /// Alarms of the unchanged robot, and its recording at work.
    alarms: Share,
    undecided: usize,
    is_alarm_at_work: bool,
    moved: Change,
    /// Probability of finding the move, as predicted.
    predicted: Option<f64>,
    fault: Option<Change>,
    seconds: Vec<f64>,
}

impl Study for Health {
    type Case = u64;
    type Outcome = Outcome;

    fn cases(&self) -> Result<Vec<u64>> {
        Ok(self.0.clone().collect())
    }

    fn run(&self, seed: &u64) -> Result<Option<Outcome>> {
        one(robot(*seed), 10_000 * seed).map(Some)
    }

    fn table(&self, outcomes: &[(u64, Outcome)]) -> Result<String> {
        let mut table = Table::of_numbers(
            "robot | unchanged: alarm | undecided | at work without laser, unchanged: alarm | pulley moved: found | undecided | named | named wrongly | fault: found | undecided | named | named wrongly | median ms",
        );
        for (name, all) in by_name(&ROBOTS, outcomes, |seed| robot(*seed)) {
            let faults = all.iter().filter_map(|one| one.fault);
            table.row(format_args!(
                "{name} | {} | {} | {} | {} | {} | {:.0}",
                total(&all, |one| one.alarms),
                total(&all, |one| one.undecided),
                Share::of(&all, |one| one.is_alarm_at_work),
                changes(all.iter().map(|one| one.moved).collect()),
                changes(faults.collect()),
                1e3 * median(all.iter().flat_map(|one| one.seconds.clone())),
            ));
        }
        Ok(format!("{}\n{}", table.text(), predictions(outcomes)))
    }
}

fn changes(all: Vec<Change>) -> String {
    let count = |is: fn(&&Change) -> bool| all.iter().filter(is).count();
    format!(
        "{} | {} | {} | {}",
        Share::of(&all, |one| one.is_found),
        count(|one| one.is_undecided),
        count(|one| one.is_right == Some(true)),
        count(|one| one.is_right == Some(false)),
    )
}

/// Moves by their predicted probability of being found.
fn predictions(outcomes: &[(u64, Outcome)]) -> String {
    let mut table = Table::of_numbers(
        "predicted probability of finding the move | moves | mean prediction | found",
    );
    for edges in BINS.windows(2) {
        let moves = outcomes.iter().filter_map(|(_, one)| {
            let predicted = one.predicted?;
            (edges[0]..edges[1])
                .contains(&predicted)
                .then_some((predicted, one.moved.is_found))
        });
        let found = Share::of(moves.clone(), |(_, is_found)| is_found);
        let sum = moves.fold(0.0, |sum, (predicted, _)| sum + predicted);
        table.row(format_args!(
            "{:.0} to {:.0} % | {} | {:.0} % | {found}",
            100.0 * edges[0],
            100.0 * edges[1],
            found.whole,
            100.0 * sum / found.whole.max(1) as f64,
        ));
    }
    table.text()
}

/// A true robot with the calibration that it is checked against, and the poses of the checks.
struct Machine {
    drawing: Robot,
    truth: Robot,
    baseline: Baseline,
    poses: Vec<Pose>,
    seed: u64,
}

impl Machine {
    fn new(name: &str, seed: u64) -> Result<Self> {
        let mut drawing = drawing(name)?;
        drawing.tolerances = Some(PartTolerances::typical());
        let truth = simulate(&drawing, &SimulationOptions::new(1, seed))?.truth;
        let measured = readings(
            &drawing,
            &truth,
            SimulationOptions::new(BASELINE_POSES, seed + 1),
        )?;
        let mut session =
            Session::new("baseline", drawing.clone(), Timestamp::from_unix_seconds(0));
        session.measurements = measured.measurements;
        let baseline = Baseline::new(&session, None)?;
        let planned = baseline.plan(&PlanOptions::new(POSES, seed));
        let planned = planned.map_err(anyhow::Error::msg)?;
        Ok(Self {
            poses: planned.poses.iter().map(|planned| planned.pose).collect(),
            drawing,
            truth,
            baseline,
            seed,
        })
    }

    /// A minute of ordinary work without the laser.
    fn work(&self, number: u64) -> Result<Checked> {
        let options = settled(&self.drawing, SimulationOptions::new(0, self.seed + number));
        let recording = Recording {
            duration_s: 60.0,
            rate_hz: 20.0,
            correlation_s: 0.02,
        };
        let mut dataset = record(&self.truth, &options, &recording)?.dataset;
        dataset.robot = self.drawing.clone();
        dataset.measurements.laser_m.fill(f64::NAN);
        Ok(self.baseline.check(&dataset, None)?)
    }

    fn check(&self, truth: &Robot, number: u64) -> Result<Checked> {
        let options = SimulationOptions::new(POSES, self.seed + number);
        let options = options.commanding(self.poses.clone());
        let dataset = readings(&self.drawing, truth, options)?;
        Ok(self.baseline.check(&dataset, None)?)
    }
}

/// Options for the robot as it is, within the limits of its drawing.
fn settled(drawing: &Robot, options: SimulationOptions) -> SimulationOptions {
    SimulationOptions {
        geometry: TrueGeometry::Nominal,
        workspace: Some(Workspace::of(drawing)),
        tension: Some(TensionRange::of(drawing)),
        ..options
    }
}

fn readings(drawing: &Robot, truth: &Robot, options: SimulationOptions) -> Result<Dataset> {
    let options = settled(drawing, options);
    let mut dataset = simulate(truth, &options)?.dataset;
    dataset.robot = drawing.clone();
    Ok(dataset)
}

fn one(name: &str, seed: u64) -> Result<Outcome> {
    let machine = Machine::new(name, seed)?;
    let mut rng = stream(seed, 3);
    let mut expected = None;
    let (mut alarms, mut undecided, mut seconds) = (Share::default(), 0, Vec::new());
    for number in 0..UNCHANGED {
        let (checked, spent_s) = timed(|| machine.check(&machine.truth, 2 + number as u64));
        let checked = checked?;
        seconds.push(spent_s);
        alarms.count(checked.verdict == HealthVerdict::Changed);
        undecided += usize::from(checked.verdict == HealthVerdict::Undecided);
        // The prediction needs no readings of its own: it is the same with all of an unchanged robot.
        expected.get_or_insert(checked);
    }
    let worked = machine.work(9)?;
    let (cable, by) = moved(&machine.drawing, &mut rng);
    let mut truth = machine.truth.clone();
    let entry = &mut truth.cables[cable].pulley.entry_point_m;
    *entry = [0, 1, 2].map(|axis| entry[axis] + by[axis]);
    let checked = machine.check(&truth, 10)?;
    let cable_name = &machine.drawing.cables[cable].name;
    let mut outcome = Outcome {
        alarms,
        undecided,
        is_alarm_at_work: worked.verdict == HealthVerdict::Changed,
        moved: Change::of(&checked, |part| *part == RobotPart::Pulley(cable)),
        predicted: expected.and_then(|expected| expected.detection(cable_name, by.norm())),
        fault: None,
        seconds,
    };
    if let Some(fault) = fault(&machine.drawing, &mut rng) {
        let mut truth = machine.truth.clone();
        truth.effects.push(fault.clone());
        let checked = machine.check(&truth, 11)?;
        let is_it = |part: &RobotPart| match part {
            RobotPart::Effect {
                effect, targets, ..
            } => *effect == fault.effect && *targets == fault.targets,
            RobotPart::Pulley(_) | RobotPart::TargetPlane => false,
        };
        outcome.fault = Some(Change::of(&checked, is_it));
    }
    Ok(outcome)
}

/// A pulley and how it moved, along the axes that are not known exactly.
fn moved(drawing: &Robot, rng: &mut ChaCha8Rng) -> (usize, Vector3<f64>) {
    let cable = rng.random_range(0..drawing.cable_count());
    let sd = drawing.cables[cable].pulley.entry_point_sd_m.each();
    let along: [f64; 3] = UnitSphere.sample(rng);
    let along = Vector3::from_fn(|axis, _| match sd[axis] {
        Some(0.0) => 0.0,
        _ => along[axis],
    });
    (cable, along.normalize() * exp_uniform(MOVE_M, rng))
}

/// A fault of one cable: an effect of the catalogue whose parts have tolerances and that has one number.
fn fault(drawing: &Robot, rng: &mut ChaCha8Rng) -> Option<EffectSetting> {
    let all = every_effect().filter(|effect| effect.has_tolerance());
    let of_cable = all.filter(|effect| effect.scope() == Scope::Cable);
    let of_cable: Vec<_> = of_cable
        .filter(|effect| effect.parameters().len() == 1)
        .collect();
    let effect = of_cable.get(rng.random_range(0..of_cable.len().max(1)))?;
    let cable = &drawing.cables[rng.random_range(0..drawing.cable_count())].name;
    let parameter = effect.parameters()[0];
    let [_, largest] = parameter.typical_sizes();
    let value = parameter.neutral + random_sign(rng) * largest * exp_uniform(FAULT, rng);
    Some(setting(
        effect.id(),
        &[cable.as_str()],
        parameter.name,
        value,
    ))
}

impl Change {
    fn of(checked: &Checked, is_it: impl Fn(&RobotPart) -> bool) -> Self {
        let named = checked.certain();
        Self {
            is_found: checked.verdict == HealthVerdict::Changed,
            is_undecided: checked.verdict == HealthVerdict::Undecided,
            is_right: named.map(|jump| is_it(&checked.found.history.parts[jump.part])),
        }
    }
}
