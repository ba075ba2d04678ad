//! Layout of the equations: the rows of a pose and the columns of the common parameters.

use crate::estimation::observation::ObservationKind as Kind;
use crate::estimation::problem::{Geometry, Poses, Problem};
use crate::geometry::Coordinate;

/// Row and column numbering of one pose's whitened equations.
///
/// The columns, before they are mapped to the estimated parameters, are for each cable
/// `[a_x a_y a_z s]` (entry point, unstrained length at home), then the offset of the target plane,
/// then the parameters of free effects and of deviations.
#[derive(Debug, Clone)]
pub(in crate::estimation) struct Layout {
    pub cables: usize,
    /// Number of columns of effects.
    pub effects: usize,
    /// First row of each kind that the problem has; the length rows precede them, one per cable.
    pub equilibrium: Option<usize>,
    pub laser: Option<usize>,
    pub swivel: Option<usize>,
    pub tracker_position: Option<usize>,
    pub tracker_orientation: Option<usize>,
    pub inclination: Option<usize>,
    /// Kind of each row.
    pub kinds: Vec<Kind>,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
}

/// Columns per cable.
pub(in crate::estimation) const CABLE_COLUMNS: usize = 4;

impl Layout {
    pub fn new(problem: &Problem<'_>, effect_columns: usize) -> Self {
        let data = &problem.dataset.measurements;
        let robot = &problem.dataset.robot;
        let cables = robot.cable_count();
        let mut kinds: Vec<Kind> = (0..cables).map(Kind::Length).collect();
        let mut block = |present: bool, count: usize, kind: &dyn Fn(usize) -> Kind| {
            present.then(|| {
                kinds.extend((0..count).map(kind));
                kinds.len() - count
            })
        };
        let along = |k: usize| Kind::Equilibrium(Coordinate::ALL[k]);
        let equilibrium = block(problem.has_equilibrium(), 6, &along);
        let has_laser = robot.laser.is_some() && !data.laser_m.is_empty();
        let laser = block(has_laser, 1, &|_| Kind::Laser);
        let swivels = robot
            .cables
            .iter()
            .any(|c| c.pulley.swivel_sd_rad.is_some());
        let swivel = block(
            swivels && !data.swivel_rad.is_empty(),
            cables,
            &Kind::Swivel,
        );
        // Held poses are those of the tracker, so its rows would compare them with themselves.
        let tracked = robot.tracker.is_some() && problem.poses == Poses::Estimated;
        let positions = tracked && !data.tracked_position_m.is_empty();
        let tracker_position = block(positions, 3, &Kind::TrackerPosition);
        let turns = tracked
            && robot
                .tracker
                .is_some_and(|t| t.orientation_sd_rad.is_some());
        let orientations = turns && !data.tracked_orientation_wxyz.is_empty();
        let tracker_orientation = block(orientations, 3, &Kind::TrackerOrientation);
        let inclined = robot.inclinometer.is_some() && !data.inclination_rad.is_empty();
        let inclination = block(inclined, 3, &Kind::Inclination);
        Self {
            cables,
            effects: effect_columns,
            equilibrium,
            laser,
            swivel,
            tracker_position,
            tracker_orientation,
            inclination,
            rows: kinds.len(),
            kinds,
            columns: CABLE_COLUMNS * cables + 1 + effect_columns,
        }
    }

    /// First column of a cable.
    pub fn cable_column(&self, cable: usize) -> usize {
        CABLE_COLUMNS * cable
    }

    /// Column of the unstrained length at home of a cable.
    pub fn home_length_column(&self, cable: usize) -> usize {
        CABLE_COLUMNS * cable + 3
    }

    /// Column of the offset of the target plane.
    pub fn plane_column(&self) -> usize {
        CABLE_COLUMNS * self.cables
    }

    /// First column of the effect parameters.
    pub fn effect_column(&self) -> usize {
        CABLE_COLUMNS * self.cables + 1
    }
}

/// Number of columns of the free effects and the deviations.
pub(in crate::estimation) fn effect_columns(problem: &Problem<'_>) -> usize {
    if problem.geometry == Geometry::Held {
        return 0;
    }
    problem.estimated().map(|bound| bound.values.len()).sum()
}
