//! Recordings in motion: sampled readings, their time derivatives, and thinning to independent samples.
//!
//! The noise of neighbouring samples is correlated, so treating all of them as independent would overstate the information. A
//! recording is thinned to samples between which the noise has decorrelated; the information of the others is kept in the
//! rates of those that remain: time derivatives of the readings, from polynomials through the surrounding samples.

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

use super::local_polynomial::{FEWEST, Weights, derivatives};
use super::noise_correlation::Moments;
use super::smoothness::{SampledChannel, follows_a_motion};
use super::{Grid, Measurements};
use crate::geometry::{Pose, Twist, Vec3};
use crate::robot::{Robot, Winch};

/// Smallest number of samples of a recording.
const LEAST: usize = 100;
/// A step longer than this many usual ones counts as a gap.
const GAP: f64 = 3.0;
/// A reading that changes by less than this many standard deviations counts as being at rest.
const STILL: f64 = 20.0;
/// Half the window over which readings are smoothed (s).
const HALF_WINDOW_S: f64 = 0.25;
/// Half the window for forces, whose noise is larger: the noise of a rate biases a delay estimated from it towards zero, and
/// falls with the power 1.5 of this time.
const FORCE_HALF_WINDOW_S: f64 = 1.0;
/// Correlation of the noise of neighbouring samples below which they count as independent.
const INDEPENDENT: f64 = 0.02;
/// Largest number of windows in which the noise is evaluated.
const MOST_WINDOWS: usize = 2000;

/// Samples of one channel by row.
type Channel<'a> = dyn Fn(usize) -> f64 + 'a;

/// Kind of reading: the readings of one device, with noise of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadingKind {
    /// Revolutions or lengths.
    Length,
    /// Forces.
    Force,
    /// Laser distance.
    Laser,
    /// Position of the external instrument.
    Tracker,
}

impl ReadingKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Length, Self::Force, Self::Laser, Self::Tracker];

    /// Name for reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Length => "lengths",
            Self::Force => "forces",
            Self::Laser => "the laser",
            Self::Tracker => "the external pose",
        }
    }
}

/// First and second time derivative of the readings; NaN where there are too few samples around, 0 at home.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rates {
    /// Derivatives of the revolutions (1/s, 1/s^2), or of the lengths (m/s, m/s^2).
    pub length: [Grid; 2],
    /// Derivatives of the force readings (N/s, N/s^2).
    pub force: [Grid; 2],
    /// Derivatives of the laser distance (m/s, m/s^2).
    pub laser: Vec<[f64; 2]>,
    /// Velocity and acceleration of the platform from the external instrument (m, rad, s).
    pub tracked: Vec<[Twist; 2]>,
    /// Selection of the samples.
    pub sampling: Sampling,
}

/// Thinning of a recording to independent samples.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sampling {
    /// Number of samples of the recording.
    pub recorded: usize,
    /// Sampling interval of the recording (s).
    pub step_s: f64,
    /// Interval of the samples that were kept (s).
    pub interval_s: f64,
    /// Time in which the correlation of the noise falls to 1/e, for each kind of reading present (s).
    pub correlation_s: Vec<(ReadingKind, f64)>,
}

/// Consecutive samples of a recording without a gap.
struct Run {
    rows: Range<usize>,
    /// Typical sampling interval (s).
    step_s: f64,
}

/// Maximum numbers of rows.
#[derive(Debug, Clone, Copy)]
pub struct MostRows {
    /// Samples of a recording in motion.
    pub samples: usize,
    /// Poses at rest besides the home pose.
    pub poses: usize,
}

impl Measurements {
    /// The measurements that a diagnosis uses: independent samples of a recording in motion; else the poses at rest, identical
    /// rows once, averaged over each standstill, evenly thinned where they are too many. Also returns the largest number of rows
    /// merged into one.
    #[must_use]
    pub fn independent(&self, robot: &Robot, most: MostRows) -> (Cow<'_, Self>, usize) {
        let distinct = self.distinct_rows();
        if distinct.len() < self.len() {
            let distinct = self.select(&distinct);
            let (rows, merged) = distinct.independent(robot, most);
            return (Cow::Owned(rows.into_owned()), merged);
        }
        if let Some(samples) = self.independent_samples(robot, most.samples) {
            return (Cow::Owned(samples), 1);
        }
        let (poses, merged) = self.standstills_averaged(robot);
        let home = robot.home.and(poses.home_row());
        match poses.thinned(home, most.poses) {
            Some(thinned) => (Cow::Owned(thinned), merged),
            None => (poses, merged),
        }
    }

    /// Rows without those that repeat the time and all readings of an earlier row: a table that was appended twice tells no more
    /// than once.
    fn distinct_rows(&self) -> Vec<usize> {
        let grids = [
            &self.revolutions,
            &self.length_m,
            &self.force_n,
            &self.swivel_rad,
        ];
        let columns = [&self.time_s, &self.laser_m];
        let triples = [&self.inclination_rad, &self.tracked_position_m];
        let mut known = HashSet::new();
        let is_new = |row: &usize| {
            let cells = grids.iter().filter(|grid| !grid.is_empty());
            let cells = cells.flat_map(|grid| grid.row(*row).iter().copied());
            let cells = cells.chain(
                columns
                    .iter()
                    .filter_map(|column| column.get(*row).copied()),
            );
            let triples = triples
                .iter()
                .filter_map(|column| column.get(*row))
                .flatten();
            let turned = self
                .tracked_orientation_wxyz
                .get(*row)
                .into_iter()
                .flatten();
            let cells = cells.chain(triples.chain(turned).copied());
            known.insert(cells.map(f64::to_bits).collect::<Vec<u64>>())
        };
        (0..self.len()).filter(is_new).collect()
    }

    /// Independent samples of a recording in motion with their rates, at most `most`; the home row stays.
    /// `None` if this is not a recording, or has rates already.
    #[must_use]
    pub fn independent_samples(&self, robot: &Robot, most: usize) -> Option<Self> {
        let runs = self.runs(robot)?;
        let step_s = runs[0].step_s;
        let half = |half_s: f64| ((half_s / step_s) as usize).max(FEWEST / 2 + 1);
        let has_forces = !self.force_n.is_empty();
        let margin = half(if has_forces {
            FORCE_HALF_WINDOW_S
        } else {
            HALF_WINDOW_S
        });
        let usable = |run: &Run| {
            let rows = run.rows.start + margin..run.rows.end.saturating_sub(margin);
            (!rows.is_empty()).then_some(rows)
        };
        let inner: Vec<Range<usize>> = runs.iter().filter_map(usable).collect();
        let number: usize = inner.iter().map(Range::len).sum();
        if number == 0 {
            return None;
        }
        let correlations = self.noise_correlations(&inner, half(HALF_WINDOW_S), step_s);
        let largest = correlations
            .iter()
            .fold(0.0_f64, |most, (_, rho)| most.max(*rho));
        // A correlation longer than the window is motion, or comes from readings without noise.
        let largest = largest.min((-step_s / HALF_WINDOW_S).exp());
        let apart = if largest > INDEPENDENT {
            (INDEPENDENT.ln() / largest.ln()).ceil() as usize
        } else {
            1
        };
        let step = apart.max(number.div_ceil(most.max(1))).max(1);
        let home = robot.home.and(self.home_row());
        let samples = inner.iter().flat_map(|rows| rows.clone().step_by(step));
        let rows: Vec<usize> = home
            .into_iter()
            .chain(samples.filter(|row| Some(*row) != home))
            .collect();
        let mut thinned = self.select(&rows);
        let sampling = Sampling {
            recorded: self.len(),
            step_s,
            interval_s: step as f64 * step_s,
            correlation_s: correlations
                .into_iter()
                .map(|(kind, rho)| (kind, if rho > 0.0 { -step_s / rho.ln() } else { 0.0 }))
                .collect(),
        };
        let halves = [half(HALF_WINDOW_S), half(FORCE_HALF_WINDOW_S)];
        thinned.rates = Some(self.rates(&rows, home, halves, sampling));
        Some(thinned)
    }

    /// Runs of samples without gaps that follow a motion; `None` if there is none, so that this is not a recording.
    fn runs(&self, robot: &Robot) -> Option<Vec<Run>> {
        if self.rates.is_some() || self.time_s.len() < LEAST {
            return None;
        }
        let steps = self.time_s.windows(2).map(|pair| pair[1] - pair[0]);
        let mut sorted: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
        sorted.sort_by(f64::total_cmp);
        let step_s = *sorted.get(sorted.len() / 2)?;
        let mut runs: Vec<Run> = Vec::new();
        for row in 0..self.len() {
            let follows = row > 0 && {
                let step = self.time_s[row] - self.time_s[row - 1];
                step > 0.0 && step < GAP * step_s
            };
            match runs.last_mut() {
                Some(run) if follows => run.rows.end = row + 1,
                _ => runs.push(Run {
                    rows: row..row + 1,
                    step_s,
                }),
            }
        }
        runs.retain(|run| run.rows.len() >= LEAST && self.moves(robot, &run.rows));
        runs.retain(|run| self.follows_a_motion(robot, &run.rows));
        (!runs.is_empty()).then_some(runs)
    }

    /// Whether the length readings within a range of rows are samples of a motion.
    fn follows_a_motion(&self, robot: &Robot, rows: &Range<usize>) -> bool {
        let (grid, counts) = self.length_readings();
        let values: Vec<_> = (0..grid.columns())
            .map(|cable| move |row: usize| grid.get(rows.start + row, cable))
            .collect();
        let channels: Vec<SampledChannel<'_>> = (robot.cables.iter().zip(&values))
            .map(|(cable, value)| SampledChannel {
                value,
                sd: length_reading_sd(&cable.winch, counts),
            })
            .collect();
        follows_a_motion(&self.time_s[rows.clone()], &channels)
    }

    /// Whether a cable moves within a range of rows.
    fn moves(&self, robot: &Robot, rows: &Range<usize>) -> bool {
        let (grid, counts) = self.length_readings();
        robot.cables.iter().enumerate().any(|(index, cable)| {
            let values = || rows.clone().map(|row| grid.get(row, index));
            let range =
                values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
            range > STILL * length_reading_sd(&cable.winch, counts)
        })
    }

    /// Readings of the winches, and whether they are revolutions.
    fn length_readings(&self) -> (&Grid, bool) {
        match self.revolutions.is_empty() {
            true => (&self.length_m, false),
            false => (&self.revolutions, true),
        }
    }

    /// Correlation of the noise of neighbouring samples, for each kind of reading present.
    fn noise_correlations(
        &self,
        inner: &[Range<usize>],
        half: usize,
        step_s: f64,
    ) -> Vec<(ReadingKind, f64)> {
        let number: usize = inner.iter().map(Range::len).sum();
        let stride = number.div_ceil(MOST_WINDOWS).max(1);
        let width = half as i32;
        let even: Vec<f64> = (-width..=width).map(|k| f64::from(k) * step_s).collect();
        let Some(filter) = Weights::new(&even).map(|weights| weights.residual()) else {
            return Vec::new();
        };
        let mut moments = [Moments::default(); 4];
        for rows in inner {
            for row in (rows.start..rows.end - 1).step_by(stride) {
                let windows = [row, row + 1].map(|middle| {
                    let around = middle - half..middle + half + 1;
                    let at = |k: usize| self.time_s[k] - self.time_s[middle];
                    let weights = Weights::new(&around.clone().map(at).collect::<Vec<_>>());
                    (around.start, weights.map(|weights| weights.residual()))
                });
                let [(first, Some(one)), (second, Some(other))] = &windows else {
                    continue;
                };
                let sum = |filter: &[f64], start: usize, channel: &Channel<'_>| -> f64 {
                    let terms = filter.iter().enumerate();
                    terms.map(|(k, c)| c * channel(start + k)).sum()
                };
                self.each_channel(&mut |kind, channel| {
                    moments[kind as usize]
                        .add(sum(one, *first, channel), sum(other, *second, channel));
                });
            }
        }
        let kinds = ReadingKind::ALL.into_iter();
        kinds
            .filter_map(|kind| Some((kind, moments[kind as usize].correlation(&filter)?)))
            .collect()
    }

    /// Calls `visit` with every channel whose noise is evaluated.
    fn each_channel(&self, visit: &mut dyn FnMut(ReadingKind, &Channel<'_>)) {
        let (lengths, _) = self.length_readings();
        for (kind, grid) in [
            (ReadingKind::Length, lengths),
            (ReadingKind::Force, &self.force_n),
        ] {
            for cable in 0..if grid.is_empty() { 0 } else { grid.columns() } {
                visit(kind, &|row| grid.get(row, cable));
            }
        }
        if !self.laser_m.is_empty() {
            visit(ReadingKind::Laser, &|row| self.laser_m[row]);
        }
        for axis in 0..if self.tracked_position_m.is_empty() {
            0
        } else {
            3
        } {
            visit(ReadingKind::Tracker, &|row| {
                self.tracked_position_m[row][axis]
            });
        }
    }

    /// Rates of the readings at some rows, with the given half-widths of the window in samples: general, then forces.
    fn rates(
        &self,
        rows: &[usize],
        home: Option<usize>,
        [half, force_half]: [usize; 2],
        sampling: Sampling,
    ) -> Rates {
        let cables = |grid: &Grid| if grid.is_empty() { 0 } else { grid.columns() };
        let (lengths, _) = self.length_readings();
        let grids = |grid: &Grid| [0, 1].map(|_| Grid::new(cables(grid)));
        let mut rates = Rates {
            length: grids(lengths),
            force: grids(&self.force_n),
            sampling,
            ..Rates::default()
        };
        for row in rows {
            let at = if Some(*row) == home { None } else { Some(*row) };
            let near = at.and_then(|row| Window::new(self, row, half));
            let far = at.and_then(|row| Window::new(self, row, force_half));
            let still = if at.is_none() { 0.0 } else { f64::NAN };
            let of = |window: &Option<Window>, channel: &Channel<'_>| match window {
                Some(window) => window.rates(channel),
                None => [still; 2],
            };
            for (grid, window, into) in [
                (lengths, &near, &mut rates.length),
                (&self.force_n, &far, &mut rates.force),
            ] {
                let channels = (0..cables(grid)).map(|cable| of(window, &|k| grid.get(k, cable)));
                let channels: Vec<[f64; 2]> = channels.collect();
                for (order, into) in into.iter_mut().enumerate() {
                    let values: Vec<f64> = channels.iter().map(|rates| rates[order]).collect();
                    if !values.is_empty() {
                        into.push_row(&values);
                    }
                }
            }
            if !self.laser_m.is_empty() {
                rates.laser.push(of(&near, &|k| self.laser_m[k]));
            }
            if !self.tracked_position_m.is_empty() {
                rates.tracked.push(self.tracked_rates(&near, *row, &of));
            }
        }
        rates
    }

    /// Velocity and acceleration from the external instrument around a row. Rotations are relative to that of the row, where
    /// the derivatives of the rotation vector are angular velocity and acceleration.
    fn tracked_rates(
        &self,
        window: &Option<Window>,
        row: usize,
        of: &dyn Fn(&Option<Window>, &Channel<'_>) -> [f64; 2],
    ) -> [Twist; 2] {
        let mut rates = [Twist::zeros(); 2];
        let mut set = |k: usize, [first, second]: [f64; 2]| {
            rates[0][k] = first;
            rates[1][k] = second;
        };
        for axis in 0..3 {
            set(axis, of(window, &|k| self.tracked_position_m[k][axis]));
        }
        if self.tracked_orientation_wxyz.is_empty() {
            return rates;
        }
        let pose = |k: usize| Pose::from_parts([0.0; 3], self.tracked_orientation_wxyz[k]);
        let from = pose(row);
        let turns: Vec<Vec3> = match window {
            Some(window) => {
                let turn = |k: usize| pose(k).difference(&from).fixed_rows::<3>(3).into_owned();
                window.rows.clone().map(turn).collect()
            }
            None => Vec::new(),
        };
        for axis in 0..3 {
            let start = window.as_ref().map_or(0, |window| window.rows.start);
            set(3 + axis, of(window, &|k| turns[k - start][axis]));
        }
        rates
    }
}

/// Standard deviation of a length reading: of revolutions if the winch counts them.
fn length_reading_sd(winch: &Winch, counts: bool) -> f64 {
    if counts {
        winch.revolutions_sd()
    } else {
        winch.length_sd_m
    }
}

/// The samples around a row.
struct Window {
    rows: Range<usize>,
    times_s: Vec<f64>,
    weights: Weights,
}

impl Window {
    fn new(data: &Measurements, row: usize, half: usize) -> Option<Self> {
        let rows = row.checked_sub(half)?..row + half + 1;
        let times_s = data.time_s.get(rows.clone())?.iter();
        let times_s: Vec<f64> = times_s.map(|time| time - data.time_s[row]).collect();
        Some(Self {
            weights: Weights::new(&times_s)?,
            rows,
            times_s,
        })
    }

    fn rates(&self, channel: &Channel<'_>) -> [f64; 2] {
        let start = self.rows.start;
        let [_, first, second] = derivatives(&self.times_s, &self.weights, |k| channel(start + k));
        [first, second]
    }
}
