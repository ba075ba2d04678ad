//! `tautline identify --method published`.

use anyhow::Result;
use tautline_core::estimation::published::{
    PublishedOptions, PublishedResult, PublishedStop, identify_published,
};
use tautline_core::estimation::{Geometry, Method, Problem};
use tautline_core::measurement::Dataset;

use super::BadInput;
use super::fitted::{Fitted, timed};
use super::identify::{Arguments, deliver};

/// Identifies by the published method, then fits the poses to its entry points by least squares, so
/// that residuals and chi-square compare with the other methods.
pub fn run(arguments: &Arguments, dataset: &Dataset) -> Result<()> {
    let (result, seconds) = identify(arguments, dataset)?;
    let mut identified = dataset.clone();
    for (cable, point) in identified
        .robot
        .cables
        .iter_mut()
        .zip(&result.entry_points_m)
    {
        cable.pulley.entry_point_m = *point;
    }
    let mut problem = Problem::new(&identified)
        .map_err(BadInput::new)?
        .with_method(Method::Simple);
    problem.geometry = Geometry::Held;
    let fitted = Fitted::solve(&problem, 1)?.compared_with(&dataset.robot);
    let mut identification = fitted.identification();
    "published".clone_into(&mut identification.method);
    identification.seconds = seconds;
    identification.iterations = result.iterations;
    identification.converged = matches!(
        result.stop,
        PublishedStop::SmallStep | PublishedStop::SmallError
    );
    // The method gives no standard deviations.
    identification.entry_points_sd_m = vec![[None; 3]; result.entry_points_m.len()];
    deliver(arguments, &fitted, &identification)
}

fn identify(arguments: &Arguments, dataset: &Dataset) -> Result<(PublishedResult, f64)> {
    let options = PublishedOptions::for_robot(&dataset.robot);
    timed(arguments.repeat, || {
        identify_published(dataset, &options).map_err(BadInput::new)
    })
}
