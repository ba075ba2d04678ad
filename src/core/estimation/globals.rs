//! Values of the parameters common to all poses.

use crate::effect::BoundEffect;
use crate::geometry::Pose;
use crate::robot::Robot;

/// Values of all quantities common to all poses.
#[derive(Debug, Clone)]
pub struct Globals {
    /// Entry points, base frame (m).
    pub entry_points: Vec<[f64; 3]>,
    /// Offset of the laser's target plane (m).
    pub plane_offset_m: f64,
    /// Home pose.
    pub home: Pose,
    /// Error of the tension readings at home, per cable (N).
    pub home_tension_error_n: Vec<f64>,
    /// Effects, the held ones before the free ones.
    pub effects: Vec<BoundEffect>,
    /// Deviations of parts, the held ones before the estimated ones.
    pub deviations: Vec<BoundEffect>,
}

impl Globals {
    /// Everything that changes the prediction: the effects, then the deviations.
    pub(crate) fn acting(&self) -> impl Iterator<Item = &BoundEffect> + Clone {
        self.effects.iter().chain(&self.deviations)
    }

    /// Returns `robot` with these entry points, target plane, home pose, effects and deviations.
    #[must_use]
    pub fn model(&self, robot: &Robot) -> Robot {
        let mut model = robot.clone();
        for (cable, entry) in model.cables.iter_mut().zip(&self.entry_points) {
            cable.pulley.entry_point_m = *entry;
        }
        if let Some(laser) = &mut model.laser {
            laser.target_plane.offset_m = self.plane_offset_m;
        }
        if let Some(home) = &mut model.home {
            *home = home.at(&self.home);
        }
        let settings = |bound: &[BoundEffect]| bound.iter().map(|b| b.setting(robot)).collect();
        model.effects = settings(&self.effects);
        model.deviations = settings(&self.deviations);
        model
    }
}
