//! How a controller is spoken to.

use crate::reconnecting::BackOff;

/// By which address this computer presents itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdsSource {
    /// The address of its network card, with 1.1 after it.
    Automatic,
    /// This Net ID; a route in the controller names it.
    NetId([u8; 6]),
    /// The one that the router on this computer gives: where the controller is this computer.
    Router,
}

/// How a controller is spoken to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdsOptions {
    /// Longest wait for a connection or an answer (s).
    pub timeout_s: f64,
    /// Longest time in which a command has to be acknowledged (s).
    pub acknowledge_s: f64,
    /// The address of this computer.
    pub source: AdsSource,
    /// How a lost connection is made anew; see [`crate::reconnecting`].
    pub back_off: BackOff,
}

impl Default for AdsOptions {
    fn default() -> Self {
        Self {
            timeout_s: 1.0,
            acknowledge_s: 2.0,
            source: AdsSource::Automatic,
            back_off: BackOff::default(),
        }
    }
}
