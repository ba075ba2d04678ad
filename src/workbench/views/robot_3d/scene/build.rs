//! Construction of a scene from robot, measurements and identification.

use std::collections::HashMap;
use std::sync::Arc;

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;
use tautline_session::DecisionRule;

use super::residuals::Residuals;
use super::{
    CableView, Displacement, FrameBox, MeasuredPose, MeasuredPoses, PlatformBox, PositionError,
    Reference, Scene, ShownPose, cable, platform,
};
use crate::model::Selection;
use crate::model::link::LivePlatform;
use crate::views::robot_3d::camera;
use tautline_workflow::identification::{FitVerdict, Identification, entry_point_covariance};
use tautline_workflow::wording::cable_label;

/// Inputs of a scene.
#[derive(Debug, Clone, Copy)]
pub struct SceneInputs<'a> {
    /// Robot of the drawings.
    pub robot: &'a Robot,
    pub measurements: &'a Measurements,
    /// Identification, if any.
    pub fit: Option<&'a Identification>,
    /// Shown pose, and the cable whose residuals colour the poses.
    pub selection: Selection,
    /// Live platform; takes precedence over the selected pose.
    pub live: Option<&'a LivePlatform>,
    /// Positions of the poses still to be measured (m).
    pub planned: &'a [Vec3],
    /// Errors of position of the platform.
    pub errors: &'a [PositionError],
}

impl<'a> SceneInputs<'a> {
    /// Robot alone, at home.
    #[must_use]
    pub fn new(robot: &'a Robot, measurements: &'a Measurements) -> Self {
        Self {
            robot,
            measurements,
            fit: None,
            selection: Selection::default(),
            live: None,
            planned: &[],
            errors: &[],
        }
    }

    fn model(&self) -> &'a Robot {
        self.fit.map_or(self.robot, |fit| &fit.model)
    }

    #[must_use]
    pub fn scene(&self) -> Scene {
        self.scene_with(None)
    }

    /// Builds the scene with known measured poses, so that no identification is searched while the platform moves.
    #[must_use]
    pub fn scene_with(&self, measured: Option<Arc<MeasuredPoses>>) -> Scene {
        let robot = self.robot;
        let directions = camera::directions(robot.gravity());
        let frame = FrameBox::of(robot, &directions);
        let is_needed = self.live.is_none() || measured.is_none();
        let fit = self.fit.filter(|_| is_needed);
        let fitted = fit.map(fitted_poses).unwrap_or_default();
        let residuals = fit.map(Residuals::of).unwrap_or_default();
        let measured = measured
            .unwrap_or_else(|| Arc::new(MeasuredPoses::new(self.measured(&fitted, &residuals))));
        let (shown, pose) = self.shown(&fitted);
        Scene {
            directions,
            shown,
            pose,
            cables: self.cables(&pose, shown, &fitted, &residuals),
            platform: PlatformBox::of(robot, frame.size_m),
            laser: platform::laser(self.model(), &pose),
            home_beams: platform::home_beams(robot, &pose),
            measured,
            errors: self.errors.to_vec(),
            planned: self.planned.to_vec(),
            trail: self
                .live
                .map_or_else(Arc::default, |live| Arc::clone(&live.trail)),
            reference: self.fit.map_or(Reference::Nothing, |_| Reference::Drawing),
            paths: None,
            tolerance_m: None,
            decision_rule: DecisionRule::default(),
            frame,
        }
    }

    fn shown(&self, fitted: &Fitted) -> (ShownPose, Pose) {
        if let Some(live) = self.live {
            let shown = match live.is_stopped {
                true => ShownPose::Stopped,
                false => ShownPose::Live,
            };
            return (shown, live.pose);
        }
        if let Some(label) = self.selection.pose {
            if let Some((_, pose)) = fitted.get(&label) {
                return (ShownPose::Fitted(label), *pose);
            }
            let rows = &self.measurements.labels;
            let row = rows.iter().position(|l| *l == label);
            if let Some(pose) = row.and_then(|row| given_pose(self.measurements, row)) {
                return (ShownPose::Given(label), pose);
            }
        }
        let middle = || {
            let entries = self.robot.cables.iter();
            let sum: Vec3 = entries.map(|c| Vec3::from(c.pulley.entry_point_m)).sum();
            Pose {
                position: sum / self.robot.cable_count().max(1) as f64,
                ..Pose::identity()
            }
        };
        let home = self.model().home;
        (
            ShownPose::Home,
            home.map_or_else(middle, |home| home.pose()),
        )
    }

    fn tensions(&self, shown: ShownPose) -> Vec<Option<f64>> {
        let cables = self.robot.cable_count();
        if let (ShownPose::Live | ShownPose::Stopped, Some(live)) = (shown, self.live) {
            let at = |i: usize| live.tensions_n.get(i).copied().filter(|t| t.is_finite());
            return (0..cables).map(at).collect();
        }
        let label = match shown {
            ShownPose::Fitted(label) | ShownPose::Given(label) => label,
            ShownPose::Home | ShownPose::Live | ShownPose::Stopped => 0,
        };
        let row = self.measurements.labels.iter().position(|l| *l == label);
        let tension = |(index, cable): (usize, &tautline_core::robot::Cable)| {
            let reading = self.measurements.force_n.get(row?, index);
            let tension = cable.force_sensor?.tension_n(reading);
            tension.is_finite().then_some(tension)
        };
        self.robot.cables.iter().enumerate().map(tension).collect()
    }

    fn cables(
        &self,
        pose: &Pose,
        shown: ShownPose,
        fitted: &Fitted,
        residuals: &Residuals,
    ) -> Vec<CableView> {
        let model = self.model();
        let tensions = self.tensions(shown);
        let row = match shown {
            ShownPose::Fitted(label) => fitted.get(&label).map(|(row, _)| *row),
            _ => None,
        };
        let own = cable::located(model, pose, &tensions).into_iter();
        let nominal = self
            .fit
            .map(|_| cable::located(self.robot, pose, &tensions));
        let nominal_wheel = |index: usize| nominal.as_ref()?.get(index).map(|n| n.wheel);
        let cables = own.zip(&self.robot.cables).enumerate();
        cables
            .map(|(index, (own, drawn))| CableView {
                label: cable_label(index, &drawn.name),
                path: own.path,
                wheel: own.wheel,
                nominal: nominal_wheel(index),
                moved: self.fit.map(|fit| displacement(fit, index, drawn)),
                prior_sd_m: drawn.pulley.entry_point_sd_m.each(),
                free_m: own.free_m,
                tension_n: tensions[index],
                residual: residuals
                    .of_cable(index, row)
                    .filter(|_| row.is_some() || shown == ShownPose::Home),
            })
            .collect()
    }

    fn measured(&self, fitted: &Fitted, residuals: &Residuals) -> Vec<MeasuredPose> {
        let cable = self.selection.cable;
        let labels = self.measurements.labels.iter().enumerate();
        let pose = |(row, label): (usize, &i64)| match fitted.get(label) {
            Some((row, pose)) => Some(MeasuredPose {
                label: *label,
                position: pose.position,
                residual: residuals.of_pose(*row, cable),
            }),
            None => given_pose(self.measurements, row).map(|pose| MeasuredPose {
                label: *label,
                position: pose.position,
                residual: None,
            }),
        };
        labels.filter_map(pose).collect()
    }
}

/// Row in the data of the fit, and pose, by label.
type Fitted = HashMap<i64, (usize, Pose)>;

fn fitted_poses(fit: &Identification) -> Fitted {
    let labels = &fit.dataset.measurements.labels;
    let poses = fit.solution.poses.iter();
    let labelled = poses.filter_map(|(row, pose)| Some((*labels.get(*row)?, (*row, *pose))));
    labelled.collect()
}

/// Commanded or tracked pose of a row.
fn given_pose(data: &Measurements, row: usize) -> Option<Pose> {
    data.commanded.get(row).copied().flatten().or_else(|| {
        data.tracked_position_at(row).map(|position| Pose {
            position,
            ..Pose::identity()
        })
    })
}

fn displacement(
    fit: &Identification,
    index: usize,
    nominal: &tautline_core::robot::Cable,
) -> Displacement {
    let from = Vec3::from(nominal.pulley.entry_point_m);
    let entries = &fit.solution.globals.entry_points;
    let found = entries.get(index).map_or(from, |entry| Vec3::from(*entry));
    Displacement {
        from,
        by: found - from,
        covariance: entry_point_covariance(&fit.solution, index),
        is_explained: FitVerdict::of(fit.solution.p_value()).holds(),
        moved: None,
    }
}
