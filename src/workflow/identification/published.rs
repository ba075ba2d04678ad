//! Identification by the published method (Jin et al. 2018), in a form comparable with the other methods.

use std::time::Instant;

use tautline_core::estimation::published::{
    PublishedError, PublishedOptions, PublishedResult, PublishedStop,
};
use tautline_core::estimation::{Control, EstimationError, Geometry, Method, published};
use tautline_core::measurement::Dataset;

use super::{
    Identification, IdentificationDocument, IdentificationOptions, IdentificationRequest, identify,
};

/// Result of the published method.
#[derive(Debug, Clone)]
pub struct PublishedIdentification {
    /// Entry points and steps.
    pub result: PublishedResult,
    /// The poses fitted to these entry points by least squares, so that residuals and chi-square compare with those of
    /// the other methods.
    pub poses: Box<Identification>,
    /// Time taken by the method (s).
    pub seconds: f64,
}

/// Reasons why the published method cannot be applied.
#[derive(Debug, thiserror::Error)]
pub enum PublishedIdentificationError {
    /// The dataset lacks a prerequisite of the method.
    #[error(transparent)]
    Published(#[from] PublishedError),
    /// No poses can be fitted to the identified entry points.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
}

/// Identifies by the published method with the choices of the paper.
///
/// # Errors
/// If the dataset lacks a prerequisite of the method.
pub fn identify_published(
    dataset: &Dataset,
) -> Result<PublishedIdentification, PublishedIdentificationError> {
    let started = Instant::now();
    let options = PublishedOptions::for_robot(&dataset.robot);
    let result = published::identify_published(dataset, &options)?;
    let seconds = started.elapsed().as_secs_f64();
    let mut identified = dataset.clone();
    let cables = identified.robot.cables.iter_mut();
    for (cable, point) in cables.zip(&result.entry_points_m) {
        cable.pulley.entry_point_m = *point;
    }
    let request = IdentificationRequest {
        dataset: identified.into(),
        method: Method::Simple,
        effects: Vec::new(),
        options: IdentificationOptions {
            geometry: Geometry::Held,
            ..IdentificationOptions::default()
        },
        lists_readings: true,
    };
    Ok(PublishedIdentification {
        poses: Box::new(identify(&request, &mut |_| Control::Continue)?),
        result,
        seconds,
    })
}

impl PublishedIdentification {
    /// Whether the iteration stopped because its steps or errors became small.
    #[must_use]
    pub fn converged(&self) -> bool {
        let ends = [PublishedStop::SmallStep, PublishedStop::SmallError];
        ends.contains(&self.result.stop)
    }

    /// Machine-readable form; the method gives no standard deviations.
    #[must_use]
    pub fn document(&self) -> IdentificationDocument {
        IdentificationDocument {
            method: "published".to_owned(),
            seconds: self.seconds,
            iterations: self.result.iterations,
            converged: self.converged(),
            entry_points_sd_m: vec![[None; 3]; self.result.entry_points_m.len()],
            ..self.poses.document()
        }
    }
}
