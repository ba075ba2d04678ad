//! An external instrument whose readings are typed at the terminal.

use std::sync::{Arc, Mutex, PoisonError};

use tautline_link::{Instrument, LinkError};
use tautline_session::CheckPose;

use crate::live::typed;

/// Name of the current target, and whether its readings were not typed.
#[derive(Debug, Clone, Default)]
pub struct Target(Arc<Mutex<(String, bool)>>);

impl Target {
    /// Sets the target of the next readings.
    pub fn set(&self, name: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).0 = name;
    }

    /// Whether the operator typed no readings at the last target.
    pub fn is_missed(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).1
    }

    fn get(&self) -> String {
        let target = self.0.lock();
        target.unwrap_or_else(PoisonError::into_inner).0.clone()
    }

    fn miss(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).1 = true;
    }
}

/// Asks for the position of the platform and reads `x y z` in millimetres from standard input.
pub struct TypedInstrument(pub Target);

impl Instrument for TypedInstrument {
    fn identity(&self) -> String {
        "Typed readings".to_owned()
    }

    fn measure(&mut self) -> Result<CheckPose, LinkError> {
        let question = format!("{}: x y z [mm]?", self.0.get());
        let expected = "three numbers: x y z in mm";
        if let Some(position_m) = typed::answer(&question, expected, position_m) {
            return Ok(CheckPose {
                position_m,
                orientation_wxyz: None,
            });
        }
        self.0.miss();
        let text = format!(
            "no reading was typed for {}: this verification is discarded",
            self.0.get()
        );
        Err(LinkError::Setup(text))
    }
}

/// Parses three numbers in millimetres, separated by spaces, semicolons or tabs.
fn position_m(line: &str) -> Option<[f64; 3]> {
    Some(typed::numbers(line)?.map(|number| number * 1e-3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_numbers_are_a_position() {
        assert_eq!(position_m("1 -2.5\t3e1\n"), Some([1e-3, -2.5e-3, 0.03]));
        assert_eq!(position_m(" 0;1;2 "), Some([0.0, 1e-3, 2e-3]));
        for text in ["", "1 2", "1 2 3 4", "1 2 x", "1 2 nan", "1,5 2 3"] {
            assert_eq!(position_m(text), None, "{text}");
        }
    }
}
