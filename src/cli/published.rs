//! `tautline identify --method published`.

use anyhow::Result;
use tautline_core::estimation::{Geometry, Method, Problem};
use tautline_core::measurement::Dataset;

use super::BadInput;
use super::fitted::{Fitted, timed};
use super::identify::{Arguments, deliver};
use tautline_workflow::documents::identification::{PublishedFit, fit_published};

/// Identifies by the published method, then fits the poses to its entry points by least squares, so
/// that residuals and chi-square compare with the other methods.
pub fn run(arguments: &Arguments, dataset: &Dataset) -> Result<()> {
    let (result, seconds) = timed(arguments.repeat, || {
        fit_published(dataset).map_err(BadInput::new)
    })?;
    let published = PublishedFit { result, seconds };
    let identified = published.applied_to(dataset);
    let mut problem = Problem::new(&identified)
        .map_err(BadInput::new)?
        .with_method(Method::Simple);
    problem.geometry = Geometry::Held;
    let fitted = Fitted::solve(&problem, 1)?.compared_with(&dataset.robot);
    let identification = published.identification(fitted.identification());
    deliver(arguments, &fitted, &identification)
}
