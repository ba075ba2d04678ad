//! A second session shown beside the first.

use tautline_core::comparison::Comparison;

use super::{Besides, Displacement, Scene, Wheel};

impl Scene {
    /// Adds the second geometry of a comparison to a scene of the first. The common motion is taken
    /// out: the home pose of the first session holds for both. Poses are left out, each session has its own.
    #[must_use]
    pub fn compared(mut self, compared: &Comparison) -> Self {
        self.besides = Besides::Other;
        self.measured = Default::default();
        for (cable, pulley) in self.cables.iter_mut().zip(&compared.pulleys) {
            let difference = pulley.relative.unwrap_or(pulley.raw);
            let by = difference.vector_m;
            cable.nominal = Some(Wheel {
                entry: cable.wheel.entry + by,
                centre: cable.wheel.centre + by,
                ..cable.wheel
            });
            cable.moved = Some(Displacement {
                from: cable.wheel.entry,
                by,
                covariance: Some(difference.covariance),
                is_explained: true,
                moved: pulley.test.map(|_| pulley.moved),
            });
        }
        self
    }
}
