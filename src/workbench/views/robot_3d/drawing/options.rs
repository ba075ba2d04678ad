//! What is drawn, and how.

use std::collections::BTreeSet;

use tautline_core::geometry::Vec3;

use crate::views::robot_3d::scene::Scene;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum CableColour {
    /// Every cable has its own.
    #[default]
    Own,
    Tension,
    /// By the residual of its length.
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
/// By what displacements are coloured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ArrowColour {
    /// By whether they exceed their uncertainty.
    #[default]
    Significance,
    /// By how long they are.
    Length,
    /// By whether they are within the tolerance of the certificate.
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

/// How the frame is drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum FrameLook {
    /// Its members hide what is behind them.
    #[default]
    Solid,
    /// What is behind them can be seen.
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

/// What is drawn and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    pub colour: CableColour,
    /// By what displacements are coloured.
    pub arrow_colour: ArrowColour,
    /// How many times larger than they are displacements and ellipsoids are drawn; by default as suits the scene.
    pub exaggeration: Option<f64>,
    /// How the frame is drawn.
    pub frame: FrameLook,
    /// Pulleys shown besides, of the drawing or another session.
    pub nominal: bool,
    /// How the two differ.
    pub arrows: bool,
    /// Where pulleys are with 95 % confidence.
    pub ellipsoids: bool,
    /// Errors of position before and after the adjustment, in the phase that measures them.
    pub errors: bool,
    /// Measured and planned poses.
    pub poses: bool,
    /// Numbers of the cables.
    pub labels: bool,
    /// Whether what is pinned is shown.
    pub callouts: bool,
    /// Pulleys, by the index of their cable, whose coordinates are written beside them.
    pub pinned: BTreeSet<usize>,
    /// The pulley, by the index of its cable, that is inspected: everything else fades, and it is drawn true to scale.
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
    /// Pins the coordinates of a pulley, or takes them away.
    pub fn pin(&mut self, cable: usize) {
        if !self.pinned.remove(&cable) {
            self.pinned.insert(cable);
            self.callouts = true;
        }
    }

    /// By what displacements of a scene are coloured: without a tolerance not by it.
    #[must_use]
    pub fn arrow_colour_of(&self, scene: &Scene) -> ArrowColour {
        match (self.arrow_colour, scene.tolerance_m) {
            (ArrowColour::Tolerance, None) => ArrowColour::default(),
            (colour, _) => colour,
        }
    }

    /// How many times larger than they are displacements and ellipsoids of a scene are drawn.
    #[must_use]
    pub fn exaggeration_of(&self, scene: &Scene) -> f64 {
        if self.inspected.is_some() {
            return 1.0;
        }
        self.exaggeration
            .unwrap_or_else(|| scene.fitting_exaggeration())
    }

    /// Where the displacements of a scene end and the paths of its pulleys are as they are drawn (m).
    #[must_use]
    pub fn tips(&self, scene: &Scene) -> Vec<Vec3> {
        let exaggeration = self.exaggeration_of(scene);
        let moved = scene.cables.iter().filter_map(|cable| cable.moved.as_ref());
        let tips = moved.map(|moved| moved.from + moved.by * exaggeration);
        let cables = 0..scene.cables.len();
        let paths = cables.flat_map(|cable| scene.path_of(cable, exaggeration));
        tips.chain(paths).collect()
    }

    /// Whether a cable with its pulley steps back behind others: those that are not inspected, or that did not move where
    /// others did.
    #[must_use]
    pub fn fades(&self, scene: &Scene, cable: usize) -> bool {
        match self.inspected {
            Some(inspected) => inspected != cable,
            None => scene.is_unmoved_beside_others(cable),
        }
    }
}
