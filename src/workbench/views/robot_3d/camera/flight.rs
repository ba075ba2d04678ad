//! Animated transition of the camera between two views.

use std::f64::consts::{PI, TAU};

use super::{Camera, Projection};

/// Duration of a transition (s).
const DURATION_S: f64 = 0.4;

/// Transition in progress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flight {
    from: Camera,
    to: Camera,
    began_s: f64,
}

impl Flight {
    /// Transition that begins at a time of the window (s).
    #[must_use]
    pub fn new(from: Camera, to: Camera, now_s: f64) -> Self {
        Self {
            from,
            to,
            began_s: now_s,
        }
    }

    /// Target of the transition.
    #[must_use]
    pub fn end(&self) -> &Camera {
        &self.to
    }

    /// Camera at a time of the window (s), and whether the transition has ended.
    #[must_use]
    pub fn at(&self, now_s: f64) -> (Camera, bool) {
        let time = ((now_s - self.began_s) / DURATION_S).clamp(0.0, 1.0);
        if time >= 1.0 {
            return (self.to, true);
        }
        // Ease in and out.
        let share = time * time * (3.0 - 2.0 * time);
        let (from, to) = (&self.from, &self.to);
        // Shorter direction of rotation.
        let turn = (to.yaw - from.yaw + PI).rem_euclid(TAU) - PI;
        let between = |a: f64, b: f64| a + share * (b - a);
        let camera = Camera {
            target: from.target.lerp(&to.target, share),
            yaw: (from.yaw + share * turn).rem_euclid(TAU),
            pitch: between(from.pitch, to.pitch),
            // The magnification changes exponentially.
            distance_m: between(from.distance_m.ln(), to.distance_m.ln()).exp(),
            projection: match from.projection == to.projection {
                true => to.projection,
                false => Projection::Perspective,
            },
            ..*to
        };
        (camera, false)
    }
}
