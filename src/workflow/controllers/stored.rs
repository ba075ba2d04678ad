//! A simulated controller whose values persist when the program ends, like those of a real one.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::geometry::Pose;
use tautline_files::ReadError;
use tautline_link::{Controller, ControllerState, LinkError, ParameterInfo, Sample};
use tautline_session::{NamedValue, VersionedFile, read_versioned, write_versioned};

/// Values of a simulated controller while they are being written; before and afterwards they are in the session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct HeldValues {
    /// All parameters of the controller.
    values: Vec<NamedValue>,
}

impl VersionedFile for HeldValues {
    const FORMAT: &'static str = "tautline-controller";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
}

/// Path of a file beside a session file: the name of the session file plus an ending.
#[must_use]
pub fn beside(session: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(session);
    name.push(ending);
    name.into()
}

/// The values of a simulated controller, if the program was killed while writing them.
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

/// Whether a path is a plain file with the values of a simulated controller.
#[must_use]
pub fn is_held_values(path: &Path) -> bool {
    let found = std::fs::symlink_metadata(path);
    found.is_ok_and(|found| found.is_file()) && read_versioned::<HeldValues>(path).is_ok()
}

/// A controller that saves its values to a file, one by one as they are written.
pub(super) struct Stored<C> {
    pub inner: C,
    pub path: PathBuf,
}

impl<C: Controller> Stored<C> {
    fn store(&mut self) -> Result<(), LinkError> {
        let values = self.inner.parameters()?.into_iter();
        let held = HeldValues {
            values: values
                .map(|parameter| NamedValue {
                    name: parameter.name,
                    value: parameter.value,
                })
                .collect(),
        };
        let written = write_versioned(&self.path, &held);
        written.map_err(|error| LinkError::Refused(error.to_string()))
    }
}

impl<C: Controller> Controller for Stored<C> {
    fn identity(&self) -> String {
        self.inner.identity()
    }
    fn connect(&mut self) -> Result<(), LinkError> {
        self.inner.connect()
    }
    fn disconnect(&mut self) {
        self.inner.disconnect();
    }
    fn state(&self) -> ControllerState {
        self.inner.state()
    }
    fn arm(&mut self) -> Result<(), LinkError> {
        self.inner.arm()
    }
    fn confirm_alone(&mut self) -> Result<(), LinkError> {
        self.inner.confirm_alone()
    }
    fn disarm(&mut self) {
        self.inner.disarm();
    }
    fn sample(&mut self) -> Result<Sample, LinkError> {
        self.inner.sample()
    }
    fn subscribe(&mut self, every_s: f64) -> Result<(), LinkError> {
        self.inner.subscribe(every_s)
    }
    fn sent(&mut self) -> Result<Vec<Sample>, LinkError> {
        self.inner.sent()
    }
    fn home(&mut self) -> Result<(), LinkError> {
        self.inner.home()
    }
    fn command(&mut self, pose: &Pose) -> Result<(), LinkError> {
        self.inner.command(pose)
    }
    fn stop(&mut self) -> Result<(), LinkError> {
        self.inner.stop()
    }
    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError> {
        self.inner.parameters()
    }
    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError> {
        self.inner.read(names)
    }
    fn write(&mut self, values: &[(String, f64)]) -> Result<(), LinkError> {
        for value in values {
            self.inner.write(std::slice::from_ref(value))?;
            self.store()?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use tautline_core::robot::presets;
    use tautline_link::ManualClock;
    use tautline_link::simulated::{Fault, SimulatedRobot, SimulatedSetup};

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
        let mut robot = SimulatedRobot::new(setup, clock).expect("a robot");
        robot.connect().expect("connected");
        robot.arm().expect("armed");
        let before = robot.parameters().expect("values");
        let differs = Fault::WriteDiffers {
            name: before[1].name.clone(),
            by: f64::NAN,
            times: 1,
        };
        robot.set_faults(vec![differs]);
        let mut stored = Stored { inner: robot, path };
        let values = before[..2].iter();
        let values: Vec<(String, f64)> = values.map(|p| (p.name.clone(), p.value + 1e-3)).collect();
        assert!(stored.write(&values).is_err());
        let held = held_values(&stored.path)
            .expect("readable")
            .expect("a file");
        assert_eq!(held.len(), before.len());
        assert_eq!(held[0].value, before[0].value + 1e-3);
        assert_eq!(held[1].value, before[1].value);
    }
}
