//! Interface of the effects whose physics is a text.

use std::fmt;

use super::{CablePorts, Dual, PlatformPorts, RowContexts};

/// Physics that the text of a user states instead of code.
pub(crate) trait TextPhysics: fmt::Debug + Sync {
    fn text(&self) -> &str;

    /// Sentences of cause and workshop, with fields.
    fn sentences(&self) -> [&str; 2];

    /// Prior expectation of the number of such causes, if the text states one.
    fn prior(&self) -> Option<f64>;

    /// Whether the physics depends on the motion of the platform.
    fn needs_motion(&self) -> bool;

    /// Largest number of a cable in the text, counted from 1; 0 without one.
    fn highest_cable(&self) -> usize;

    /// Changes the ports of the cable with an index; `targets` are the cables that the effect is attached to.
    fn change_cable(
        &self,
        values: &[Dual],
        row: RowContexts<'_>,
        cable: (usize, &[usize]),
        ports: &mut CablePorts,
    );

    fn change_platform(&self, values: &[Dual], row: RowContexts<'_>, ports: &mut PlatformPorts);
}
