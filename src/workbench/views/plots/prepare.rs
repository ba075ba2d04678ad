//! What some plots need and only a task can compute: variables at all readings, and the fit with what was found.

use std::sync::Arc;

use tautline_core::diagnosis::{Quantity, Variables};
use tautline_core::effect::measurements_as_modelled;
use tautline_core::estimation::{Control, Linearisation, Method, Problem, ReadingKind};
use tautline_core::measurement::{Dataset, Variable};
use tautline_core::robot::Robot;

use crate::app::document::Diagnosed;
use crate::app::fit::{Fit, FitOrder, fit};

/// Readings of one kind and cable with what they may depend on.
#[derive(Debug, Clone)]
pub struct Along {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable, if the reading is a cable's.
    pub cable: Option<usize>,
    /// Each variable that varies, with its value in each row of the measurements.
    pub variables: Vec<(Variable, Vec<f64>)>,
}

/// What was prepared, with what it was prepared from.
#[derive(Debug)]
pub struct Prepared {
    from: (Option<Arc<Fit>>, Option<Arc<Diagnosed>>),
    /// The fit of the model as it is.
    pub base: Arc<Fit>,
    /// The fit of the model with what was found.
    pub extended: Option<Fit>,
    /// Variables at the readings of the base fit.
    pub along: Vec<Along>,
}

impl Prepared {
    /// Computes it; a diagnosis comes first, since it is what the plots are about. `method` is that of the
    /// identification; a diagnosis always is of the joint problem.
    ///
    /// # Errors
    /// If there is nothing to prepare, it was cancelled, or the measurements cannot be used.
    pub fn new(
        identified: Option<Arc<Fit>>,
        diagnosed: Option<Arc<Diagnosed>>,
        method: Method,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<Self, String> {
        let again = |robot: &Robot, found: &Diagnosed| -> Result<Fit, String> {
            let text = |error: &dyn std::fmt::Display| error.to_string();
            let read = &found.dataset.measurements;
            let measurements =
                measurements_as_modelled(robot, read).map_err(|error| text(&error))?;
            let order = FitOrder {
                dataset: Arc::new(Dataset {
                    robot: robot.clone(),
                    measurements: measurements.into_owned(),
                }),
                method: Method::Joint,
                effects: Vec::new(),
            };
            let mut control = |_: &_| match cancelled() {
                true => Control::Cancel,
                false => Control::Continue,
            };
            let done = fit(order, &mut control).map_err(|error| text(&error))?;
            if cancelled() {
                return Err("it was cancelled".to_owned());
            }
            Ok(done)
        };
        let method = if diagnosed.is_some() {
            Method::Joint
        } else {
            method
        };
        let (base, extended) = match (&diagnosed, &identified) {
            (Some(found), _) => {
                let base = again(&found.dataset.robot, found)?;
                let globals = &found.diagnosis.extended_solution.globals;
                let model = globals.model(&found.dataset.robot);
                let extended = (!found.diagnosis.findings.is_empty())
                    .then(|| again(&model, found))
                    .transpose()?;
                (Arc::new(base), extended)
            }
            (None, Some(fit)) => (Arc::clone(fit), None),
            (None, None) => return Err("nothing is identified".to_owned()),
        };
        let along = along(&base, method)?;
        Ok(Self {
            from: (identified, diagnosed),
            base,
            extended,
            along,
        })
    }

    /// Whether it was prepared from these.
    #[must_use]
    pub fn is_of(&self, fit: Option<&Arc<Fit>>, diagnosed: Option<&Arc<Diagnosed>>) -> bool {
        same(self.from.0.as_ref(), fit) && same(self.from.1.as_ref(), diagnosed)
    }
}

/// Whether two are the same object, not only equal.
pub fn same<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (None, None) => true,
        _ => false,
    }
}

fn along(fit: &Fit, method: Method) -> Result<Vec<Along>, String> {
    let problem = Problem::new(&fit.dataset).map_err(|error| error.to_string())?;
    let mut problem = problem.with_method(method);
    // Those that are not the model's own were identified.
    problem.free_effects = fit.solution.globals.effects[problem.held_effects.len()..].to_vec();
    let linear = Linearisation::new(&problem, &fit.solution);
    let variables = Variables::new(&problem, &fit.solution, &linear);
    let known = |(quantity, cable): (Quantity, Option<usize>)| {
        let values = Variable::ALL.into_iter().filter_map(|variable| {
            let values = variables.values(quantity, cable, variable)?;
            Some((variable, values))
        });
        Along {
            quantity,
            cable,
            variables: values.collect(),
        }
    };
    let mut along: Vec<Along> = groups(fit).into_iter().map(known).collect();
    along.retain(|group| !group.variables.is_empty());
    Ok(along)
}

/// Kinds of readings, per cable where they belong to cables, that a fit has.
fn groups(fit: &Fit) -> Vec<(Quantity, Option<usize>)> {
    let mut groups: Vec<_> = fit
        .analysis
        .readings
        .iter()
        .filter_map(|reading| group_of(reading.kind))
        .collect();
    let tensions = fit.analysis.tension_errors_n.iter();
    groups.extend(tensions.map(|(_, cable, _)| (Quantity::Tension, Some(*cable))));
    groups.sort();
    groups.dedup();
    groups
}

/// Kind and cable of a reading; none for the balance of forces, which no sensor reads.
#[must_use]
pub fn group_of(kind: ReadingKind) -> Option<(Quantity, Option<usize>)> {
    Some(match kind {
        ReadingKind::Length(cable) => (Quantity::Length, Some(cable)),
        ReadingKind::Swivel(cable) => (Quantity::Swivel, Some(cable)),
        ReadingKind::Laser => (Quantity::Laser, None),
        ReadingKind::TrackerPosition(_) => (Quantity::TrackerPosition, None),
        ReadingKind::TrackerOrientation(_) => (Quantity::TrackerOrientation, None),
        ReadingKind::Inclination(_) => (Quantity::Inclination, None),
        ReadingKind::Equilibrium(_) => return None,
    })
}

/// Residuals of a kind of reading in their own standard deviations: row and value.
#[must_use]
pub fn residuals(fit: &Fit, quantity: Quantity, cable: Option<usize>) -> Vec<(usize, f64)> {
    if quantity == Quantity::Tension {
        let sensors = &fit.dataset.robot.cables;
        let errors = fit.analysis.tension_errors_n.iter();
        return errors
            .filter(|(_, of, _)| Some(*of) == cable)
            .filter_map(|(row, of, error)| {
                let sd = sensors.get(*of)?.force_sensor?.tension_sd_n;
                Some((*row, error / sd))
            })
            .collect();
    }
    let readings = fit.analysis.readings.iter();
    readings
        .filter(|reading| group_of(reading.kind) == Some((quantity, cable)))
        .filter_map(|reading| Some((reading.row, reading.normalised()?)))
        .collect()
}
