//! Budget of the uncertainty of identified values: the share of each source (GUM, JCGM 100:2008, clause 5).
//!
//! Every row `i` of a [`Linearisation`](super::Linearisation) is one reading, equation or prior in units of its standard
//! deviation. With its derivative `a_i` by the parameters, an error `e_i` of the row changes them by `-C a_i e_i`, where
//! `C = (sum a_i a_i^T)^-1` is their covariance. The errors are independent, so the covariance is a sum over sources `s`,
//!
//! `C = sum_s V_s`,  `V_s = sum_(i in s) (C a_i)(C a_i)^T`,
//!
//! exactly and without negative terms. The variance of `h^T dp` has the contributions `h^T V_s h`, and the mean square
//! `dp^T M dp` of a quantity with several components `tr(M V_s)`. Where tensions are latent, length and tension
//! readings and the unexplained wrench share rows of the equations; they are rows of their own here, see
//! [`NoiseEstimate`](super::evaluator::NoiseEstimate).

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::covariance::covariance_of;
use super::linearisation::{LinearBlock, LinearisedProblem, RowKind};
use super::observation::ObservationKind;
use super::parameter::{Parameter, ParameterId};
use super::problem::{Loss, Problem};
use super::solution::Solution;

/// A source of uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum UncertaintySource {
    /// Noise of the length readings of the winches' encoders.
    Encoders,
    /// Noise of the force sensors.
    ForceSensors,
    /// Tensions that nothing measures, within their limits.
    AssumedTensions,
    /// Unexplained wrench on the platform in static equilibrium, `platform.wrench_sd`.
    UnexplainedWrench,
    /// Noise of the laser.
    Laser,
    /// Noise of the swivel angles.
    SwivelSensors,
    /// Noise of the inclinometer.
    Inclinometer,
    /// Noise of the external instrument.
    ExternalInstrument,
    /// Noise of measured distances and of the poses that they connect.
    Distances,
    /// Measured home pose.
    HomePose,
    /// Entry points on the drawing.
    Drawing,
    /// Stated offset of the laser's target plane.
    TargetPlane,
    /// Tolerance of the parts, by the identifier of its effect.
    Tolerance(&'static str),
    /// Prior of a free effect, by its identifier.
    EffectPrior(&'static str),
}

/// Contribution of one source to a variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UncertaintyContribution {
    /// The source.
    pub source: UncertaintySource,
    /// Its part of the variance (square of the unit of the quantity).
    pub variance: f64,
}

/// Budget of the variance of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertaintyBudget {
    /// Contributions of all sources of the problem, in the order of the sources.
    pub contributions: Vec<UncertaintyContribution>,
}

impl UncertaintySource {
    /// Name in files: `laser`, `tolerance:winch_scale`.
    #[must_use]
    pub fn id(self) -> String {
        match self {
            Self::Encoders => "encoders".to_owned(),
            Self::ForceSensors => "force_sensors".to_owned(),
            Self::AssumedTensions => "assumed_tensions".to_owned(),
            Self::UnexplainedWrench => "unexplained_wrench".to_owned(),
            Self::Laser => "laser".to_owned(),
            Self::SwivelSensors => "swivel_sensors".to_owned(),
            Self::Inclinometer => "inclinometer".to_owned(),
            Self::ExternalInstrument => "external_instrument".to_owned(),
            Self::Distances => "distances".to_owned(),
            Self::HomePose => "home_pose".to_owned(),
            Self::Drawing => "drawing".to_owned(),
            Self::TargetPlane => "target_plane".to_owned(),
            Self::Tolerance(effect) => format!("tolerance:{effect}"),
            Self::EffectPrior(effect) => format!("prior:{effect}"),
        }
    }

    /// The source of a reading or an equation of equilibrium.
    #[must_use]
    pub fn of_reading(kind: ObservationKind) -> Self {
        match kind {
            ObservationKind::Length(_) => Self::Encoders,
            ObservationKind::Tension(_) => Self::ForceSensors,
            ObservationKind::Equilibrium(_) => Self::UnexplainedWrench,
            ObservationKind::Laser => Self::Laser,
            ObservationKind::Swivel(_) => Self::SwivelSensors,
            ObservationKind::TrackerPosition(_) | ObservationKind::TrackerOrientation(_) => {
                Self::ExternalInstrument
            }
            ObservationKind::Inclination(_) => Self::Inclinometer,
            ObservationKind::Distance(_) => Self::Distances,
        }
    }

    fn of(problem: &Problem<'_>, parameters: &[Parameter], kind: RowKind) -> Self {
        match kind {
            RowKind::AssumedTension(_) => Self::AssumedTensions,
            RowKind::Observation(kind) => Self::of_reading(kind),
            RowKind::Prior(index) => match parameters[index].id {
                ParameterId::EntryPoint { .. } => Self::Drawing,
                ParameterId::PlaneOffset => Self::TargetPlane,
                ParameterId::Home(_) => Self::HomePose,
                ParameterId::HomeTension { .. } => Self::ForceSensors,
                ParameterId::Effect { effect, .. } => {
                    Self::EffectPrior(problem.free_effects[effect].effect.id())
                }
                ParameterId::Deviation { deviation, .. } => {
                    Self::Tolerance(problem.deviations[deviation].bound.effect.id())
                }
            },
        }
    }
}

impl UncertaintyBudget {
    /// The variance: the sum of all contributions (square of the unit of the quantity).
    #[must_use]
    pub fn variance(&self) -> f64 {
        self.contributions.iter().map(|one| one.variance).sum()
    }

    /// Every source with its share of the variance, 0 to 1, in the order of the sources.
    pub fn shares(&self) -> impl Iterator<Item = (UncertaintySource, f64)> {
        let whole = self.variance();
        let share = move |one: &UncertaintyContribution| (one.source, one.variance / whole);
        self.contributions.iter().map(share)
    }

    /// The source with the largest share, and that share.
    #[must_use]
    pub fn largest(&self) -> Option<(UncertaintySource, f64)> {
        self.shares().max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The covariance of the parameters at a solution, by source.
#[derive(Debug, Clone)]
pub struct CovarianceBySource {
    /// The parameters, in the order of the matrices.
    pub parameters: Vec<Parameter>,
    /// `V_s` of each source, parameters x parameters (products of their SI units).
    pub sources: Vec<(UncertaintySource, DMatrix<f64>)>,
    /// Weights `M` of the mean square position error at the measured poses, see [`Self::position`].
    position_weights: Option<DMatrix<f64>>,
}

impl CovarianceBySource {
    /// Divides the covariance at the solution of `problem`; `None` if the data do not determine the parameters, or for
    /// a robust loss, whose estimate is no linear function of the readings.
    #[must_use]
    pub fn new(problem: &Problem<'_>, solution: &Solution) -> Option<Self> {
        solution.covariance.as_ref()?;
        if problem.loss != Loss::Square {
            return None;
        }
        let mut at = LinearisedProblem::new(problem, solution);
        let n = solution.parameters.len();
        let mut information = BTreeMap::new();
        let mut add = |block: &LinearBlock| {
            for (source, rows) in by_source(problem, &solution.parameters, block) {
                let sum = (information.entry(source)).or_insert_with(|| DMatrix::zeros(n, n));
                let own = block.design.select_rows(&rows);
                sum.gemm_tr(1.0, &own, &own, 1.0);
            }
        };
        let (mut weights, mut count) = (DMatrix::zeros(n, n), 0_usize);
        for index in 0..at.pose_count() {
            add(&at.pose(index).block);
            if let Some(error) = at.position_by_parameter(index) {
                weights.gemm_tr(1.0, &error, &error, 1.0);
                count += 1;
            }
        }
        add(&at.home());
        add(&at.distances());
        add(&at.priors());
        let whole = (information.values()).fold(DMatrix::zeros(n, n), |sum, one| sum + one);
        let covariance = covariance_of(&whole)?;
        let divided = information.into_iter();
        Some(Self {
            parameters: solution.parameters.clone(),
            sources: divided
                .map(|(source, own)| (source, &covariance * own * &covariance))
                .collect(),
            position_weights: (count > 0).then(|| weights / count as f64),
        })
    }

    /// Budget of the mean square `dp^T M dp` with the weights `M`, parameters x parameters.
    #[must_use]
    pub fn budget(&self, weights: &DMatrix<f64>) -> UncertaintyBudget {
        self.by(|own| weights.dot(own))
    }

    /// Budget of a coordinate of a cable's entry point (m^2); `None` if it was not estimated.
    #[must_use]
    pub fn entry_point_coordinate(&self, cable: usize, axis: usize) -> Option<UncertaintyBudget> {
        let column = self.entry_point_column(cable, axis)?;
        Some(self.by(|own| own[(column, column)]))
    }

    /// Budget of a cable's entry point (m^2): of the sum of the variances of its coordinates; `None` if none was estimated.
    #[must_use]
    pub fn entry_point(&self, cable: usize) -> Option<UncertaintyBudget> {
        let columns = (0..3).filter_map(|axis| self.entry_point_column(cable, axis));
        let columns: Vec<usize> = columns.collect();
        let sum = |own: &DMatrix<f64>| columns.iter().map(|k| own[(*k, *k)]).sum();
        (!columns.is_empty()).then(|| self.by(sum))
    }

    fn entry_point_column(&self, cable: usize, axis: usize) -> Option<usize> {
        let id = ParameterId::EntryPoint { cable, axis };
        self.parameters.iter().position(|p| p.id == id)
    }

    fn by(&self, variance: impl Fn(&DMatrix<f64>) -> f64) -> UncertaintyBudget {
        let sources = self.sources.iter();
        let contributions = sources.map(|(source, own)| UncertaintyContribution {
            source: *source,
            variance: variance(own),
        });
        UncertaintyBudget {
            contributions: contributions.collect(),
        }
    }

    /// Budget of the position of the platform (m^2): of the mean square position error at the measured poses once the
    /// identified values are at the controller, which then commands the lengths of the model; tensions are taken as known. `None`
    /// if no pose has all lengths.
    #[must_use]
    pub fn position(&self) -> Option<UncertaintyBudget> {
        Some(self.budget(self.position_weights.as_ref()?))
    }
}

/// The rows of each source in a block.
fn by_source(
    problem: &Problem<'_>,
    parameters: &[Parameter],
    block: &LinearBlock,
) -> BTreeMap<UncertaintySource, Vec<usize>> {
    let mut rows: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (index, row) in block.rows.iter().enumerate() {
        let source = UncertaintySource::of(problem, parameters, row.kind);
        rows.entry(source).or_default().push(index);
    }
    rows
}
