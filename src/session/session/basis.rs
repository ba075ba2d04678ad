//! Fingerprint of the inputs of results, which identifies outdated results.

use std::collections::BTreeSet;

use serde::Serialize;
use tautline_core::robot::Robot;

use super::{IdentificationSettings, MeasurementTable, Session};
use crate::fingerprint::Fingerprint;
use crate::json::value_of;
use crate::phases::PoseDistance;

/// The inputs of identification and diagnosis.
#[derive(Serialize)]
struct Inputs<'a> {
    robot: &'a Robot,
    measurements: MeasurementTable,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    distances: &'a [PoseDistance],
    excluded: &'a BTreeSet<i64>,
    identification: &'a IdentificationSettings,
}

impl Session {
    /// Fingerprint of robot, measurements, distances, excluded poses and identification settings: 16 hexadecimal digits, the same in
    /// every version of the program.
    #[must_use]
    pub fn basis(&self) -> String {
        let inputs = Inputs {
            robot: &self.robot,
            measurements: MeasurementTable::of(&self.measurements),
            distances: &self.phases.distances,
            excluded: &self.excluded,
            identification: &self.settings.identification,
        };
        Fingerprint::new().and_value(&value_of(&inputs)).to_hex()
    }
}
