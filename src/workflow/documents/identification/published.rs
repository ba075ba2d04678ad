//! Identification as published (Jin et al. 2018), in a form that compares with the other methods.

use tautline_core::estimation::published::{
    PublishedError, PublishedOptions, PublishedResult, PublishedStop, identify_published,
};
use tautline_core::measurement::Dataset;

use super::Identification;

/// What the published method found.
#[derive(Debug, Clone)]
pub struct PublishedFit {
    /// Entry points and steps.
    pub result: PublishedResult,
    /// Time that it took (s).
    pub seconds: f64,
}

/// Identifies by the published method with the choices of the paper.
///
/// # Errors
/// If the dataset lacks what the method rests on.
pub fn fit_published(dataset: &Dataset) -> Result<PublishedResult, PublishedError> {
    identify_published(dataset, &PublishedOptions::for_robot(&dataset.robot))
}

impl PublishedFit {
    /// Whether it came to an end.
    #[must_use]
    pub fn converged(&self) -> bool {
        let ends = [PublishedStop::SmallStep, PublishedStop::SmallError];
        ends.contains(&self.result.stop)
    }

    /// `dataset` with the entry points found: fitting the poses alone to it tells residuals and chi-square.
    #[must_use]
    pub fn applied_to(&self, dataset: &Dataset) -> Dataset {
        let mut identified = dataset.clone();
        let cables = identified.robot.cables.iter_mut();
        for (cable, point) in cables.zip(&self.result.entry_points_m) {
            cable.pulley.entry_point_m = *point;
        }
        identified
    }

    /// The machine form of a fit of the poses alone, as that of this method, which gives no standard deviations.
    #[must_use]
    pub fn identification(&self, of_poses: Identification) -> Identification {
        Identification {
            method: "published".to_owned(),
            seconds: self.seconds,
            iterations: self.result.iterations,
            converged: self.converged(),
            entry_points_sd_m: vec![[None; 3]; self.result.entry_points_m.len()],
            ..of_poses
        }
    }
}
