//! Second session beside the first.

use tautline_core::comparison::Comparison;

use super::{Displacement, Reference, Scene, SideNames, Wheel};

impl Scene {
    /// Adds the second geometry of a comparison to a scene of the first. The common motion is removed: the home pose of
    /// the first session applies to both.
    #[must_use]
    pub fn compared(self, compared: &Comparison) -> Self {
        let names = SideNames {
            first: "A",
            second: "B",
        };
        let differences = compared.pulleys.iter().map(|pulley| {
            let difference = pulley.relative.unwrap_or(pulley.raw);
            Displacement {
                from: Default::default(),
                by: difference.vector_m,
                covariance: Some(difference.covariance),
                is_explained: true,
                moved: pulley.test.map(|_| pulley.moved),
            }
        });
        self.beside(names, differences)
    }

    /// Adds the pulleys of another session to a scene, by their displacements in the order of the cables. Poses are
    /// omitted, because each session has its own.
    #[must_use]
    pub fn beside(
        mut self,
        names: SideNames,
        displacements: impl IntoIterator<Item = Displacement>,
    ) -> Self {
        self.reference = Reference::Other(names);
        self.measured = Default::default();
        for (cable, displacement) in self.cables.iter_mut().zip(displacements) {
            let by = displacement.by;
            cable.nominal = Some(Wheel {
                entry: cable.wheel.entry + by,
                centre: cable.wheel.centre + by,
                ..cable.wheel
            });
            cable.moved = Some(Displacement {
                from: cable.wheel.entry,
                ..displacement
            });
        }
        self
    }
}
