//! Options of ADS connections.

/// Options of an ADS connection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdsOptions {
    /// Timeout for connecting and for one exchange, from the request to the last byte of its response (s).
    pub timeout_s: f64,
    /// Timeout for the acknowledgement of a command (s).
    pub acknowledge_s: f64,
    /// AMS Net ID of this computer in the controller's route; `None`: its IP address followed by
    /// 1.1.
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
