//! Identification: the result, its tables and its covariance.

use nalgebra::DMatrix;
use pyo3::prelude::*;
use tautline_core::effect::EffectRequest;
use tautline_core::estimation::{Loss, Method, Poses};
use tautline_core::measurement::Truth;
use tautline_workflow::identification::{
    Identification, IdentificationRequest, TolerancesUsed, entry_point_covariance,
    identify as identify_robot, identify_published, readings_table, values_table,
};

use crate::boundary::{
    DatasetTexts, detached, error, json, parsed_dataset, parsed_robot, settings,
};
use crate::table::{NamedColumn, columns, numbers};

/// Options of an identification.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct FitOptions {
    method: String,
    /// JSON of effect settings.
    effects: String,
    huber: Option<f64>,
    tolerances: String,
    /// `robot.json` of a model that is kept fixed.
    model: Option<String>,
    poses_held: bool,
}

/// Tables of readings and of values, names of the estimated parameters with their covariance, row by row, and the covariances
/// of the entry points, cables by 3 by 3.
type FitTables<'py> = (
    Vec<NamedColumn<'py>>,
    Vec<NamedColumn<'py>>,
    (Vec<String>, Bound<'py, PyAny>),
    Bound<'py, PyAny>,
);

impl FitOptions {
    /// Method of identification by its name in the commands.
    fn method(&self) -> PyResult<Method> {
        match self.method.as_str() {
            "joint" => Ok(Method::Joint),
            "simple" => Ok(Method::Simple),
            other => Err(error(format!(
                "method: found \"{other}\", expected \"joint\", \"simple\" or \"published\""
            ))),
        }
    }

    fn tolerances(&self) -> PyResult<TolerancesUsed> {
        match self.tolerances.as_str() {
            "stated" => Ok(TolerancesUsed::Stated),
            "typical" => Ok(TolerancesUsed::Typical),
            "none" => Ok(TolerancesUsed::None),
            other => Err(error(format!(
                "tolerances: found \"{other}\", expected \"stated\", \"typical\" or \"none\""
            ))),
        }
    }

    /// The published method has neither effects nor weights.
    fn refuse_with_published(&self) -> PyResult<()> {
        let given = match (settings(&self.effects)?.is_empty(), self.huber) {
            (false, _) => "effects",
            (_, Some(_)) => "huber",
            _ => return Ok(()),
        };
        Err(error(format!(
            "{given}: found with method \"published\", which has none; expected method \"joint\" or \"simple\""
        )))
    }

    fn request(&self, texts: &DatasetTexts) -> PyResult<IdentificationRequest> {
        let mut dataset = parsed_dataset(texts)?;
        // Identification never uses the true values of simulated data.
        dataset.measurements.truth = Truth::default();
        if let Some(model) = &self.model {
            let model = parsed_robot(model)?;
            let poses = match self.poses_held {
                true => Poses::HeldAtTracker,
                false => Poses::Estimated,
            };
            let request = IdentificationRequest::of_poses(dataset, model, poses);
            return request.map_err(|why| error(format!("model: {why}")));
        }
        let mut freed = Vec::new();
        for setting in settings(&self.effects)? {
            let name = setting.effect.clone();
            let bound = EffectRequest::from(setting).bind(&dataset.robot);
            for effect in bound.map_err(|e| error(format!("effects, {name}: {e}")))? {
                effect.check_poses(&dataset.measurements).map_err(error)?;
                freed.push(effect.setting(&dataset.robot));
            }
        }
        let request = IdentificationRequest::new(dataset, self.method()?, &freed);
        let mut request = request.map_err(error)?;
        request.options.tolerances = self.tolerances()?;
        if let Some(limit) = self.huber {
            if !(limit.is_finite() && limit > 0.0) {
                return Err(error(format!(
                    "huber: found {limit}, expected a positive number"
                )));
            }
            request.options.loss = Loss::Huber(limit);
        }
        Ok(request)
    }
}

/// The identification of a dataset; with a table of its readings only if they are listed.
pub fn solved(
    py: Python<'_>,
    dataset: &DatasetTexts,
    options: FitOptions,
    lists_readings: bool,
) -> PyResult<Identification> {
    let mut request = options.request(dataset)?;
    request.lists_readings = lists_readings;
    detached(py, |interrupt| {
        let found = identify_robot(&request, &mut |_| interrupt.control());
        let found = found.map_err(|e| e.to_string())?;
        found.refuse_extrapolation().map_err(|e| e.to_string())
    })
}

/// The result of the command `identify` or `evaluate`, and the identified robot.
#[pyfunction]
pub fn identify(
    py: Python<'_>,
    dataset: DatasetTexts,
    options: FitOptions,
) -> PyResult<(String, String)> {
    if options.method == "published" {
        options.refuse_with_published()?;
        let dataset = parsed_dataset(&dataset)?;
        let found = detached(py, |_| {
            identify_published(&dataset).map_err(|e| e.to_string())
        })?;
        return Ok((json(&found.document())?, json(&found.poses.model)?));
    }
    let found = solved(py, &dataset, options, false)?;
    Ok((json(&found.document())?, json(&found.model)?))
}

/// The tables and covariances of an identification.
#[pyfunction]
pub fn fit_tables<'py>(
    py: Python<'py>,
    dataset: DatasetTexts,
    options: FitOptions,
) -> PyResult<FitTables<'py>> {
    let fit = solved(py, &dataset, options, true)?;
    let solution = &fit.solution;
    let names: Vec<String> = solution.parameters.iter().map(|p| p.name.clone()).collect();
    let unknown = DMatrix::from_element(names.len(), names.len(), f64::NAN);
    let covariance = solution.covariance.as_ref().unwrap_or(&unknown);
    let cables = 0..fit.dataset.robot.cable_count();
    let entry_points = cables.flat_map(|cable| {
        let own = entry_point_covariance(solution, cable);
        own.map_or(vec![f64::NAN; 9], |own| own.iter().copied().collect())
    });
    Ok((
        columns(py, &readings_table(&fit))?,
        columns(py, &values_table(&fit))?,
        // Symmetric, so that the order of rows and columns does not matter.
        (names, numbers(py, covariance.iter().copied())),
        numbers(py, entry_points),
    ))
}
