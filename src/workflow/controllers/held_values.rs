//! Values of a simulated controller that survive the program, like those of a real one.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_link::{LinkError, ParameterInfo};
use tautline_session::{NamedValue, ReadError, VersionedFile, read_versioned, write_versioned};

/// Values of a simulated controller while they are written to it; before and afterwards they are in the session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct HeldValues {
    /// All its parameters.
    values: Vec<NamedValue>,
}

impl VersionedFile for HeldValues {
    const FORMAT: &'static str = "tautline-controller";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
}

/// The path of what belongs to a session file and lies beside it: its name with an ending.
#[must_use]
pub fn beside(session: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(session);
    name.push(ending);
    name.into()
}

/// The values of a simulated controller, if the program was killed while they were written.
///
/// # Errors
/// If the file cannot be read.
pub fn held_values(path: &Path) -> Result<Option<Vec<NamedValue>>, ReadError> {
    if !path.exists() {
        return Ok(None);
    }
    let read = read_versioned::<HeldValues>(path)?;
    Ok(Some(read.value.values))
}

/// Saves the values of a simulated controller to a file, for [`SimulatedRobot::saving`](tautline_link::simulated::SimulatedRobot::saving).
pub(super) fn save_to(path: PathBuf) -> impl FnMut(&[ParameterInfo]) -> Result<(), LinkError> {
    move |parameters| {
        let values = parameters.iter().map(|parameter| NamedValue {
            name: parameter.name.clone(),
            value: parameter.value,
        });
        let held = HeldValues {
            values: values.collect(),
        };
        let written = write_versioned(&path, &held);
        written.map_err(|error| LinkError::Refused(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use tautline_core::robot::presets;
    use tautline_link::simulated::{Fault, SimulatedRobot, SimulatedSetup};
    use tautline_link::{Controller, ManualClock};

    use super::*;

    #[test]
    fn values_are_in_the_file_as_far_as_they_were_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = beside(&folder.path().join("s.json"), ".controller");
        assert!(path.ends_with("s.json.controller"));
        assert_eq!(held_values(&path), Ok(None));
        let preset = presets::find("mini").expect("a preset");
        let setup = SimulatedSetup::of_preset(&preset, 1);
        let clock = Arc::new(ManualClock::default());
        let robot = SimulatedRobot::new(setup, clock).expect("a robot");
        let mut robot = robot.saving(save_to(path.clone()));
        robot.connect().expect("connected");
        robot.arm().expect("armed");
        let before = robot.parameters().expect("values");
        let differs = Fault::WriteDiffers {
            name: before[1].name.clone(),
            by: f64::NAN,
            times: 1,
        };
        robot.set_faults(vec![differs]);
        let values = before[..2].iter();
        let values: Vec<(String, f64)> = values.map(|p| (p.name.clone(), p.value + 1e-3)).collect();
        assert!(robot.write(&values).is_err());
        let held = held_values(&path).expect("readable").expect("a file");
        assert_eq!(held.len(), before.len());
        assert_eq!(held[0].value, before[0].value + 1e-3);
        assert_eq!(held[1].value, before[1].value);
    }
}
