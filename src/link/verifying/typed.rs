//! Poses that an operator reads from an instrument and types.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tautline_session::CheckPose;

use crate::controller::Instrument;
use crate::error::LinkError;

/// An instrument whose readings are typed by the operator; clones share them.
///
/// A reading belongs to the target for which it was requested.
#[derive(Debug, Clone, Default)]
pub struct TypedInstrument {
    asked: Arc<Mutex<Option<Asked>>>,
}

/// A pending request.
#[derive(Debug)]
struct Asked {
    number: usize,
    answer: Option<CheckPose>,
}

impl TypedInstrument {
    fn asked(&self) -> MutexGuard<'_, Option<Asked>> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Requests the pose at a target of the run, by its number.
    pub fn ask(&self, number: usize) {
        *self.asked() = Some(Asked {
            number,
            answer: None,
        });
    }

    /// Whether a request is pending.
    #[must_use]
    pub fn waits(&self) -> bool {
        let asked = self.asked();
        asked.as_ref().is_some_and(|asked| asked.answer.is_none())
    }

    /// Sets the pose at the target with this number.
    ///
    /// # Errors
    /// If a number is not finite, or the target is not requested.
    pub fn answer(&self, number: usize, pose: CheckPose) -> Result<(), LinkError> {
        let mut numbers = pose.position_m.iter();
        let orientation = pose.orientation_wxyz.iter().flatten();
        if !numbers.all(|n| n.is_finite()) || !orientation.clone().all(|n| n.is_finite()) {
            let text = "the typed pose contains an invalid number";
            return Err(LinkError::Setup(text.to_owned()));
        }
        match self.asked().as_mut().filter(|a| a.number == number) {
            Some(asked) => {
                asked.answer = Some(pose);
                Ok(())
            }
            None => {
                let text = "the pose at this target is no longer requested";
                Err(LinkError::Setup(text.to_owned()))
            }
        }
    }
}

impl Instrument for TypedInstrument {
    fn identity(&self) -> String {
        "Poses typed by the operator".to_owned()
    }

    /// The typed pose, only once.
    fn measure(&mut self) -> Result<CheckPose, LinkError> {
        let asked = self.asked().take();
        let missing = || LinkError::Setup("no pose was typed".to_owned());
        asked.and_then(|asked| asked.answer).ok_or_else(missing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_typed_pose_belongs_to_its_target_and_is_used_once() {
        let mut instrument = TypedInstrument::default();
        let window = instrument.clone();
        let pose = |x_m| CheckPose {
            position_m: [x_m, 0.0, 0.0],
            orientation_wxyz: None,
        };
        assert!(!window.waits() && window.answer(1, pose(0.5)).is_err());
        instrument.ask(1);
        assert!(window.waits() && instrument.measure().is_err());
        instrument.ask(2);
        assert!(window.answer(1, pose(0.5)).is_err());
        assert!(window.answer(2, pose(f64::NAN)).is_err());
        window.answer(2, pose(0.5)).unwrap();
        assert!(!window.waits());
        assert_eq!(instrument.measure().unwrap().position_m[0], 0.5);
        assert!(instrument.measure().is_err());
    }
}
