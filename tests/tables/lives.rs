//! Simulated lives of robots with known truth: what the history of their sessions finds, how often what it states is true, and
//! whether a calibration comes in time.

use std::fmt::Write as _;

use anyhow::{Context, Result, ensure};
use nalgebra::{DVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, UnitSphere};
use tautline_core::comparison::Identified;
use tautline_core::effect::{BoundEffect, EffectSetting};
use tautline_core::estimation::{Control, Options, Problem, Solution, solve};
use tautline_core::geometry::Pose;
use tautline_core::history::{
    CERTAIN, DatedRun, Forecast, History, OUT_OF_TOLERANCE, RobotPart, Tolerance, forecast, smooth,
};
use tautline_core::planning::position_weights;
use tautline_core::robot::{Robot, presets};
use tautline_core::simulation::{
    SimulationOptions, TensionRange, TrueGeometry, Workspace, simulate,
};
use tautline_workflow::templates::Template;

use crate::tables::hidden::{VISIBLE, clopper_pearson};
use crate::tables::table1::position_errors;

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
/// Two-sided 95 %.
const QUANTILE: f64 = 1.959_964;

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
            let size = rng
                .random_range(WINCH_SCALE[0].ln()..WINCH_SCALE[1].ln())
                .exp();
            if rng.random_bool(0.5) { size } else { -size }
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
        (scale != 0.0).then(|| EffectSetting {
            effect: "winch_scale".to_owned(),
            targets: vec![robot.cables[self.cable].name.clone()],
            parameters: [("scale".to_owned(), scale)].into(),
        })
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

/// Counts over lives.
#[derive(Debug, Clone, Default)]
pub struct Counts {
    lives: usize,
    visible: usize,
    found: usize,
    dated: usize,
    /// Intervals of a pulley without a jump, and those with a certain one.
    quiet: usize,
    false_jumps: usize,
    /// Changes of a drum that are visible, and those found.
    drums: usize,
    drums_found: usize,
    numbers: usize,
    covered: usize,
    /// Drifts found, those of pulleys that do not drift, and coordinates of rates with those covered.
    drifts: usize,
    false_drifts: usize,
    rates: usize,
    rates_covered: usize,
    /// Dates of the next calibration, and robots out of tolerance then; for a tolerance of pulleys, and of the position.
    dates: [usize; 2],
    late: [usize; 2],
    seconds: Vec<f64>,
}

/// Follows `lives` robots, from a first seed on.
///
/// # Errors
/// If a robot cannot be simulated or identified.
pub fn study(lives: usize, first_seed: u64) -> Result<Vec<(&'static str, Counts)>> {
    let mut found: Vec<(&'static str, Counts)> =
        ROBOTS.map(|name| (name, Counts::default())).into();
    for life in 0..lives {
        let (name, counts) = &mut found[life % ROBOTS.len()];
        follow(name, first_seed + life as u64, counts)
            .with_context(|| format!("{name}, life {life}"))?;
    }
    Ok(found)
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
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(1);
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
                let size = rng.random_range(JUMP_M[0].ln()..JUMP_M[1].ln()).exp();
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
    fn moved_after(&self, days: f64, (seed, stream): (u64, u64)) -> Vec<Vector3<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(10_000 * seed);
        rng.set_stream(stream);
        let mean = 0.5 * (DAYS[0] + DAYS[1]);
        let mut moved: Vec<Vector3<f64>> = self.rates.iter().map(|rate| rate * days).collect();
        let mut day = mean;
        while day <= days {
            if rng.random_bool(JUMPS) {
                let size = rng.random_range(JUMP_M[0].ln()..JUMP_M[1].ln()).exp();
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

fn follow(name: &str, seed: u64, counts: &mut Counts) -> Result<()> {
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
    let mut solved: Vec<(Problem<'_>, Solution)> = Vec::with_capacity(SESSIONS);
    for (session, dataset) in datasets.iter().enumerate() {
        let mut problem = Problem::new(dataset)?;
        let drum = truth.drum.as_ref();
        if let Some(effect) = drum.and_then(|drum| drum.effect(&drawing, session)) {
            problem = problem.with_effects(vec![BoundEffect::to_estimate(&effect, &drawing)?]);
        }
        let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue)?;
        ensure!(solution.converged(), "no convergence");
        solved.push((problem, solution));
    }
    let runs: Vec<DatedRun<'_>> = solved
        .iter()
        .zip(&truth.days)
        .map(|((problem, solution), days)| DatedRun {
            run: Identified { problem, solution },
            days: *days,
            follows_event: false,
        })
        .collect();
    let started = std::time::Instant::now();
    let history = smooth(&runs)?;
    counts.seconds.push(started.elapsed().as_secs_f64());
    counts.lives += 1;
    count_jumps(&truth, &history, counts);
    count_states(&truth, &history, counts);
    count_dates(&truth, &history, seed, counts)?;
    let last = runs[SESSIONS - 1].run;
    count_dates_of_position(&truth, (&history, last), seed, counts)
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

/// The changes of a drum: those that are visible, and found in their interval.
fn count_drums(truth: &Truth, history: &History, counts: &mut Counts) -> usize {
    let is_effect = |part: &RobotPart| matches!(part, RobotPart::Effect { .. });
    let part = history.parts.iter().position(is_effect);
    let Some((drum, part)) = truth.drum.as_ref().zip(part) else {
        return 0;
    };
    for (before, by) in drum.changes() {
        if is_visible(history, part, before, &DVector::from_element(1, by)) {
            counts.drums += 1;
            let found = history.jumps.iter().any(|jump| {
                let contains = jump.between[0] <= before && before < jump.between[1];
                jump.part == part && contains && jump.probability >= CERTAIN
            });
            counts.drums_found += usize::from(found);
        }
    }
    drum.changes().count()
}

fn count_jumps(truth: &Truth, history: &History, counts: &mut Counts) {
    let certain = || {
        history
            .jumps
            .iter()
            .filter(|jump| jump.probability >= CERTAIN)
    };
    let pulley = |part: usize| match history.parts[part] {
        RobotPart::Pulley(cable) => Some(cable),
        RobotPart::TargetPlane | RobotPart::Effect { .. } => None,
    };
    for (cable, after, by) in &truth.jumps {
        let of_pulley = pulley_part(history, *cable, by);
        if !of_pulley.is_some_and(|(part, by)| is_visible(history, part, *after, &by)) {
            continue;
        }
        counts.visible += 1;
        let own = certain().filter(|jump| pulley(jump.part) == Some(*cable));
        let contains = |between: &[usize; 2]| between[0] <= *after && *after < between[1];
        counts.found += usize::from(own.clone().any(|jump| contains(&jump.between)));
        counts.dated += usize::from(own.clone().any(|jump| jump.between == [*after, *after + 1]));
    }
    let rewound = count_drums(truth, history, counts);
    counts.quiet += history.parts.len() * (SESSIONS - 1) - truth.jumps.len() - rewound;
    let is_false = |jump: &&tautline_core::history::Jump| {
        if let (RobotPart::Effect { .. }, Some(drum)) = (&history.parts[jump.part], &truth.drum) {
            let mut changes = drum.changes();
            return changes
                .all(|(before, _)| before < jump.between[0] || before >= jump.between[1]);
        }
        let own = truth
            .jumps
            .iter()
            .filter(|(cable, ..)| pulley(jump.part) == Some(*cable));
        own.clone()
            .all(|(_, after, _)| *after < jump.between[0] || *after >= jump.between[1])
    };
    counts.false_jumps += certain().filter(is_false).count();
    for drift in history
        .drifts
        .iter()
        .filter(|drift| drift.probability >= CERTAIN)
    {
        let rate = pulley(drift.part).map_or_else(Vector3::zeros, |cable| truth.rates[cable]);
        counts.drifts += 1;
        counts.false_drifts += usize::from(rate == Vector3::zeros());
        for (k, axis) in history.axes[drift.part].iter().enumerate() {
            let off = drift.rate[k] - rate[*axis];
            counts.rates += 1;
            counts.rates_covered +=
                usize::from(off.abs() < QUANTILE * drift.covariance[(k, k)].sqrt());
        }
    }
}

/// Values in all sessions, in the datum of the first one: the common motion of all pulleys that fits the first session best is
/// removed from the differences, as the datum is arbitrary by the uncertainty of the home pose.
fn count_states(truth: &Truth, history: &History, counts: &mut Counts) {
    for (part, of) in history.parts.iter().enumerate() {
        let RobotPart::Pulley(cable) = of else {
            continue;
        };
        for (session, state) in history.states[part].iter().enumerate() {
            for (k, axis) in history.axes[part].iter().enumerate() {
                let is = truth.robots[session].cables[*cable].pulley.entry_point_m[*axis];
                let off = state.value[k] - is;
                counts.numbers += 1;
                counts.covered +=
                    usize::from(off.abs() < QUANTILE * state.covariance[(k, k)].sqrt());
            }
        }
    }
}

/// Lives each robot on until the date of its next calibration, and sees whether a pulley is out of tolerance then.
fn count_dates(truth: &Truth, history: &History, seed: u64, counts: &mut Counts) -> Result<()> {
    let Some(days) = date(&forecast(history, Tolerance::Pulley(TOLERANCE_M))?) else {
        return Ok(());
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
    counts.dates[0] += 1;
    counts.late[0] += usize::from((0..count).any(is_out));
    Ok(())
}

/// The date of a forecast, unless the values are too uncertain for one.
fn date(forecast: &Forecast) -> Option<f64> {
    forecast
        .due_days
        .filter(|_| forecast.at_once < OUT_OF_TOLERANCE)
}

/// The same for the position error of the platform over the workspace, with the values of the last session in the controller.
fn count_dates_of_position(
    truth: &Truth,
    (history, last): (&History, Identified<'_>),
    seed: u64,
    counts: &mut Counts,
) -> Result<()> {
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
        return Ok(());
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
    let mut rng = ChaCha8Rng::seed_from_u64(10_000 * seed);
    rng.set_stream(4);
    let places = (0..PLACES).map(|_| Pose {
        orientation: workspace.centre.orientation,
        ..workspace.draw(drawing, &mut rng)
    });
    let places: Vec<Pose> = places.collect();
    let globals = &last.solution.globals;
    let believed = (&globals.entry_points[..], &globals.home);
    let [error_m, _] = position_errors(believed, (drawing, &robot), &places)?;
    counts.dates[1] += 1;
    counts.late[1] += usize::from(error_m > limit_m);
    Ok(())
}

/// The table in Markdown.
#[must_use]
pub fn markdown(found: &[(&'static str, Counts)]) -> String {
    let mut text = String::from(
        "| robot | lives | jumps visible | found | dated between two sessions | drums that changed visibly, found | false among quiet intervals | values covered | drifts found | of pulleys at rest | rates covered | a pulley out of tolerance at the date | the position out of tolerance at its date | median ms |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let mut all = Counts::default();
    for (_, counts) in found {
        all.add(counts);
    }
    for (name, counts) in found.iter().map(|(n, c)| (*n, c)).chain([("all", &all)]) {
        let mut seconds = counts.seconds.clone();
        seconds.sort_by(f64::total_cmp);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.1} |",
            counts.lives,
            counts.visible,
            share(counts.found, counts.visible),
            share(counts.dated, counts.visible),
            share(counts.drums_found, counts.drums),
            share(counts.false_jumps, counts.quiet),
            share(counts.covered, counts.numbers),
            counts.drifts,
            counts.false_drifts,
            share(counts.rates_covered, counts.rates),
            share(counts.late[0], counts.dates[0]),
            share(counts.late[1], counts.dates[1]),
            1e3 * seconds.get(seconds.len() / 2).copied().unwrap_or(f64::NAN),
        );
    }
    text
}

/// A share in percent with its 95 % interval.
pub(crate) fn share(part: usize, whole: usize) -> String {
    if whole == 0 {
        return "-".to_owned();
    }
    let [low, high] = clopper_pearson(part, whole).map(|p| 100.0 * p);
    let own = 100.0 * part as f64 / whole as f64;
    format!("{part} of {whole}: {own:.1} % ({low:.1} to {high:.1})")
}

impl Counts {
    fn add(&mut self, other: &Self) {
        self.lives += other.lives;
        self.visible += other.visible;
        self.found += other.found;
        self.dated += other.dated;
        self.quiet += other.quiet;
        self.false_jumps += other.false_jumps;
        self.drums += other.drums;
        self.drums_found += other.drums_found;
        self.numbers += other.numbers;
        self.covered += other.covered;
        self.drifts += other.drifts;
        self.false_drifts += other.false_drifts;
        self.rates += other.rates;
        self.rates_covered += other.rates_covered;
        for tolerance in 0..2 {
            self.dates[tolerance] += other.dates[tolerance];
            self.late[tolerance] += other.late[tolerance];
        }
        self.seconds.extend(&other.seconds);
    }
}
