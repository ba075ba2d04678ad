//! Poses from the readings of the winches, where neither commanded nor measured poses are known.
//!
//! With more cables than coordinates the lengths contradict each other if a channel has the wrong sign or unit. Each
//! assumption "this channel has this mistake" turns the readings `y` into lengths, and forward kinematics leaves their
//! residuals. With `r` rows of `m` cables, `n` coordinates and an unknown noise, the log evidence is that of the `r (m - n)`
//! contradictions, `-r (m - n) (ln(sum of squares) / 2 + mean_i ln|dy_i/dl_i|)`: the last term makes it a density of readings
//! in their own unit, so that no unit gains from making the residuals small together with everything else.

use tautline_core::geometry::Pose;
use tautline_core::kinematics::{ForwardKinematics, inverse_kinematics};
use tautline_core::robot::Robot;

use super::{FITS, Readings, factors};
use crate::recipe::QuantityKind as Kind;

/// Number of rows by which assumptions are compared: with two redundant cables, 12 rows have 24 contradictions.
const COMPARED: usize = 12;
/// Largest number of rows whose poses are computed.
const ROWS: usize = 1000;
/// Log odds against a mistake before the readings are seen, 1 in 100 for each robot, shared by all assumptions.
const PRIOR_LOG_ODDS: f64 = -4.6;
/// Residual (m) relative to the frame above which forward kinematics tries other starts. Drawings are off by less.
const RESIDUAL: f64 = 0.02;
/// Starts of forward kinematics; under a wrong assumption no start fits.
const STARTS: usize = 2;

/// Assumption about the channels: the channel of each cable, and the factor by which its readings are too large.
#[derive(Clone)]
struct Assumption {
    channels: Vec<usize>,
    factors: Vec<f64>,
}

impl Assumption {
    /// No channel is wrong.
    fn none(cables: usize) -> Self {
        Self {
            channels: (0..cables).collect(),
            factors: vec![1.0; cables],
        }
    }

    fn scaled(&self, cables: impl Iterator<Item = usize>, factor: f64) -> Self {
        let mut changed = self.clone();
        cables.for_each(|cable| changed.factors[cable] *= factor);
        changed
    }

    /// All assumptions with one more mistake: a sign or unit of one channel or of all, or two exchanged channels.
    fn with_one_more(&self, kind: Kind) -> Vec<Self> {
        let cables = self.channels.len();
        let units = factors(kind).iter().flat_map(|(f, _)| [*f, 1.0 / f]);
        let mut found = Vec::new();
        for factor in units.chain([-1.0]) {
            found.push(self.scaled(0..cables, factor));
            found.extend((0..cables).map(|cable| self.scaled([cable].into_iter(), factor)));
        }
        for i in 0..cables {
            for j in 0..i {
                let mut exchanged = self.clone();
                exchanged.channels.swap(i, j);
                found.push(exchanged);
            }
        }
        found
    }
}

/// Readings of the winches as changes of length.
struct Lengths<'a> {
    solver: ForwardKinematics,
    kind: Kind,
    columns: Vec<&'a [f64]>,
    /// Readings and lengths (m) from which changes count.
    origin: Vec<[f64; 2]>,
    unit_m: Vec<f64>,
    coordinates: usize,
}

/// Poses that explain the lengths, with the mistakes that explain them best; `None` where no assumption explains them, or
/// there are no more cables than coordinates.
pub(super) fn poses(readings: &Readings, robot: &Robot) -> Option<Vec<Option<Pose>>> {
    let lengths = Lengths::of(readings, robot)?;
    let compared: Vec<usize> = some_rows(readings, COMPARED).collect();
    let cables = robot.cable_count();
    let mut best = Assumption::none(cables);
    let mut evidence = lengths.log_evidence(&best, &compared)?;
    for _ in 0..cables {
        let more = best.with_one_more(lengths.kind);
        let prior = PRIOR_LOG_ODDS - (more.len() as f64).ln();
        let tried = more.into_iter().filter_map(|assumption| {
            let evidence = lengths.log_evidence(&assumption, &compared)? + prior;
            Some((evidence, assumption))
        });
        match tried.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((found, assumption)) if found > evidence => (evidence, best) = (found, assumption),
            _ => break,
        }
    }
    if !lengths.fit(&best, &compared) {
        return None;
    }
    Some(lengths.all(&best, readings))
}

/// Poses computed from the lengths as read. Only redundant cables would show a wrong channel.
pub(super) fn poses_as_read(readings: &Readings, robot: &Robot) -> Option<Vec<Option<Pose>>> {
    let lengths = Lengths::of(readings, robot)?;
    Some(lengths.all(&Assumption::none(robot.cable_count()), readings))
}

fn some_rows(readings: &Readings, count: usize) -> impl Iterator<Item = usize> {
    let rows = readings.labels.len();
    (0..rows).step_by(rows.div_ceil(count).max(1))
}

impl<'a> Lengths<'a> {
    fn of(readings: &'a Readings, robot: &Robot) -> Option<Self> {
        let kind = [Kind::Revolutions, Kind::Change, Kind::Length]
            .into_iter()
            .find(|kind| readings.of(*kind).len() == robot.cable_count())?;
        let columns: Vec<&[f64]> = readings.of(kind).into_iter().map(|(_, v)| v).collect();
        let coordinates = robot.platform.freedom().count();
        let home = robot
            .home
            .and_then(|home| inverse_kinematics(robot, &home.pose()).ok());
        let home_row = readings.labels.iter().position(|label| *label == 0);
        let origin = (0..columns.len()).map(|cable| match (&home, home_row, kind) {
            (Some(home), Some(row), _) => Some([columns[cable][row], home[cable].length_m]),
            (Some(home), None, Kind::Revolutions | Kind::Change) => {
                Some([0.0, home[cable].length_m])
            }
            (_, _, Kind::Length) => Some([0.0; 2]),
            _ => None,
        });
        let unit_m = |cable: &tautline_core::robot::Cable| match kind {
            Kind::Revolutions => cable.winch.cable_per_revolution_m(),
            _ => 1.0,
        };
        let limit_m = RESIDUAL * robot.frame_size_m()?;
        let solver = ForwardKinematics::new(robot).ok()?;
        Some(Self {
            solver: solver.with_residual_limit(limit_m).with_starts(STARTS),
            kind,
            origin: origin.collect::<Option<_>>()?,
            unit_m: robot.cables.iter().map(unit_m).collect(),
            columns,
            coordinates,
        })
    }

    /// Lengths (m) of a row; NaN where there is no reading.
    fn row(&self, assumed: &Assumption, row: usize) -> Vec<f64> {
        let length = |cable: usize| {
            let channel = assumed.channels[cable];
            let change = self.columns[channel][row] - self.origin[channel][0];
            self.origin[cable][1] + change * self.unit_m[cable] / assumed.factors[cable]
        };
        (0..self.columns.len()).map(length).collect()
    }

    /// Poses of at most [`ROWS`] rows.
    fn all(&self, assumed: &Assumption, readings: &Readings) -> Vec<Option<Pose>> {
        let mut poses = vec![None; readings.labels.len()];
        for row in some_rows(readings, ROWS) {
            poses[row] = self.solve(assumed, row).map(|(pose, _)| pose);
        }
        poses
    }

    /// Pose, sum of the squared residuals and number of redundant readings of a row.
    fn solve(&self, assumed: &Assumption, row: usize) -> Option<(Pose, [f64; 2])> {
        let lengths = self.row(assumed, row);
        let known = lengths.iter().filter(|length| length.is_finite()).count();
        let redundant = known.checked_sub(self.coordinates)?;
        let found = self.solver.solve(&lengths, self.solver.centre());
        let squares = found.residual_rms_m.powi(2) * known as f64;
        squares
            .is_finite()
            .then_some((found.pose, [squares, redundant as f64]))
    }

    /// Sum of the squared residuals (m²) and number of redundant readings.
    fn squares(&self, assumed: &Assumption, rows: &[usize]) -> Option<[f64; 2]> {
        let solved = rows.iter().filter_map(|row| self.solve(assumed, *row));
        let [squares, redundant] =
            solved.fold([0.0; 2], |sum, (_, one)| [sum[0] + one[0], sum[1] + one[1]]);
        (redundant > 0.0 && squares > 0.0).then_some([squares, redundant])
    }

    fn log_evidence(&self, assumed: &Assumption, rows: &[usize]) -> Option<f64> {
        let [squares, redundant] = self.squares(assumed, rows)?;
        let logarithms = assumed.factors.iter().map(|factor| factor.abs().ln());
        let own_unit = logarithms.sum::<f64>() / assumed.factors.len() as f64;
        Some(-redundant * (0.5 * squares.ln() + own_unit))
    }

    /// Whether the residuals are small compared with the changes of length.
    fn fit(&self, assumed: &Assumption, rows: &[usize]) -> bool {
        let Some([squares, redundant]) = self.squares(assumed, rows) else {
            return false;
        };
        let changes = rows.iter().flat_map(|row| {
            let lengths = self.row(assumed, *row).into_iter().zip(&self.origin);
            lengths.map(|(length, origin)| length - origin[1])
        });
        let there: Vec<f64> = changes.filter(|change| change.is_finite()).collect();
        let mean = there.iter().sum::<f64>() / there.len() as f64;
        let spread: f64 = there.iter().map(|change| (change - mean).powi(2)).sum();
        squares / redundant < FITS.powi(2) * spread / there.len() as f64
    }
}
