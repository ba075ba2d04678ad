//! A smooth motion through a workspace.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::workspace::Workspace;
use crate::geometry::{Freedom, Pose, Twist};

/// Duration of the ramp at the start (s).
const RAMP_S: f64 = 3.0;
/// Fractions of the range taken by the waves of one coordinate.
const SHARES: [f64; 3] = [0.5, 0.3, 0.2];
/// Slowest and fastest wave (Hz).
const FREQUENCIES_HZ: [f64; 2] = [0.03, 0.3];
/// Highest speed along a coordinate (m/s).
const FASTEST_M_S: f64 = 0.4;
/// Step of the differences that give velocity and acceleration (s).
const STEP_S: f64 = 1e-3;

/// Sum of sine waves in each coordinate about a pose where the platform rests at first.
#[derive(Debug, Clone)]
pub(super) struct Trajectory {
    /// Amplitude (m, rad) and angular frequency (rad/s) of the waves of each coordinate.
    waves: [[(f64, f64); 3]; 6],
}

impl Trajectory {
    /// Draws a motion through a workspace.
    pub fn draw(workspace: &Workspace, freedom: Freedom, rng: &mut ChaCha8Rng) -> Self {
        let mut waves = [[(0.0, 0.0); 3]; 6];
        for coordinate in freedom.coordinates() {
            let k = coordinate.index();
            let half = workspace.half_range(k);
            for (wave, share) in waves[k].iter_mut().zip(SHARES) {
                let [slowest, fastest] = FREQUENCIES_HZ;
                let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
                *wave = (
                    sign * share * half,
                    TAU * rng.random_range(slowest..fastest),
                );
            }
            let speed: f64 = waves[k].iter().map(|(a, w)| a.abs() * w).sum();
            if k < 3 && speed > FASTEST_M_S {
                waves[k]
                    .iter_mut()
                    .for_each(|wave| wave.1 *= FASTEST_M_S / speed);
            }
        }
        Self { waves }
    }

    /// The same motion with smaller amplitudes.
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled = |(amplitude, w): (f64, f64)| (factor * amplitude, w);
        Self {
            waves: self.waves.map(|waves| waves.map(scaled)),
        }
    }

    /// Pose at a time (s) of a motion from `start`.
    pub fn pose(&self, start: &Pose, time_s: f64) -> Pose {
        let u = (time_s / RAMP_S).clamp(0.0, 1.0);
        // The platform rests at the start: the first three derivatives vanish there.
        let ramp = u.powi(4) * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u)));
        let displacement = self.waves.map(|waves| {
            let sum: f64 = waves.iter().map(|(a, w)| a * (w * time_s).sin()).sum();
            ramp * sum
        });
        start.perturbed(&Twist::from(displacement))
    }

    /// Velocity and acceleration at a time, by central differences (m, rad, s; base frame).
    pub fn twists(&self, start: &Pose, time_s: f64) -> [Twist; 2] {
        let here = self.pose(start, time_s);
        let [before, after] =
            [-STEP_S, STEP_S].map(|h| self.pose(start, time_s + h).difference(&here));
        [
            (after - before) / (2.0 * STEP_S),
            (after + before) / (STEP_S * STEP_S),
        ]
    }
}
