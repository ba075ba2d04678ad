//! Data of plots that a task has to compute: variables at all readings, and the fit with the findings.

use std::sync::Arc;

use tautline_core::diagnosis::{Quantity, Variables};
use tautline_core::estimation::{Control, Linearisation, Method};
use tautline_core::measurement::{Dataset, Variable};
use tautline_core::robot::Robot;

use super::open_session::Diagnosed;
use tautline_workflow::identification::{
    Identification, IdentificationRequest, group_of, identify, readings_of,
};

/// Readings of a quantity and cable, with the variables they may depend on.
#[derive(Debug, Clone)]
pub struct ReadingVariables {
    pub quantity: Quantity,
    /// Cable, for readings of a cable.
    pub cable: Option<usize>,
    /// Variables that vary, with their values in the rows of the measurements.
    pub variables: Vec<(Variable, Vec<f64>)>,
}

#[derive(Debug)]
pub struct Prepared {
    /// Fit of the present model.
    pub base: Arc<Identification>,
    /// Fit of the model with the findings of the diagnosis.
    pub extended: Option<Identification>,
    /// Variables at the readings of the first fit.
    pub along: Vec<ReadingVariables>,
}

/// Inputs and result of a preparation.
#[derive(Debug, Clone)]
pub struct Preparation {
    pub fit: Option<Arc<Identification>>,
    pub diagnosed: Option<Arc<Diagnosed>>,
    /// Prepared data, or the reason why there are none.
    pub result: Result<Arc<Prepared>, String>,
}

impl Preparation {
    /// Computes the preparation; a diagnosis takes precedence, since the plots compare its fits.
    #[must_use]
    pub fn new(
        fit: Option<Arc<Identification>>,
        diagnosed: Option<Arc<Diagnosed>>,
        cancelled: &dyn Fn() -> bool,
    ) -> Self {
        let result = match (&diagnosed, &fit) {
            (Some(found), _) => before_and_after(found, cancelled),
            (None, Some(fit)) => along(fit).map(|along| Prepared {
                base: Arc::clone(fit),
                extended: None,
                along,
            }),
            (None, None) => Err("nothing is identified".to_owned()),
        };
        Self {
            fit,
            diagnosed,
            result: result.map(Arc::new),
        }
    }

    /// Whether it was computed from these inputs.
    #[must_use]
    pub fn is_of(
        &self,
        fit: Option<&Arc<Identification>>,
        diagnosed: Option<&Arc<Diagnosed>>,
    ) -> bool {
        same(self.fit.as_ref(), fit) && same(self.diagnosed.as_ref(), diagnosed)
    }
}

/// Fits of a diagnosis: of its model, and of its model with the findings.
fn before_and_after(found: &Diagnosed, cancelled: &dyn Fn() -> bool) -> Result<Prepared, String> {
    let robot = &found.dataset.robot;
    let base = again(robot, found, cancelled)?;
    let model = found.diagnosis.extended_solution.globals.model(robot);
    let extended = (!found.diagnosis.findings.is_empty())
        .then(|| again(&model, found, cancelled))
        .transpose()?;
    Ok(Prepared {
        along: along(&base)?,
        base: Arc::new(base),
        extended,
    })
}

/// Fits the measurements of a diagnosis with a model whose effects are held fixed.
fn again(
    model: &Robot,
    found: &Diagnosed,
    cancelled: &dyn Fn() -> bool,
) -> Result<Identification, String> {
    let dataset = Dataset {
        robot: model.clone(),
        measurements: found.dataset.measurements.clone(),
    };
    let request = IdentificationRequest::new(dataset, Method::Joint, &[]);
    let request = request.map_err(|error| error.to_string())?;
    let done = identify(&request, &mut |_| match cancelled() {
        true => Control::Cancel,
        false => Control::Continue,
    });
    if cancelled() {
        return Err("it was cancelled".to_owned());
    }
    done.map_err(|error| error.to_string())
}

/// Whether both are the same object, not only equal.
pub fn same<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (None, None) => true,
        _ => false,
    }
}

fn along(fit: &Identification) -> Result<Vec<ReadingVariables>, String> {
    let problem = fit.problem().map_err(|error| error.to_string())?;
    let linear = Linearisation::new(&problem, &fit.solution);
    let variables = Variables::new(&problem, &fit.solution, &linear);
    let known = |(quantity, cable): (Quantity, Option<usize>)| {
        let values = Variable::ALL.into_iter().filter_map(|variable| {
            let values = variables.values(quantity, cable, variable)?;
            Some((variable, values))
        });
        ReadingVariables {
            quantity,
            cable,
            variables: values.collect(),
        }
    };
    let mut along: Vec<ReadingVariables> = groups(fit).into_iter().map(known).collect();
    along.retain(|group| !group.variables.is_empty());
    Ok(along)
}

/// Quantities of the readings of a fit, with their cables.
fn groups(fit: &Identification) -> Vec<(Quantity, Option<usize>)> {
    let mut groups: Vec<_> = fit
        .analysis
        .observations
        .iter()
        .filter_map(|reading| group_of(reading.kind))
        .collect();
    groups.sort();
    groups.dedup();
    groups
}

/// Normalised residuals of a quantity, with their rows.
#[must_use]
pub fn residuals(
    fit: &Identification,
    quantity: Quantity,
    cable: Option<usize>,
) -> Vec<(usize, f64)> {
    readings_of(&fit.analysis, quantity, cable)
        .filter_map(|one| Some((one.row, one.normalised()?)))
        .collect()
}
