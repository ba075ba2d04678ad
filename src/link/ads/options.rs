//! Options of ADS connections.

/// Options of an ADS connection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdsOptions {
    /// Longest time of one exchange, from the request to the last byte of its answer, and of connecting (s).
    pub timeout_s: f64,
    /// Timeout of the acknowledgement of a command (s).
    pub acknowledge_s: f64,
    /// The AMS Net ID by which this computer presents itself, as the controller's route names it; absent: the address
    /// of its network card with 1.1 after it.
    pub own_net_id: Option<[u8; 6]>,
}

impl Default for AdsOptions {
    fn default() -> Self {
        Self {
            timeout_s: 1.0,
            acknowledge_s: 2.0,
            own_net_id: None,
        }
    }
}
