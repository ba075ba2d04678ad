//! A laser distance read and typed by the operator.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::source::{LONGEST_M, LaserReading, LaserSource};
use crate::error::LinkError;

/// A laser whose distance is typed by the operator; clones share it.
///
/// A value belongs to the pose for which it was requested; it is discarded when the platform is sent elsewhere.
#[derive(Debug, Clone, Default)]
pub struct ManualLaser {
    asked: Arc<Mutex<Option<Asked>>>,
}

/// A pending request.
#[derive(Debug, Clone, Copy)]
struct Asked {
    label: i64,
    answer: Option<LaserReading>,
}

impl ManualLaser {
    fn asked(&self) -> MutexGuard<'_, Option<Asked>> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Requests the distance at the pose with this label, where the platform is at rest now.
    pub fn ask(&self, label: i64) {
        *self.asked() = Some(Asked {
            label,
            answer: None,
        });
    }

    /// Label of the pose whose distance is pending.
    #[must_use]
    pub fn wanted(&self) -> Option<i64> {
        let asked = self.asked().filter(|asked| asked.answer.is_none());
        asked.map(|asked| asked.label)
    }

    /// Whether the distance at the pose with this label was typed.
    #[must_use]
    pub fn is_answered(&self, label: i64) -> bool {
        let asked = self.asked().filter(|asked| asked.label == label);
        asked.is_some_and(|asked| asked.answer.is_some())
    }

    /// Sets the distance (m) at the pose with this label; `None`: the sensor has no return. A second value at the same pose
    /// replaces the first.
    ///
    /// # Errors
    /// If it is not a possible distance, or no longer requested.
    pub fn answer(&self, label: i64, distance_m: Option<f64>) -> Result<(), LinkError> {
        if let Some(typed) = distance_m.filter(|typed| !(0.0..=LONGEST_M).contains(typed)) {
            return Err(LinkError::Laser(format!(
                "{} mm is not a possible distance, expected 0 mm to {:.0} mm",
                typed * 1e3,
                LONGEST_M * 1e3
            )));
        }
        match self.asked().as_mut().filter(|asked| asked.label == label) {
            Some(asked) => {
                asked.answer = Some(LaserReading {
                    age_s: 0.0,
                    distance_m,
                });
                Ok(())
            }
            None => Err(LinkError::Laser(format!(
                "the distance at pose {label} is no longer requested, as the platform has left it"
            ))),
        }
    }
}

impl LaserSource for ManualLaser {
    fn identity(&self) -> String {
        "Laser distance typed by the operator".to_owned()
    }

    fn connect(&mut self) -> Result<(), LinkError> {
        self.discard_reading();
        Ok(())
    }

    fn disconnect(&mut self) {
        self.discard_reading();
    }

    fn latest(&self) -> Option<LaserReading> {
        self.asked().as_ref()?.answer
    }

    /// A typed value does not age; it is discarded when the platform leaves.
    fn max_age_s(&self) -> f64 {
        f64::INFINITY
    }

    fn discard_reading(&mut self) {
        *self.asked() = None;
    }

    fn problem(&self) -> Option<String> {
        let missing = self.latest().is_none();
        missing.then(|| "no distance was typed".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_belongs_to_the_pose_at_which_it_was_asked_for() {
        let mut laser = ManualLaser::default();
        let window = laser.clone();
        assert!(window.answer(3, Some(0.5)).is_err());
        laser.ask(3);
        assert_eq!(window.wanted(), Some(3));
        assert!(window.answer(2, Some(0.5)).is_err());
        for wrong in [f64::NAN, f64::INFINITY, -0.1, 1e6] {
            let told = window.answer(3, Some(wrong)).unwrap_err().to_string();
            assert!(told.contains("is not a possible distance"), "{told}");
        }
        assert_eq!((laser.distance_m(), laser.is_answered(3)), (None, false));
        window.answer(3, Some(0.5)).unwrap();
        assert_eq!(
            (laser.distance_m(), laser.is_answered(3)),
            (Some(0.5), true)
        );
        assert_eq!(window.wanted(), None);
        window.answer(3, None).unwrap();
        assert_eq!((laser.distance_m(), laser.is_answered(3)), (None, true));
        laser.discard_reading();
        assert!(!laser.is_answered(3) && window.answer(3, Some(0.5)).is_err());
        assert!(laser.problem().is_some());
    }
}
