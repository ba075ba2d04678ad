//! Options of OPC UA connections.

/// Options of an OPC UA connection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpcUaOptions {
    /// Timeout for connecting and for one exchange, from the request to the last byte of its response (s).
    pub timeout_s: f64,
    /// Timeout for the acknowledgement of a command (s).
    pub acknowledge_s: f64,
}

impl Default for OpcUaOptions {
    fn default() -> Self {
        Self {
            timeout_s: 1.0,
            acknowledge_s: 2.0,
        }
    }
}
