//! The values that a controller holds, as far as the session recorded them.

use std::collections::BTreeMap;

use super::{Adjustment, Outcome, Session};
use crate::fingerprint::Fingerprint;
use crate::json::value_of;

impl Session {
    /// The values of the controller by name: as it was last read, and as the adjustments left it.
    #[must_use]
    pub fn controller_values(&self) -> BTreeMap<String, f64> {
        let read = self.controller.iter();
        let mut values: BTreeMap<String, f64> =
            read.map(|held| (held.name.clone(), held.value)).collect();
        for adjustment in &self.adjustments {
            let is_new = holds_new(adjustment);
            for change in &adjustment.changes {
                let value = is_new.map(|is_new| if is_new { change.after } else { change.before });
                match value {
                    Some(value) => values.insert(change.name.clone(), value),
                    None => values.remove(&change.name),
                };
            }
        }
        values
    }

    /// Fingerprint of the values of the controller: 16 hexadecimal digits.
    #[must_use]
    pub fn controller_fingerprint(&self) -> String {
        let values = value_of(&self.controller_values());
        Fingerprint::new().and_value(&values).to_hex()
    }
}

/// Whether the controller held the new values after an adjustment; `None` if that is unknown.
fn holds_new(adjustment: &Adjustment) -> Option<bool> {
    match adjustment.outcome {
        Outcome::Written => Some(true),
        Outcome::RolledBack => Some(adjustment.restores),
        Outcome::Failed(_) => Some(false),
        Outcome::Begun | Outcome::Unsettled(_) => None,
    }
}
