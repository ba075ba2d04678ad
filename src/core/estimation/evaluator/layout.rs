//! Layout of the equations: the rows of a pose and the columns of the common parameters.

use std::ops::Range;

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
    /// The estimated parameter of each column of effects: index in [`Problem::estimated`], and of the parameter there.
    pub effect_parameters: Vec<(usize, usize)>,
    /// The columns of effects on which the rows of each cable can depend, then those for the platform's instruments; in
    /// rising order, counted from [`Self::effect_column`].
    effects_of_owner: Vec<Vec<usize>>,
    /// Offset of the derivatives of each row by its effects, then the number of all of them.
    first_effect: Vec<usize>,
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
    pub fn new(problem: &Problem<'_>) -> Self {
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
        let effect_parameters = effect_parameters(problem);
        let mut layout = Self {
            cables,
            effects_of_owner: effects_of_owner(problem, &effect_parameters),
            first_effect: Vec::new(),
            equilibrium,
            laser,
            swivel,
            tracker_position,
            tracker_orientation,
            inclination,
            rows: kinds.len(),
            kinds,
            columns: CABLE_COLUMNS * cables + 1 + effect_parameters.len(),
            effect_parameters,
        };
        let mut first = 0;
        layout.first_effect.push(first);
        for row in 0..layout.rows {
            first += layout.effects_of(row).len();
            layout.first_effect.push(first);
        }
        layout
    }

    /// The columns of effects, counted from [`Self::effect_column`], on which a row can depend; none for the equilibrium,
    /// whose derivatives are stored for all columns.
    pub fn effects_of(&self, row: usize) -> &[usize] {
        match self.kinds[row] {
            Kind::Length(cable) | Kind::Swivel(cable) => self.effects_of_cable(cable),
            Kind::Equilibrium(_) | Kind::Tension(_) => &[],
            Kind::Laser
            | Kind::TrackerPosition(_)
            | Kind::TrackerOrientation(_)
            | Kind::Inclination(_) => self.effects_of_platform(),
            Kind::Distance(_) => &[],
        }
    }

    /// The columns of effects on which the rows of a cable can depend.
    pub fn effects_of_cable(&self, cable: usize) -> &[usize] {
        &self.effects_of_owner[cable]
    }

    /// The columns of effects on which the rows of the platform's instruments can depend.
    pub fn effects_of_platform(&self) -> &[usize] {
        &self.effects_of_owner[self.cables]
    }

    /// Range of the stored derivatives of a row by the columns of [`Self::effects_of`].
    pub fn effect_range(&self, row: usize) -> Range<usize> {
        self.first_effect[row]..self.first_effect[row + 1]
    }

    /// Number of stored derivatives by effects.
    pub fn effect_derivatives(&self) -> usize {
        self.first_effect[self.rows]
    }

    /// Column of an estimated parameter of an effect or deviation, given by its index in [`Problem::estimated`].
    pub fn column_of_effect(&self, effect: usize, parameter: usize) -> Option<usize> {
        let found = self.effect_parameters.binary_search(&(effect, parameter));
        found.ok().map(|index| self.effect_column() + index)
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

/// Every estimated parameter of the free effects and the deviations: index in [`Problem::estimated`], and of the parameter
/// there.
fn effect_parameters(problem: &Problem<'_>) -> Vec<(usize, usize)> {
    if problem.geometry == Geometry::Held {
        return Vec::new();
    }
    let free = problem.free_effects.iter().map(|bound| {
        let is_estimated = bound.effect.parameters().iter().map(|p| !p.discrete);
        is_estimated.collect::<Vec<_>>()
    });
    let deviations = problem.deviations.iter().map(|deviation| {
        let is_estimated = deviation.prior_sd.iter().map(|sd| *sd != 0.0);
        is_estimated.collect()
    });
    let all = free.chain(deviations).enumerate();
    all.flat_map(|(effect, is_estimated)| {
        let own = is_estimated.into_iter().enumerate();
        own.filter_map(move |(parameter, is_estimated)| is_estimated.then_some((effect, parameter)))
    })
    .collect()
}

/// The columns that each cable's rows can depend on, then those of the platform's rows.
fn effects_of_owner(problem: &Problem<'_>, parameters: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let cables = problem.dataset.robot.cable_count();
    let mut columns = vec![Vec::new(); cables + 1];
    let estimated: Vec<_> = problem.estimated().collect();
    for (column, (effect, _)) in parameters.iter().enumerate() {
        let bound = estimated[*effect];
        for cable in &bound.cables {
            columns[*cable].push(column);
        }
        if bound.acts_on_platform() {
            columns[cables].push(column);
        }
    }
    columns
}
