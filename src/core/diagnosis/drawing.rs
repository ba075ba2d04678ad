//! The drawing as a hypothesis: pulleys that deviate from their described places by more than the stated uncertainty.
//!
//! Every fit estimates the places, so that a wrong drawing needs no extension of the model, but it is a finding. If a drawing is wrong, its
//! places are known [`MOST_WIDER`] times less well than stated, or one pattern is [`PLACES_WIDER`] times less well known: the distance of
//! the pulleys along an axis, a turn of all about an axis, or one pulley alone. The evidence decides, at a fit with the places as stated, or with
//! wider ones if the readings contradict the stated ones so much that no cause explains them.

use nalgebra::{DMatrix, DVector, Vector3};

use super::calibration::log_naming_odds;
use super::priors::{MOST_WIDER, PLACES_WIDER, WRONG_DRAWING};
use crate::estimation::{ParameterId, Solution};
use crate::evidence::Evidence;
use crate::kinematics::{ForwardKinematics, inverse_kinematics};
use crate::robot::{PerAxis, Robot};
use crate::statistics::log_sum;

/// Pattern of displacements of the pulleys from the drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawingPattern {
    /// The pulleys are farther apart along an axis (0, 1, 2 for x, y, z); the size is that of the change of their extent (m).
    Extent(usize),
    /// All pulleys are turned about an axis (rad).
    Turn(usize),
    /// One pulley is elsewhere (m).
    Pulley(usize),
}

impl DrawingPattern {
    fn of_axes() -> impl Iterator<Item = Self> {
        (0..3).flat_map(|axis| [Self::Extent(axis), Self::Turn(axis)])
    }
}

/// A drawing that is wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct WrongDrawing {
    /// The pattern that stands out most.
    pub pattern: DrawingPattern,
    /// Its size, and its standard deviations as estimated and as stated (m or rad).
    pub size: f64,
    /// See `size`.
    pub sd: f64,
    /// See `size`.
    pub stated_sd: f64,
    /// Displacement of each pulley from the drawing (m).
    pub displacements_m: Vec<Vector3<f64>>,
    /// Root mean square distance of the platform between the identified places and those of the drawing, at the poses of the
    /// data (m); `None` where lengths alone do not determine its pose.
    pub worth_m: Option<f64>,
    /// Log odds over a right drawing, and over the causes that explain the readings otherwise.
    pub log_odds: f64,
}

impl WrongDrawing {
    /// Whether it is probable enough to be named.
    #[must_use]
    pub fn is_named(&self) -> bool {
        self.log_odds >= log_naming_odds()
    }
}

/// The robot with places of the pulleys that are known less well.
pub(super) fn with_wider_places(robot: &Robot) -> Robot {
    let mut wider = robot.clone();
    for cable in &mut wider.cables {
        let mut sds = cable.pulley.entry_point_sd_m.each();
        (sds.iter_mut().flatten()).for_each(|sd| *sd *= MOST_WIDER);
        cable.pulley.entry_point_sd_m = PerAxis::Each(sds);
    }
    wider
}

/// A pattern with the prior mean (m) and covariance (m^2) of the displacements.
type Pattern = (DrawingPattern, DVector<f64>, DMatrix<f64>);

/// Displacements of the coordinates whose places are stated with an uncertainty, in order of cable and axis.
struct Displacements {
    /// Cable and axis of each.
    places: Vec<(usize, usize)>,
    values: DVector<f64>,
    stated: DVector<f64>,
    estimated: DMatrix<f64>,
}

impl Displacements {
    fn of(robot: &Robot, solution: &Solution) -> Option<Self> {
        let covariance = solution.covariance.as_ref()?;
        let mut places = Vec::new();
        let mut columns = Vec::new();
        let (mut values, mut stated) = (Vec::new(), Vec::new());
        for (column, parameter) in solution.parameters.iter().enumerate() {
            let ParameterId::EntryPoint { cable, axis } = parameter.id else {
                continue;
            };
            let pulley = &robot.cables[cable].pulley;
            if let Some(sd) = pulley.entry_point_sd_m.each()[axis].filter(|sd| *sd > 0.0) {
                places.push((cable, axis));
                columns.push(column);
                let estimate = solution.globals.entry_points[cable][axis];
                values.push(estimate - pulley.entry_point_m[axis]);
                stated.push(sd * sd);
            }
        }
        (!places.is_empty()).then(|| Self {
            places,
            values: DVector::from_vec(values),
            stated: DVector::from_vec(stated),
            estimated: covariance.select_rows(&columns).select_columns(&columns),
        })
    }

    /// Size of a linear pattern with its stated variance and that of the estimate.
    fn along(&self, weights: &DVector<f64>) -> [f64; 3] {
        let stated = weights.component_mul(weights).dot(&self.stated);
        let estimated = weights.dot(&(&self.estimated * weights));
        [weights.dot(&self.values), stated, estimated]
    }

    /// The patterns, each with the prior mean and covariance of the displacements if it is known so much less well than stated.
    fn patterns(&self, robot: &Robot, widening: f64) -> Vec<Pattern> {
        let square = widening.powi(2);
        let on_axes = DrawingPattern::of_axes().filter_map(|pattern| {
            let weights = self.weights(robot, pattern)?;
            let [size, stated, _] = self.along(&weights);
            let shape = &weights / weights.norm_squared();
            let (mean, shape) = match pattern {
                DrawingPattern::Turn(about) => {
                    // The displacement by an angle is linear in it only beside the one that is found.
                    let angle = size.clamp(-1.0, 1.0).asin();
                    let (sin, cos) = angle.sin_cos();
                    let towards = self.towards_axis(robot, about);
                    let tangent = &shape * cos + &towards * sin;
                    let turned = shape * sin + towards * (1.0 - cos);
                    (turned - &tangent * angle, tangent)
                }
                _ => (DVector::zeros(shape.len()), shape),
            };
            let of_pattern = &shape * shape.transpose() * (square * stated);
            let prior = DMatrix::from_diagonal(&self.stated) + of_pattern;
            Some((pattern, mean, prior))
        });
        let of_pulleys = (0..robot.cable_count()).map(|cable| {
            let mut stated = self.stated.clone();
            for (variance, place) in stated.iter_mut().zip(&self.places) {
                *variance *= if place.0 == cable { square } else { 1.0 };
            }
            let prior = DMatrix::from_diagonal(&stated);
            (
                DrawingPattern::Pulley(cable),
                DVector::zeros(stated.len()),
                prior,
            )
        });
        on_axes.chain(of_pulleys).collect()
    }

    /// The way of each coordinate to the axis of a turn through the middle of the pulleys (m).
    fn towards_axis(&self, robot: &Robot, about: usize) -> DVector<f64> {
        let centre = centre_of(robot);
        let ways = self.places.iter().map(|&(cable, axis)| match axis {
            _ if axis == about => 0.0,
            _ => centre[axis] - robot.cables[cable].pulley.entry_point_m[axis],
        });
        DVector::from_iterator(self.places.len(), ways)
    }

    /// Weights of a pattern; of one pulley along its displacement.
    fn direction(&self, robot: &Robot, pattern: DrawingPattern) -> Option<DVector<f64>> {
        let DrawingPattern::Pulley(cable) = pattern else {
            return self.weights(robot, pattern);
        };
        let mut along = self.values.clone();
        for (value, place) in along.iter_mut().zip(&self.places) {
            *value *= if place.0 == cable { 1.0 } else { 0.0 };
        }
        Some(along.normalize())
    }

    /// Weights of the change of the extent along an axis, and of a turn about one; `None` where the pulleys have no extent.
    fn weights(&self, robot: &Robot, pattern: DrawingPattern) -> Option<DVector<f64>> {
        let place_of = |cable: usize| Vector3::from(robot.cables[cable].pulley.entry_point_m);
        let all = (0..robot.cable_count()).map(place_of);
        let centre = centre_of(robot);
        let lever = |(cable, axis): (usize, usize)| match pattern {
            DrawingPattern::Extent(along) if axis == along => place_of(cable)[axis] - centre[axis],
            DrawingPattern::Turn(about) => {
                let mut unit = Vector3::zeros();
                unit[about] = 1.0;
                unit.cross(&(place_of(cable) - centre))[axis]
            }
            DrawingPattern::Extent(_) | DrawingPattern::Pulley(_) => 0.0,
        };
        let levers = self.places.iter().map(|place| lever(*place));
        let levers = DVector::from_iterator(self.places.len(), levers);
        let square = levers.norm_squared();
        let extent = match pattern {
            DrawingPattern::Extent(axis) => {
                let [low, high] = [f64::min, f64::max].map(|extreme| {
                    all.clone()
                        .map(|place| place[axis])
                        .reduce(extreme)
                        .unwrap_or(0.0)
                });
                high - low
            }
            DrawingPattern::Turn(_) | DrawingPattern::Pulley(_) => 1.0,
        };
        (square > 0.0 && levers.iter().filter(|v| **v != 0.0).count() > 1)
            .then(|| levers * (extent / square))
    }
}

/// Middle of the pulleys (m).
fn centre_of(robot: &Robot) -> Vector3<f64> {
    let places = robot.cables.iter();
    let places = places.map(|cable| Vector3::from(cable.pulley.entry_point_m));
    places.sum::<Vector3<f64>>() / robot.cable_count() as f64
}

/// Evidence that the readings contradict the drawing.
pub(super) struct DrawingEvidence {
    /// Log odds of a wrong drawing over the stated one, as far as the model is linear in the places.
    pub log_odds: f64,
    /// Sum of all terms of the log evidence of a wrong drawing except half of chi-square, at the fit with wider places.
    pub of_wider: f64,
    /// Sum of all terms of the log evidence of a right drawing except half of chi-square, at a fit with the places as stated.
    pub of_stated: f64,
    /// The most probable of the patterns.
    pub pattern: DrawingPattern,
}

/// The evidence at a fit with places whose stated standard deviations were multiplied by `widening`; `None` where
/// it has no covariance. With the prior covariance `W` of that fit, the readings are like Gaussian ones of the displacements with the
/// information `L = C^-1 - W^-1` and the right side `h = C^-1 d`, so that a prior covariance `S` has the log evidence of
/// [`Evidence`]. A drawing is wrong anywhere, or in one of the patterns.
pub(super) fn drawing_evidence(
    robot: &Robot,
    solution: &Solution,
    widening: f64,
) -> Option<DrawingEvidence> {
    let displacements = Displacements::of(robot, solution)?;
    let precision = displacements.estimated.clone().cholesky()?.inverse();
    let right_side = &precision * &displacements.values;
    let prior = &displacements.stated * widening.powi(2);
    let information = precision - DMatrix::from_diagonal(&prior.map(f64::recip));
    let of_prior = |mean: &DVector<f64>, prior: &DMatrix<f64>| {
        let root = prior.clone().cholesky()?.unpack();
        let beside = &right_side - &information * mean;
        Evidence::with_prior(&beside, &information, &root)
    };
    // Log density of the readings at these displacements, relative to none.
    let log_density = |at: &DVector<f64>| right_side.dot(at) - 0.5 * at.dot(&(&information * at));
    let of_widening = |widening: f64| {
        let patterns = displacements.patterns(robot, widening).into_iter();
        patterns.filter_map(move |(pattern, mean, prior)| {
            Some((pattern, log_density(&mean) + of_prior(&mean, &prior)?.log()))
        })
    };
    let patterns: Vec<(DrawingPattern, f64)> =
        PLACES_WIDER.into_iter().flat_map(of_widening).collect();
    let most = patterns.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let in_pattern = log_sum(patterns.iter().map(|one| one.1)) - (patterns.len() as f64).ln();
    let wider = &displacements.stated * MOST_WIDER.powi(2);
    let none = DVector::zeros(wider.len());
    let anywhere = of_prior(&none, &DMatrix::from_diagonal(&wider))?;
    let wrong = log_sum([anywhere.log(), in_pattern].into_iter());
    let wrong = wrong + (WRONG_DRAWING / 2.0).ln();
    let stated = of_prior(&none, &DMatrix::from_diagonal(&displacements.stated))?;
    let right = (1.0 - WRONG_DRAWING).ln() + stated.log();
    Some(DrawingEvidence {
        log_odds: wrong - right,
        of_wider: wrong - anywhere.gain(),
        of_stated: right - stated.gain(),
        pattern: most.0,
    })
}

/// The wrong drawing with this most probable pattern and these log odds.
pub(super) fn wrong_drawing(
    robot: &Robot,
    solution: &Solution,
    pattern: DrawingPattern,
    log_odds: f64,
) -> Option<WrongDrawing> {
    let estimated = Displacements::of(robot, solution)?;
    let [size, stated, variance] = estimated.along(&estimated.direction(robot, pattern)?);
    Some(WrongDrawing {
        pattern,
        size,
        sd: variance.max(0.0).sqrt(),
        stated_sd: stated.sqrt(),
        displacements_m: displacements(robot, solution),
        worth_m: worth_of_places(robot, solution),
        log_odds,
    })
}

fn displacements(robot: &Robot, solution: &Solution) -> Vec<Vector3<f64>> {
    let pairs = robot.cables.iter().zip(&solution.globals.entry_points);
    pairs
        .map(|(cable, place)| Vector3::from(*place) - Vector3::from(cable.pulley.entry_point_m))
        .collect()
}

/// Root mean square distance of the platform between the identified places and those of the drawing (m), for the same lengths
/// at the poses of the data.
fn worth_of_places(robot: &Robot, solution: &Solution) -> Option<f64> {
    let identified = solution.globals.model(robot);
    let mut drawn = identified.clone();
    for (cable, stated) in drawn.cables.iter_mut().zip(&robot.cables) {
        cable.pulley.entry_point_m = stated.pulley.entry_point_m;
    }
    // Wrong places contradict the lengths; the pose that fits them best is what a controller would take.
    let solver = ForwardKinematics::new(&drawn)
        .ok()?
        .with_residual_limit(f64::INFINITY);
    let squares = solution.poses.iter().filter_map(|(_, pose)| {
        let states = inverse_kinematics(&identified, pose).ok()?;
        let lengths: Vec<f64> = states.iter().map(|state| state.length_m).collect();
        let solved = solver.solve(&lengths, pose);
        solved
            .converged
            .then(|| (solved.pose.position - pose.position).norm_squared())
    });
    let squares: Vec<f64> = squares.collect();
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}
