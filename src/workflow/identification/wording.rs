//! An identification in words.

use tautline_core::estimation::{Observation, ObservationKind};
use tautline_core::robot::Robot;

use super::{Identification, IdentificationDocument};
use crate::wording::count;
use crate::wording::units::signed;

impl IdentificationDocument {
    /// First line of every report: the robot, the method, and whether it converged.
    #[must_use]
    pub fn summary(&self, robot: &str) -> String {
        let (poses, steps) = (
            count(self.poses.len(), "pose"),
            count(self.iterations, "iteration"),
        );
        let (method, ms) = (&self.method, self.seconds * 1e3);
        if self.converged {
            format!("{robot}: {poses}, {method} method converged after {steps} in {ms:.3} ms")
        } else {
            format!(
                "{robot}: {poses}, {method} method did NOT converge ({steps} in {ms:.3} ms): do not rely on these values"
            )
        }
    }
}

impl Identification {
    /// First line of every report: the robot, the method, and whether it converged.
    #[must_use]
    pub fn summary(&self) -> String {
        self.document().summary(&self.dataset.robot.name)
    }

    /// A suspect reading in words: `length of cable-3: off by +5.1 standard deviations`.
    #[must_use]
    pub fn suspect_line(&self, reading: &Observation) -> String {
        let size = reading.normalised().unwrap_or(f64::NAN);
        let what = reading_name(&self.dataset.robot, reading.kind);
        format!("{what}: off by {} standard deviations", signed(size, 1))
    }

    pub(super) fn suspect_lines(&self) -> Vec<String> {
        let labels = &self.dataset.measurements.labels;
        let suspects = self.analysis.suspects();
        let line = |reading: &Observation| {
            let label = labels[reading.row];
            format!("pose {label}, {}", self.suspect_line(reading))
        };
        suspects.iter().map(line).collect()
    }
}

/// Name of a reading: `length of cable-3`.
#[must_use]
pub fn reading_name(robot: &Robot, kind: ObservationKind) -> String {
    let cable = |index: usize| robot.cables[index].name.as_str();
    let axis = |k: usize| ["x", "y", "z"][k];
    match kind {
        ObservationKind::Length(index) => format!("length of {}", cable(index)),
        ObservationKind::Tension(index) => format!("tension of {}", cable(index)),
        ObservationKind::Equilibrium(c) => format!("balance of {}", c.describe()),
        ObservationKind::Laser => "laser distance".to_owned(),
        ObservationKind::Swivel(index) => format!("swivel angle of {}", cable(index)),
        ObservationKind::TrackerPosition(k) => format!("measured position {}", axis(k)),
        ObservationKind::TrackerOrientation(k) => format!("measured rotation about {}", axis(k)),
        ObservationKind::Inclination(k) => ["roll", "pitch", "yaw"][k].to_owned(),
        ObservationKind::Distance(_) => "distance to another pose".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::estimation::{Control, Method};

    use super::*;
    use crate::diagnosis::samples::dataset;
    use crate::identification::{IdentificationRequest, identify};

    #[test]
    fn the_first_line_says_whether_it_converged() {
        let request = IdentificationRequest::new(dataset(), Method::Joint, &[]);
        let request = request.expect("a request");
        let found = identify(&request, &mut |_| Control::Continue).expect("identified");
        let summary = found.summary();
        assert!(summary.starts_with("planar: 13 poses, joint method converged after "));
        let unconverged = IdentificationDocument {
            converged: false,
            ..found.document()
        };
        let summary = unconverged.summary("planar");
        assert!(summary.contains("did NOT converge"), "{summary}");
        assert_eq!(summary.lines().count(), 1);
    }
}
