//! A controller whose last readings can be seen without asking it again.

use tautline_core::geometry::Pose;
use tautline_link::{Controller, ControllerState, LinkError, ParameterInfo, Sample};

/// A controller and what it read last.
pub(super) struct Watched {
    inner: Box<dyn Controller>,
    /// The last readings.
    pub last: Option<Sample>,
}

impl Watched {
    /// Watches a controller.
    pub fn new(inner: Box<dyn Controller>) -> Self {
        Self { inner, last: None }
    }
}

impl Controller for Watched {
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
    fn disarm(&mut self) {
        self.inner.disarm();
    }
    fn sample(&mut self) -> Result<Sample, LinkError> {
        let sample = self.inner.sample()?;
        self.last = Some(sample.clone());
        Ok(sample)
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
        self.inner.write(values)
    }
}
