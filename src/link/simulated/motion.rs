//! The motion of the platform from one rest to the next.

use tautline_core::geometry::Pose;

use super::readings::ReadingRow;

/// After arrival the platform oscillates along its path: amplitude (m), frequency (Hz), decay time (s).
const SWING_M: f64 = 3e-4;
const SWING_HZ: f64 = 6.0;
const SWING_DECAY_S: f64 = 0.12;
/// Peak velocity and acceleration of the smooth profile `10 p^3 - 15 p^4 + 6 p^5`, per length and duration.
const PEAK_VELOCITY: f64 = 1.875;
const PEAK_ACCELERATION: f64 = 5.773_502_7;
/// Shortest motion (s).
const SHORTEST_S: f64 = 0.05;
/// Time (s) beyond the second of its two instants for which drift is followed at rest.
const FOLLOWED_S: f64 = 60.0;

/// A point of the path: true pose and exact readings.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PathPoint {
    pub pose: Pose,
    pub row: ReadingRow,
}

impl PathPoint {
    /// Interpolates towards another point; extrapolates for fractions above 1.
    fn toward(&self, other: &Self, part: f64) -> Self {
        let mix = |(from, to): (&f64, &f64)| from + part * (to - from);
        Self {
            pose: self
                .pose
                .perturbed(&(other.pose.difference(&self.pose) * part)),
            row: self.row.iter().zip(&other.row).map(mix).collect(),
        }
    }
}

/// A motion and the rest after it.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub start_s: f64,
    pub duration_s: f64,
    /// Points at equal fractions of the path, at least one, connected linearly.
    pub places: Vec<PathPoint>,
    /// The last point some time (s) after arrival, for drifting readings.
    pub later: Option<(f64, PathPoint)>,
    /// Amplitude of the oscillation, as a fraction of the path.
    swing: f64,
}

/// Limits of the motion profile.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    pub velocity_m_s: f64,
    pub turning_rad_s: f64,
    pub acceleration_m_s2: f64,
}

impl Pace {
    /// Duration of a motion (s).
    pub fn duration_s(&self, from: &Pose, to: &Pose) -> f64 {
        let twist = to.difference(from);
        let way = twist.fixed_rows::<3>(0).norm();
        let turn = twist.fixed_rows::<3>(3).norm();
        let by_velocity = PEAK_VELOCITY * way / self.velocity_m_s;
        let by_turning = PEAK_VELOCITY * turn / self.turning_rad_s;
        let by_acceleration = (PEAK_ACCELERATION * way / self.acceleration_m_s2).sqrt();
        by_velocity
            .max(by_turning)
            .max(by_acceleration)
            .max(SHORTEST_S)
    }
}

impl Motion {
    /// A platform that has always been at rest.
    pub fn resting(place: PathPoint, now_s: f64) -> Self {
        Self {
            start_s: now_s,
            duration_s: 0.0,
            places: vec![place],
            later: None,
            swing: 0.0,
        }
    }

    /// A motion along points; `docks` if the platform is held at the end and cannot oscillate.
    pub fn along(places: Vec<PathPoint>, (start_s, duration_s): (f64, f64), docks: bool) -> Self {
        let ends = places.first().zip(places.last());
        let way = ends.map_or(0.0, |(a, b)| (b.pose.position - a.pose.position).norm());
        let swings = !docks && way > SWING_M;
        Self {
            start_s,
            duration_s,
            places,
            later: None,
            swing: if swings { SWING_M / way } else { 0.0 },
        }
    }

    /// Whether the drives are moving.
    pub fn is_moving(&self, now_s: f64) -> bool {
        now_s < self.start_s + self.duration_s
    }

    /// Pose and exact readings at a time.
    pub fn at(&self, now_s: f64) -> PathPoint {
        let since = now_s - self.start_s;
        let rested = since - self.duration_s;
        if rested < 0.0 {
            return self.on_way(profile(since / self.duration_s));
        }
        let swing = (std::f64::consts::TAU * SWING_HZ * rested).sin();
        let part = 1.0 + self.swing * swing * (-rested / SWING_DECAY_S).exp();
        let mut place = self.on_way(part);
        if let (Some((after_s, later)), Some(last)) = (&self.later, self.places.last()) {
            let elapsed = rested.min(after_s + FOLLOWED_S) / after_s;
            let drifted = last.toward(later, elapsed);
            place.pose = place.pose.perturbed(&drifted.pose.difference(&last.pose));
            for (k, value) in place.row.iter_mut().enumerate() {
                *value += drifted.row[k] - last.row[k];
            }
        }
        place
    }

    fn on_way(&self, part: f64) -> PathPoint {
        let pieces = self.places.len() - 1;
        if pieces == 0 {
            return self.places[0].clone();
        }
        let along = part.max(0.0) * pieces as f64;
        let piece = (along as usize).min(pieces - 1);
        self.places[piece].toward(&self.places[piece + 1], along - piece as f64)
    }
}

/// Fraction of the path at a fraction of the time, with continuous velocity and acceleration at the ends.
fn profile(part: f64) -> f64 {
    let p = part.clamp(0.0, 1.0);
    p * p * p * (10.0 - 15.0 * p + 6.0 * p * p)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(x: f64) -> PathPoint {
        PathPoint {
            pose: Pose::from_parts([x, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
            row: vec![2.0 * x, f64::NAN],
        }
    }

    #[test]
    fn keeps_velocity_and_acceleration_and_comes_to_rest() {
        let pace = Pace {
            velocity_m_s: 0.2,
            turning_rad_s: 1.0,
            acceleration_m_s2: 0.5,
        };
        for way in [0.01, 0.1, 1.0] {
            let duration = pace.duration_s(&place(0.0).pose, &place(way).pose);
            let motion = Motion::along(vec![place(0.0), place(way)], (3.0, duration), false);
            let h = 1e-4 * duration;
            let x = |t: f64| motion.at(3.0 + t).pose.position.x;
            let (mut fastest, mut strongest) = (0.0_f64, 0.0_f64);
            for k in 1..1000 {
                let t = duration * f64::from(k) / 1000.0;
                fastest = fastest.max((x(t + h) - x(t - h)) / (2.0 * h));
                if t + h < duration {
                    strongest = strongest.max((x(t + h) - 2.0 * x(t) + x(t - h)) / (h * h));
                }
            }
            assert!(
                fastest < 0.2001 && strongest < 0.501,
                "{fastest} {strongest}"
            );
            assert!(fastest > 0.199 || strongest > 0.49);
            assert!((x(duration + 0.04) - way).abs() > 1e-4);
            assert!((x(duration + 1.5) - way).abs() < 1e-8);
            assert!((motion.at(9.0).row[0] - 2.0 * x(6.0)).abs() < 1e-6);
        }
    }

    #[test]
    fn drift_goes_on_at_rest() {
        let mut motion = Motion::resting(place(0.0), 0.0);
        motion.later = Some((10.0, place(1e-4)));
        assert!((motion.at(20.0).row[0] - 4e-4).abs() < 1e-12);
        assert!((motion.at(20.0).pose.position.x - 2e-4).abs() < 1e-12);
        assert_eq!(motion.at(70.0).row[0], motion.at(5000.0).row[0]);
    }
}
