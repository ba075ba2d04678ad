//! Health checks of simulated robots with known truth: false alarms, what is found as predicted, and what is named.

use std::fmt::Write as _;

use anyhow::{Context, Result};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, UnitSphere};
use tautline_core::effect::{EffectSetting, every_effect};
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

use crate::tables::lives::{ROBOTS, drawing, share};

/// Poses of a baseline.
const BASELINE_POSES: usize = 40;
/// Checks of an unchanged robot for each robot.
const UNCHANGED: usize = 4;
/// Moves of pulleys (m) and sizes of faults over the largest typical one, log-uniform.
const MOVE_M: [f64; 2] = [1e-3, 2e-2];
const FAULT: [f64; 2] = [0.1, 1.0];
/// Bins of the predicted probability of detection.
const BINS: [f64; 6] = [0.0, 0.1, 0.4, 0.7, 0.95, 1.0 + f64::EPSILON];

/// What checks of changed robots came to.
#[derive(Debug, Clone, Copy, Default)]
struct Outcomes {
    checks: usize,
    changed: usize,
    undecided: usize,
    named: usize,
    wrong: usize,
}

/// Counts over robots.
#[derive(Debug, Clone, Default)]
pub struct Counts {
    unchanged: usize,
    alarms: usize,
    undecided: usize,
    /// Recordings of unchanged robots at work, and alarms.
    worked: usize,
    work_alarms: usize,
    moves: Outcomes,
    faults: Outcomes,
    /// Moves by their predicted probability: sum of the predictions, number, found.
    predicted: [(f64, usize, usize); 5],
    seconds: Vec<f64>,
}

/// Checks `robots` robots, from a first seed on.
///
/// # Errors
/// If a robot cannot be simulated or identified.
pub fn study(robots: usize, first_seed: u64) -> Result<Vec<(&'static str, Counts)>> {
    let mut found: Vec<(&'static str, Counts)> =
        ROBOTS.map(|name| (name, Counts::default())).into();
    for robot in 0..robots {
        let (name, counts) = &mut found[robot % ROBOTS.len()];
        one(name, first_seed + robot as u64, counts)
            .with_context(|| format!("{name}, robot {robot}"))?;
    }
    Ok(found)
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

fn one(name: &str, seed: u64, counts: &mut Counts) -> Result<()> {
    let machine = Machine::new(name, 10_000 * seed)?;
    let mut rng = ChaCha8Rng::seed_from_u64(10_000 * seed);
    rng.set_stream(3);
    let mut expected = None;
    for number in 0..UNCHANGED {
        let started = std::time::Instant::now();
        let checked = machine.check(&machine.truth, 2 + number as u64)?;
        counts.seconds.push(started.elapsed().as_secs_f64());
        counts.unchanged += 1;
        counts.alarms += usize::from(checked.verdict == HealthVerdict::Changed);
        counts.undecided += usize::from(checked.verdict == HealthVerdict::Undecided);
        // The prediction needs no readings of its own: it is the same with all of an unchanged robot.
        expected.get_or_insert(checked);
    }
    let worked = machine.work(9)?;
    counts.worked += 1;
    counts.work_alarms += usize::from(worked.verdict == HealthVerdict::Changed);
    let (cable, by) = moved(&machine.drawing, &mut rng);
    let mut truth = machine.truth.clone();
    let entry = &mut truth.cables[cable].pulley.entry_point_m;
    *entry = [0, 1, 2].map(|axis| entry[axis] + by[axis]);
    let checked = machine.check(&truth, 10)?;
    let is_it = |part: &RobotPart| *part == RobotPart::Pulley(cable);
    counts.moves.add(&checked, is_it);
    let name = &machine.drawing.cables[cable].name;
    let predicted = expected.and_then(|expected| expected.detection(name, by.norm()));
    if let Some(predicted) = predicted {
        let bin = BINS.partition_point(|edge| *edge <= predicted) - 1;
        let (sum, all, found) = &mut counts.predicted[bin];
        *sum += predicted;
        *all += 1;
        *found += usize::from(checked.verdict == HealthVerdict::Changed);
    }
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
        counts.faults.add(&checked, is_it);
    }
    Ok(())
}

fn log_uniform(rng: &mut ChaCha8Rng, [low, high]: [f64; 2]) -> f64 {
    rng.random_range(low.ln()..high.ln()).exp()
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
    (cable, along.normalize() * log_uniform(rng, MOVE_M))
}

/// A fault of one cable: an effect of the catalogue whose parts have tolerances and that has one number.
fn fault(drawing: &Robot, rng: &mut ChaCha8Rng) -> Option<EffectSetting> {
    let all = every_effect().filter(|effect| effect.has_tolerance());
    let of_cable: Vec<_> = all
        .filter(|effect| {
            let is_of_cable = effect.scope() == tautline_core::effect::Scope::Cable;
            is_of_cable && effect.parameters().len() == 1
        })
        .collect();
    let effect = of_cable.get(rng.random_range(0..of_cable.len().max(1)))?;
    let cable = &drawing.cables[rng.random_range(0..drawing.cable_count())];
    let parameter = effect.parameters()[0];
    let [_, largest] = parameter.typical_sizes();
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let value = parameter.neutral + sign * largest * log_uniform(rng, FAULT);
    Some(EffectSetting {
        effect: effect.id().to_owned(),
        targets: vec![cable.name.clone()],
        parameters: [(parameter.name.to_owned(), value)].into(),
    })
}

impl Outcomes {
    fn add(&mut self, checked: &Checked, is_it: impl Fn(&RobotPart) -> bool) {
        let named = checked.certain();
        let is_right = named.map(|jump| is_it(&checked.found.history.parts[jump.part]));
        self.checks += 1;
        self.changed += usize::from(checked.verdict == HealthVerdict::Changed);
        self.undecided += usize::from(checked.verdict == HealthVerdict::Undecided);
        self.named += usize::from(is_right == Some(true));
        self.wrong += usize::from(is_right == Some(false));
    }

    fn sum(self, other: Self) -> Self {
        Self {
            checks: self.checks + other.checks,
            changed: self.changed + other.changed,
            undecided: self.undecided + other.undecided,
            named: self.named + other.named,
            wrong: self.wrong + other.wrong,
        }
    }
}

/// The tables in Markdown.
#[must_use]
pub fn markdown(found: &[(&'static str, Counts)]) -> String {
    let mut text = String::from(
        "| robot | unchanged: alarm | undecided | at work without laser, unchanged: alarm | pulley moved: found | undecided | named | named wrongly | fault: found | undecided | named | named wrongly | median ms |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let mut all = Counts::default();
    for (_, counts) in found {
        all.add(counts);
    }
    for (name, counts) in found.iter().map(|(n, c)| (*n, c)).chain([("all", &all)]) {
        let mut seconds = counts.seconds.clone();
        seconds.sort_by(f64::total_cmp);
        let of = |one: &Outcomes| {
            format!(
                "{} | {} | {} | {}",
                share(one.changed, one.checks),
                one.undecided,
                one.named,
                one.wrong
            )
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} | {:.0} |",
            share(counts.alarms, counts.unchanged),
            counts.undecided,
            share(counts.work_alarms, counts.worked),
            of(&counts.moves),
            of(&counts.faults),
            1e3 * seconds.get(seconds.len() / 2).copied().unwrap_or(f64::NAN),
        );
    }
    text += "\n| predicted probability of finding the move | moves | mean prediction | found |\n|---|--:|--:|--:|\n";
    for (edges, (sum, count, found)) in BINS.windows(2).zip(all.predicted) {
        let mean = sum / count.max(1) as f64;
        let _ = writeln!(
            text,
            "| {:.0} to {:.0} % | {count} | {:.0} % | {} |",
            100.0 * edges[0],
            100.0 * edges[1],
            100.0 * mean,
            share(found, count)
        );
    }
    text
}

impl Counts {
    fn add(&mut self, other: &Self) {
        self.unchanged += other.unchanged;
        self.alarms += other.alarms;
        self.undecided += other.undecided;
        self.worked += other.worked;
        self.work_alarms += other.work_alarms;
        self.moves = self.moves.sum(other.moves);
        self.faults = self.faults.sum(other.faults);
        for (own, other) in self.predicted.iter_mut().zip(&other.predicted) {
            own.0 += other.0;
            own.1 += other.1;
            own.2 += other.2;
        }
        self.seconds.extend(&other.seconds);
    }
}
