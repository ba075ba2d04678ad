//! Options of the 3D view.

use std::collections::BTreeSet;

use tautline_core::geometry::Vec3;

use crate::views::robot_3d::scene::Scene;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum CableColour {
    /// A colour for each cable.
    #[default]
    Own,
    Tension,
    /// By the residual of the cable's length.
    Residual,
}

impl CableColour {
    pub const ALL: [Self; 3] = [Self::Own, Self::Tension, Self::Residual];

    /// Label in the window.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Own => "Cable",
            Self::Tension => "Tension",
            Self::Residual => "Residual",
        }
    }
}
/// Colouring of displacements.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ArrowColour {
    /// By significance.
    #[default]
    Significance,
    /// By length.
    Length,
    /// By conformity with the tolerance of the certificate.
    Tolerance,
}

impl ArrowColour {
    pub const ALL: [Self; 3] = [Self::Significance, Self::Length, Self::Tolerance];

    /// Label in the window.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Significance => "Significance",
            Self::Length => "Length",
            Self::Tolerance => "Tolerance",
        }
    }
}

/// Appearance of the frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum FrameLook {
    #[default]
    Solid,
    Transparent,
    Hidden,
}

impl FrameLook {
    pub const ALL: [Self; 3] = [Self::Solid, Self::Transparent, Self::Hidden];

    /// Label in the window.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Solid => "Solid",
            Self::Transparent => "Transparent",
            Self::Hidden => "Hidden",
        }
    }
}

/// Options of the 3D view.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    pub colour: CableColour,
    /// Colouring of displacements.
    pub arrow_colour: ArrowColour,
    /// Exaggeration factor of displacements and ellipsoids; by default chosen for the scene.
    pub exaggeration: Option<f64>,
    /// Appearance of the frame.
    pub frame: FrameLook,
    /// Whether the second set of pulleys is shown, of the drawing or another session.
    pub nominal: bool,
    /// Whether displacements are shown.
    pub arrows: bool,
    /// Whether 95 % ellipsoids of the pulleys are shown.
    pub ellipsoids: bool,
    /// Whether errors of position before and after the adjustment are shown, in the phase that measures them.
    pub errors: bool,
    /// Whether measured and planned poses are shown.
    pub poses: bool,
    /// Whether cable numbers are shown.
    pub labels: bool,
    /// Whether pinned coordinates are shown.
    pub callouts: bool,
    /// Pulleys with pinned coordinates, by the index of their cable.
    pub pinned: BTreeSet<usize>,
    /// Inspected pulley, by the index of its cable: it is drawn true to scale, everything else fades.
    pub inspected: Option<usize>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            colour: CableColour::Own,
            arrow_colour: ArrowColour::default(),
            exaggeration: None,
            frame: FrameLook::default(),
            nominal: true,
            arrows: true,
            ellipsoids: true,
            errors: true,
            poses: true,
            labels: true,
            callouts: true,
            pinned: BTreeSet::new(),
            inspected: None,
        }
    }
}

impl Options {
    /// Pins the coordinates of a pulley, or unpins them.
    pub fn pin(&mut self, cable: usize) {
        if !self.pinned.remove(&cable) {
            self.pinned.insert(cable);
            self.callouts = true;
        }
    }

    /// Colouring of the displacements of a scene; without a tolerance not by conformity.
    #[must_use]
    pub fn arrow_colour_of(&self, scene: &Scene) -> ArrowColour {
        match (self.arrow_colour, scene.tolerance_m) {
            (ArrowColour::Tolerance, None) => ArrowColour::default(),
            (colour, _) => colour,
        }
    }

    /// Exaggeration factor of displacements and ellipsoids of a scene.
    #[must_use]
    pub fn exaggeration_of(&self, scene: &Scene) -> f64 {
        if self.inspected.is_some() {
            return 1.0;
        }
        self.exaggeration
            .unwrap_or_else(|| scene.fitting_exaggeration())
    }

    /// Ends of the displacements of a scene and points of its pulleys' paths, as drawn (m).
    #[must_use]
    pub fn tips(&self, scene: &Scene) -> Vec<Vec3> {
        let exaggeration = self.exaggeration_of(scene);
        let moved = scene.cables.iter().filter_map(|cable| cable.moved.as_ref());
        let tips = moved.map(|moved| moved.from + moved.by * exaggeration);
        let cables = 0..scene.cables.len();
        let paths = cables.flat_map(|cable| scene.path_of(cable, exaggeration));
        tips.chain(paths).collect()
    }

    /// Whether a cable with its pulley fades: if another one is inspected, or if it did not move while others did.
    #[must_use]
    pub fn fades(&self, scene: &Scene, cable: usize) -> bool {
        match self.inspected {
            Some(inspected) => inspected != cable,
            None => scene.is_unmoved_beside_others(cable),
        }
    }
}
