//! Keys of the cached parts of the view, which are rebuilt only when their key changes.

use std::collections::HashSet;
use std::sync::Arc;

use egui::Theme;
use tautline_core::geometry::Vec3;
use tautline_session::Session;

use super::drawing::Options;
use super::scene::MeasuredPoses;
use crate::model::Selection;
use crate::model::link::LivePlatform;
use crate::model::plot_preparation::same;
use tautline_workflow::identification::Identification;

/// Inputs of a scene.
#[derive(Clone)]
pub struct SceneKey {
    /// Id and revision of the session.
    pub session: (u64, u64),
    pub fit: Option<Arc<Identification>>,
    pub selection: Selection,
    pub live: Option<LivePlatform>,
    /// Whether errors of position are shown.
    pub shows_errors: bool,
    /// Largest acceptable displacement of a pulley from the drawing (m).
    pub tolerance_m: Option<f64>,
}

/// Inputs of a drawing, besides its scene.
#[derive(Clone, PartialEq)]
pub struct DrawingKey {
    pub theme: Theme,
    pub options: Options,
    pub selection: Selection,
}

/// Inputs of the points of the poses.
#[derive(Clone)]
pub struct PosesKey {
    pub measured: Arc<MeasuredPoses>,
    pub planned: Vec<Vec3>,
    pub pose: Option<i64>,
    pub theme: Theme,
}

impl PartialEq for PosesKey {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.measured, &other.measured)
            && self.pose == other.pose
            && self.theme == other.theme
            && self.planned == other.planned
    }
}

impl SceneKey {
    /// Whether the drawn poses are the same; the platform may be elsewhere.
    pub fn has_poses_of(&self, other: &Self) -> bool {
        self.session == other.session
            && same(self.fit.as_ref(), other.fit.as_ref())
            && self.selection.cable == other.selection.cable
            && self.shows_errors == other.shows_errors
    }

    pub fn is_same(&self, other: &Self) -> bool {
        self.has_poses_of(other)
            && self.selection == other.selection
            && self.live == other.live
            && self.tolerance_m == other.tolerance_m
    }
}

/// Positions of the poses still to be measured (m).
pub fn planned(session: &Session) -> Vec<Vec3> {
    let measured: HashSet<i64> = session.measurements.labels.iter().copied().collect();
    let planned = session.plan.iter();
    let planned = planned.filter(|pose| !measured.contains(&pose.label));
    planned.map(|pose| pose.pose().position).collect()
}
