//! Simulated lives of robots with known truth: what the history of their sessions finds, how often what it states is true, and
//! whether a calibration comes in time.

use std::ops::Range;

use anyhow::{Context, Result, ensure};
use nalgebra::{DVector, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, UnitSphere};
use serde::{Deserialize, Serialize};
use tautline_core::comparison::Identified;
use tautline_core::effect::{BoundEffect, EffectSetting};
use tautline_core::estimation::{Problem, Solution};
use tautline_core::geometry::Pose;
use tautline_core::history::{
    CERTAIN, DatedRun, Forecast, History, Jump, OUT_OF_TOLERANCE, RobotPart, Tolerance, forecast,
    smooth,
};
use tautline_core::planning::position_weights;
use tautline_core::robot::{Robot, presets};
use tautline_core::simulation::{
    SimulationOptions, TensionRange, TrueGeometry, Workspace, simulate,
};
use tautline_workflow::templates::Template;

use super::counting::{Share, by_name, median, total};
use super::hidden::VISIBLE;
use super::markdown::Table;
use super::simulated::{NORMAL_95, exp_uniform, random_sign, setting, solved, stream, timed};
use super::study::Study;
use super::table1::position_errors;

/// Robots, in turn: four presets, and the template of a facade at its usual size.
pub(crate) const ROBOTS: [&str; 5] = ["mini", "hall", "suspended", "planar", "facade"];
/// Number of sessions, poses of each, and days between two of them.
const SESSIONS: usize = 12;
const POSES: usize = 40;
const DAYS: [f64; 2] = [20.0, 45.0];
/// Jumps of pulleys per session and their sizes (m), log-uniform.
const JUMPS: f64 = 0.1;
const JUMP_M: [f64; 2] = [1e-3, 1e-2];
/// Share of the pulleys that drift, and the largest rate (m per day).
const DRIFTING: f64 = 0.1;
const DRIFT_M: f64 = 0.5e-3 / 30.0;
/// Share of the robots of which a drum winds differently from some session on, as after a new cable, and of those of which
/// it changes once more; sizes of the effect, log-uniform. The model of these sessions has it.
const REWOUND: f64 = 0.4;
const REWOUND_AGAIN: f64 = 0.5;
const WINCH_SCALE: [f64; 2] = [1e-3, 2e-2];
/// Tolerance of a pulley for the date of the next calibration (m).
const TOLERANCE_M: f64 = 5e-3;
/// Tolerance of the position of the platform, over the error that is expected right after the last session, and the number of places in
/// the workspace where it is looked at.
const POSITION_FACTOR: f64 = 3.0;
const PLACES: usize = 60;
/// Seed of the first life.
pub const FIRST_SEED: u64 = 43_000;

/// What was hidden in a life.
struct Truth {
    /// True robot in each session.
    robots: Vec<Robot>,
    days: Vec<f64>,
    /// Pulley, session before it and displacement of each jump.
    jumps: Vec<(usize, usize, Vector3<f64>)>,
    /// Rate of each pulley (m per day).
    rates: Vec<Vector3<f64>>,
    drum: Option<Drum>,
}

/// A drum that winds differently from some session on.
struct Drum {
    cable: usize,
    /// Winch scale in each session; 0 where the model has none.
    scales: Vec<f64>,
}

impl Drum {
    fn draw(cables: usize, rng: &mut ChaCha8Rng) -> Self {
        let scale = |rng: &mut ChaCha8Rng| {
            let size = exp_uniform(WINCH_SCALE, rng);
            random_sign(rng) * size
        };
        let first = rng.random_range(1..SESSIONS);
        let mut scales = vec![0.0; SESSIONS];
        scales[first..].fill(scale(rng));
        if rng.random_bool(REWOUND_AGAIN) && first + 1 < SESSIONS {
            let again = rng.random_range(first + 1..SESSIONS);
            scales[again..].fill(scale(rng));
        }
        Self {
            cable: rng.random_range(0..cables),
            scales,
        }
    }

    /// The effect in a session, if it has it.
    fn effect(&self, robot: &Robot, session: usize) -> Option<EffectSetting> {
        let scale = self.scales[session];
        let target = robot.cables[self.cable].name.as_str();
        (scale != 0.0).then(|| setting("winch_scale", &[target], "scale", scale))
    }

    /// Sessions before a change, with its size.
    fn changes(&self) -> impl Iterator<Item = (usize, f64)> {
        let pairs = self.scales.windows(2).enumerate();
        pairs.filter_map(|(before, pair)| {
            let by = pair[1] - pair[0];
            (by != 0.0).then_some((before, by))
        })
    }
}

/// Lives of robots with these seeds, the robots in turn.
#[derive(Debug)]
pub struct Lives(pub Range<u64>);

/// What is found in one life.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Outcome {
    /// Visible jumps that are found, and those that are dated between two sessions.
    found: Share,
    dated: Share,
    /// Visible changes of a drum that are found.
    drums: Share,
    /// Intervals of a part without a jump in which one is certain.
    false_jumps: Share,
    /// Values in their intervals.
    values: Share,
    /// Drifts that are found, of pulleys that do not drift.
    false_drifts: Share,
    /// Coordinates of rates in their intervals.
    rates: Share,
    /// Robots out of tolerance at the date of their next calibration, for a tolerance of pulleys, and of the position.
    late: [Share; 2],
    seconds: f64,
}

impl Study for Lives {
    type Case = u64;
    type Outcome = Outcome;

    fn cases(&self) -> Result<Vec<u64>> {
        Ok(self.0.clone().collect())
    }

    fn run(&self, seed: &u64) -> Result<Option<Outcome>> {
        follow(robot(*seed), *seed).map(Some)
    }

    fn table(&self, outcomes: &[(u64, Outcome)]) -> Result<String> {
        let mut table = Table::of_numbers(
            "robot | lives | jumps visible | found | dated between two sessions | drums that changed visibly, found | false among quiet intervals | values covered | drifts found | of pulleys at rest | rates covered | a pulley out of tolerance at the date | the position out of tolerance at its date | median ms",
        );
        for (name, all) in by_name(&ROBOTS, outcomes, |seed| robot(*seed)) {
            let sum = |share: fn(&Outcome) -> Share| total(&all, share);
            let (found, drifts) = (sum(|one| one.found), sum(|one| one.false_drifts));
            table.row(format_args!(
                "{name} | {} | {} | {found} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.1}",
                all.len(),
                found.whole,
                sum(|one| one.dated),
                sum(|one| one.drums),
                sum(|one| one.false_jumps),
                sum(|one| one.values),
                drifts.whole,
                drifts.part,
                sum(|one| one.rates),
                sum(|one| one.late[0]),
                sum(|one| one.late[1]),
                1e3 * median(all.iter().map(|one| one.seconds)),
            ));
        }
        Ok(table.text())
    }
}

/// The robot of a seed: those of the first seeds are in turn.
pub(crate) fn robot(seed: u64) -> &'static str {
    ROBOTS[seed as usize % ROBOTS.len()]
}

pub(crate) fn drawing(name: &str) -> Result<Robot> {
    if let Some(preset) = presets::find(name) {
        return Ok(preset.robot);
    }
    let template = Template::named(name).context("a robot")?;
    let mut robot = template.robot(template.usual_size_m());
    robot.tolerances = None;
    Ok(robot)
}

fn draw(drawing: &Robot, seed: u64) -> Result<Truth> {
    let mut rng = stream(seed, 1);
    let first = simulate(drawing, &SimulationOptions::new(1, seed))?.truth;
    let is_free = |axis: usize| {
        let pulleys = drawing
            .cables
            .iter()
            .map(|c| c.pulley.entry_point_sd_m.each());
        pulleys.clone().all(|sd| sd[axis] != Some(0.0))
    };
    let direction = |rng: &mut ChaCha8Rng| {
        let along: [f64; 3] = UnitSphere.sample(rng);
        let along = Vector3::from_fn(|axis, _| if is_free(axis) { along[axis] } else { 0.0 });
        along.normalize()
    };
    let count = drawing.cable_count();
    let mut truth = Truth {
        robots: Vec::new(),
        days: Vec::new(),
        jumps: Vec::new(),
        rates: vec![Vector3::zeros(); count],
        drum: rng
            .random_bool(REWOUND)
            .then(|| Drum::draw(count, &mut rng)),
    };
    for rate in &mut truth.rates {
        if rng.random_bool(DRIFTING) {
            *rate = direction(&mut rng) * rng.random_range(0.0..DRIFT_M);
        }
    }
    let mut days = 0.0;
    for session in 0..SESSIONS {
        if session > 0 {
            days += rng.random_range(DAYS[0]..DAYS[1]);
            if rng.random_bool(JUMPS) {
                let size = exp_uniform(JUMP_M, &mut rng);
                let by = direction(&mut rng) * size;
                truth
                    .jumps
                    .push((rng.random_range(0..count), session - 1, by));
            }
        }
        truth.days.push(days);
        let mut robot = truth.robot_at(&first, session, days);
        let drum = truth.drum.as_ref();
        robot
            .effects
            .extend(drum.and_then(|drum| drum.effect(drawing, session)));
        truth.robots.push(robot);
    }
    Ok(truth)
}

impl Truth {
    /// By what the pulleys move in some days after the last session, with a seed and a stream of random numbers.
    fn moved_after(&self, days: f64, (seed, number): (u64, u64)) -> Vec<Vector3<f64>> {
        let mut rng = stream(10_000 * seed, number);
        let mean = 0.5 * (DAYS[0] + DAYS[1]);
        let mut moved: Vec<Vector3<f64>> = self.rates.iter().map(|rate| rate * days).collect();
        let mut day = mean;
        while day <= days {
            if rng.random_bool(JUMPS) {
                let size = exp_uniform(JUMP_M, &mut rng);
                let along = Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng));
                let cable = rng.random_range(0..moved.len());
                moved[cable] += along.normalize() * size;
            }
            day += mean;
        }
        moved
    }

    /// The robot after the jumps before a session, at some day.
    fn robot_at(&self, first: &Robot, session: usize, days: f64) -> Robot {
        let mut robot = first.clone();
        for (cable, of) in robot.cables.iter_mut().enumerate() {
            let jumps = self
                .jumps
                .iter()
                .filter(|(own, after, _)| *own == cable && *after < session);
            let moved = jumps.fold(self.rates[cable] * days, |sum, (.., by)| sum + by);
            for (to, by) in of.pulley.entry_point_m.iter_mut().zip(moved.iter()) {
                *to += by;
            }
        }
        robot
    }
}

fn follow(name: &str, seed: u64) -> Result<Outcome> {
    let drawing = drawing(name)?;
    let truth = draw(&drawing, 10_000 * seed)?;
    let mut datasets = Vec::with_capacity(SESSIONS);
    for (session, robot) in truth.robots.iter().enumerate() {
        let options = SimulationOptions {
            geometry: TrueGeometry::Nominal,
            workspace: Some(Workspace::of(&drawing)),
            tension: Some(TensionRange::of(&drawing)),
            ..SimulationOptions::new(POSES, 10_000 * seed + 1 + session as u64)
        };
        let mut dataset = simulate(robot, &options)?.dataset;
        dataset.robot = drawing.clone();
        datasets.push(dataset);
    }
    let mut sessions: Vec<(Problem<'_>, Solution)> = Vec::with_capacity(SESSIONS);
    for (session, dataset) in datasets.iter().enumerate() {
        let mut problem = Problem::new(dataset)?;
        let drum = truth.drum.as_ref();
        if let Some(effect) = drum.and_then(|drum| drum.effect(&drawing, session)) {
            problem = problem.with_effects(vec![BoundEffect::to_estimate(&effect, &drawing)?]);
        }
        let solution = solved(&problem)?;
        ensure!(solution.converged(), "no convergence");
        sessions.push((problem, solution));
    }
    let runs: Vec<DatedRun<'_>> = sessions
        .iter()
        .zip(&truth.days)
        .map(|((problem, solution), days)| DatedRun {
            run: Identified { problem, solution },
            days: *days,
            follows_event: false,
        })
        .collect();
    let (history, seconds) = timed(|| smooth(&runs));
    let history = history?;
    let mut outcome = Outcome {
        drums: drums(&truth, &history),
        seconds,
        ..Outcome::default()
    };
    count_jumps(&truth, &history, &mut outcome);
    count_drifts(&truth, &history, &mut outcome);
    count_states(&truth, &history, &mut outcome.values);
    let last = runs[SESSIONS - 1].run;
    let late = [
        late(&truth, &history, seed)?,
        late_position(&truth, (&history, last), seed)?,
    ];
    outcome.late = late.map(|late| Share::of(late, |late| late));
    Ok(outcome)
}

/// Whether the sessions can show a jump of a part: its noncentrality is at least [`VISIBLE`], given the other changes that were
/// found.
fn is_visible(history: &History, part: usize, after: usize, by: &DVector<f64>) -> bool {
    by.dot(&(&history.information[part][after] * by)) >= VISIBLE
}

/// The part that a pulley is, with the coordinates of a vector that are followed.
fn pulley_part(
    history: &History,
    cable: usize,
    by: &Vector3<f64>,
) -> Option<(usize, DVector<f64>)> {
    let is_it = |part: &RobotPart| *part == RobotPart::Pulley(cable);
    let part = history.parts.iter().position(is_it)?;
    let axes = &history.axes[part];
    let by = DVector::from_iterator(axes.len(), axes.iter().map(|axis| by[*axis]));
    Some((part, by))
}

/// The visible changes of a drum that are found in their interval.
fn drums(truth: &Truth, history: &History) -> Share {
    let Some((drum, part)) = truth.drum.as_ref().zip(drum_part(history)) else {
        return Share::default();
    };
    let visible = drum
        .changes()
        .filter(|(before, by)| is_visible(history, part, *before, &DVector::from_element(1, *by)));
    Share::of(visible, |(before, _)| {
        certain(history).any(|jump| jump.part == part && contains(jump, before))
    })
}

fn drum_part(history: &History) -> Option<usize> {
    let is_effect = |part: &RobotPart| matches!(part, RobotPart::Effect { .. });
    history.parts.iter().position(is_effect)
}

fn certain(history: &History) -> impl Iterator<Item = &Jump> + Clone {
    let jumps = history.jumps.iter();
    jumps.filter(|jump| jump.probability >= CERTAIN)
}

fn contains(jump: &Jump, session: usize) -> bool {
    (jump.between[0]..jump.between[1]).contains(&session)
}

fn pulley(history: &History, part: usize) -> Option<usize> {
    match history.parts[part] {
        RobotPart::Pulley(cable) => Some(cable),
        RobotPart::TargetPlane | RobotPart::Effect { .. } => None,
    }
}

fn count_jumps(truth: &Truth, history: &History, outcome: &mut Outcome) {
    for (cable, after, by) in &truth.jumps {
        let of_pulley = pulley_part(history, *cable, by);
        if !of_pulley.is_some_and(|(part, by)| is_visible(history, part, *after, &by)) {
            continue;
        }
        let mut own = certain(history).filter(|jump| pulley(history, jump.part) == Some(*cable));
        outcome
            .dated
            .count(own.clone().any(|jump| jump.between == [*after, *after + 1]));
        outcome.found.count(own.any(|jump| contains(jump, *after)));
    }
    let is_false = |jump: &&Jump| {
        if let (RobotPart::Effect { .. }, Some(drum)) = (&history.parts[jump.part], &truth.drum) {
            return !drum.changes().any(|(before, _)| contains(jump, before));
        }
        let own = pulley(history, jump.part);
        let mut jumps = truth.jumps.iter();
        !jumps.any(|(cable, after, _)| own == Some(*cable) && contains(jump, *after))
    };
    // A drum that no model of a session has is no part of the history.
    let drum = truth.drum.as_ref().filter(|_| drum_part(history).is_some());
    let rewound = drum.map_or(0, |drum| drum.changes().count());
    outcome.false_jumps = Share {
        part: certain(history).filter(is_false).count(),
        whole: history.parts.len() * (SESSIONS - 1) - truth.jumps.len() - rewound,
    };
}

fn count_drifts(truth: &Truth, history: &History, outcome: &mut Outcome) {
    let drifts = history.drifts.iter();
    for drift in drifts.filter(|drift| drift.probability >= CERTAIN) {
        let cable = pulley(history, drift.part);
        let rate = cable.map_or_else(Vector3::zeros, |cable| truth.rates[cable]);
        outcome.false_drifts.count(rate == Vector3::zeros());
        for (k, axis) in history.axes[drift.part].iter().enumerate() {
            let off = drift.rate[k] - rate[*axis];
            let sd = drift.covariance[(k, k)].sqrt();
            outcome.rates.count(off.abs() < NORMAL_95 * sd);
        }
    }
}

/// Values in all sessions, in the datum of the first one: the common motion of all pulleys that fits the first session best is
/// removed from the differences, as the datum is arbitrary by the uncertainty of the home pose.
fn count_states(truth: &Truth, history: &History, values: &mut Share) {
    for (part, of) in history.parts.iter().enumerate() {
        let RobotPart::Pulley(cable) = of else {
            continue;
        };
        for (session, state) in history.states[part].iter().enumerate() {
            for (k, axis) in history.axes[part].iter().enumerate() {
                let is = truth.robots[session].cables[*cable].pulley.entry_point_m[*axis];
                let off = state.value[k] - is;
                let sd = state.covariance[(k, k)].sqrt();
                values.count(off.abs() < NORMAL_95 * sd);
            }
        }
    }
}

/// Lives each robot on until the date of its next calibration, if it has one: whether a pulley is out of tolerance then.
fn late(truth: &Truth, history: &History, seed: u64) -> Result<Option<bool>> {
    let Some(days) = date(&forecast(history, Tolerance::Pulley(TOLERANCE_M))?) else {
        return Ok(None);
    };
    let moved = truth.moved_after(days, (seed, 2));
    let count = truth.rates.len();
    let last = SESSIONS - 1;
    let is_out = |cable: usize| {
        let part = history
            .parts
            .iter()
            .position(|part| *part == RobotPart::Pulley(cable));
        let Some(part) = part else {
            return false;
        };
        let state = &history.states[part][last];
        let pulley = &truth.robots[last].cables[cable].pulley;
        let off = history.axes[part].iter().enumerate().map(|(k, axis)| {
            (pulley.entry_point_m[*axis] + moved[cable][*axis] - state.value[k]).powi(2)
        });
        off.sum::<f64>().sqrt() > TOLERANCE_M
    };
    Ok(Some((0..count).any(is_out)))
}

/// The date of a forecast, unless the values are too uncertain for one.
fn date(forecast: &Forecast) -> Option<f64> {
    forecast
        .due_days
        .filter(|_| forecast.at_once < OUT_OF_TOLERANCE)
}

/// The same for the position error of the platform over the workspace, with the values of the last session in the controller.
fn late_position(
    truth: &Truth,
    (history, last): (&History, Identified<'_>),
    seed: u64,
) -> Result<Option<bool>> {
    let drawing = &last.problem.dataset.robot;
    let workspace = Workspace::of(drawing);
    let parameters = &last.solution.parameters;
    let weights = position_weights(drawing, &workspace, parameters).context("a home pose")?;
    let covariance = last.solution.covariance.as_ref().context("a covariance")?;
    let limit_m = POSITION_FACTOR * weights.dot(covariance).sqrt();
    let tolerance = Tolerance::Position {
        limit_m,
        volume: None,
        last,
    };
    let Some(days) = date(&forecast(history, tolerance)?) else {
        return Ok(None);
    };
    let mut robot = truth.robots[SESSIONS - 1].clone();
    for (index, (cable, moved)) in robot
        .cables
        .iter_mut()
        .zip(truth.moved_after(days, (seed, 3)))
        .enumerate()
    {
        let part = pulley_part(history, index, &moved);
        let axes = part.map_or(&[][..], |(part, _)| &history.axes[part]);
        for axis in axes {
            cable.pulley.entry_point_m[*axis] += moved[*axis];
        }
    }
    let mut rng = stream(10_000 * seed, 4);
    let places = (0..PLACES).map(|_| Pose {
        orientation: workspace.centre.orientation,
        ..workspace.draw(drawing, &mut rng)
    });
    let places: Vec<Pose> = places.collect();
    let globals = &last.solution.globals;
    let believed = (&globals.entry_points[..], &globals.home);
    let [error_m, _] = position_errors(believed, (drawing, &robot), &places)?;
    Ok(Some(error_m > limit_m))
}
