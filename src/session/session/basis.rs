//! Fingerprint of the inputs of results, which identifies outdated results.

use std::collections::BTreeSet;

use serde::Serialize;
use tautline_core::robot::Robot;

use super::{IdentificationSettings, MeasurementTable, Session};
use crate::fingerprint::Fingerprint;
use crate::json::value_of;

/// The inputs of identification and diagnosis.
#[derive(Serialize)]
struct Inputs<'a> {
    robot: &'a Robot,
    measurements: MeasurementTable,
    excluded: &'a BTreeSet<i64>,
    identification: &'a IdentificationSettings,
}

impl Session {
    /// Fingerprint of robot, measurements, excluded poses and identification settings: 16 hexadecimal digits, the same in
    /// every version of the program.
    #[must_use]
    pub fn basis(&self) -> String {
        let inputs = Inputs {
            robot: &self.robot,
            measurements: MeasurementTable::of(&self.measurements),
            excluded: &self.excluded,
            identification: &self.settings.identification,
        };
        Fingerprint::new().and_value(&value_of(&inputs)).to_hex()
    }
}
