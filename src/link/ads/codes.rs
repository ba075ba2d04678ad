//! Error codes and states of ADS devices in words, from Beckhoff's information system.

/// An error code of the controller: a request was rejected, but the connection is intact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct AdsCode(pub u32);

impl AdsCode {
    /// Its meaning in words.
    pub fn explain(self) -> String {
        let known = MEANINGS.binary_search_by_key(&self.0, |(code, _)| *code);
        let meaning = known.map_or("unknown error", |at| MEANINGS[at].1);
        format!("{meaning} (ADS error {:#x})", self.0)
    }

    /// Whether the code means that the controller does not support the request.
    pub fn is_unknown_request(self) -> bool {
        matches!(self.0, 0x8 | 0xB | 0x701 | 0x702)
    }
}

/// The ADS state in which a program runs.
pub(super) const RUN: u16 = 5;

/// Name of a device state.
pub(super) fn state_name(state: u16) -> String {
    let name = STATES.get(usize::from(state));
    name.map_or_else(|| format!("number {state}"), |name| (*name).to_owned())
}

const STATES: [&str; 20] = [
    "Invalid",
    "Idle",
    "Reset",
    "Init",
    "Start",
    "Run",
    "Stop",
    "SaveCfg",
    "LoadCfg",
    "PowerFail",
    "PowerGood",
    "Error",
    "Shutdown",
    "Suspend",
    "Resume",
    "Config",
    "Reconfig",
    "Stopping",
    "Incompatible",
    "Exception",
];

/// Codes with their meanings, in ascending order.
const MEANINGS: &[(u32, &str)] = &[
    (0x1, "Internal error"),
    (0x2, "No real-time"),
    (0x3, "Allocation locked - memory error"),
    (0x4, "Mailbox full - ADS message could not be sent"),
    (0x5, "Wrong receive HMSG"),
    (
        0x6,
        "Target port not found, possibly ADS server not started",
    ),
    (0x7, "Target machine not found, possibly missing ADS routes"),
    (0x8, "Unknown command ID"),
    (0x9, "Invalid task ID"),
    (0xA, "No IO"),
    (0xB, "Unknown AMS command"),
    (0xC, "Win32 error"),
    (0xD, "Port not connected"),
    (0xE, "Invalid AMS length"),
    (0xF, "Invalid AMS NetID"),
    (0x10, "Low installation level"),
    (0x11, "No debugging available"),
    (0x12, "Port disabled - system service not started"),
    (0x13, "Port already connected"),
    (0x14, "AMS Sync Win32 error"),
    (0x15, "AMS Sync timeout"),
    (0x16, "AMS Sync error"),
    (0x17, "AMS Sync no index map"),
    (0x18, "Invalid AMS port"),
    (0x19, "No memory"),
    (0x1A, "TCP send error"),
    (0x1B, "Host unreachable"),
    (0x1C, "Invalid AMS fragment"),
    (0x1D, "TLS send error - secure ADS connection failed"),
    (0x1E, "Access denied - secure ADS access denied"),
    (0x500, "Router: no locked memory"),
    (0x501, "Router: memory size could not be changed"),
    (0x502, "Router: mailbox full"),
    (0x503, "Router: debug mailbox full"),
    (0x504, "Router: port type is unknown"),
    (0x505, "Router is not initialized"),
    (0x506, "Router: desired port number is already assigned"),
    (0x507, "Router: port not registered"),
    (0x508, "Router: maximum number of ports reached"),
    (0x509, "Router: port is invalid"),
    (0x50A, "Router is not active"),
    (0x50B, "Router: mailbox full for fragmented messages"),
    (0x50C, "Router: fragment timeout occurred"),
    (0x50D, "Router: port removed"),
    (0x700, "General device error"),
    (0x701, "Service is not supported by server"),
    (0x702, "Invalid index group"),
    (0x703, "Invalid index offset"),
    (0x704, "Reading/writing not permitted"),
    (0x705, "Parameter size not correct"),
    (0x706, "Invalid parameter value(s)"),
    (0x707, "Device is not in a ready state"),
    (0x708, "Device is busy"),
    (0x709, "Invalid OS context: use multi-task data access"),
    (0x70A, "Out of memory"),
    (0x70B, "Invalid parameter value(s)"),
    (0x70C, "Not found (files, ...)"),
    (0x70D, "Syntax error in command or file"),
    (0x70E, "Objects do not match"),
    (0x70F, "Object already exists"),
    (0x710, "Symbol not found"),
    (0x711, "Symbol version invalid: create a new handle"),
    (0x712, "Server is in an invalid state"),
    (0x713, "AdsTransMode not supported"),
    (0x714, "Notification handle is invalid"),
    (0x715, "Notification client not registered"),
    (0x716, "No more notification handles"),
    (0x717, "Notification size too large"),
    (0x718, "Device not initialized"),
    (0x719, "Device has a timeout"),
    (0x71A, "Query interface failed"),
    (0x71B, "Wrong interface required"),
    (0x71C, "Class ID is invalid"),
    (0x71D, "Object ID is invalid"),
    (0x71E, "Request is pending"),
    (0x71F, "Request is aborted"),
    (0x720, "Signal warning"),
    (0x721, "Invalid array index"),
    (0x722, "Symbol not active: release handle and try again"),
    (0x723, "Access denied"),
    (0x724, "No license found: activate license"),
    (0x725, "License expired"),
    (0x726, "License exceeded"),
    (0x727, "License invalid"),
    (0x728, "Invalid system ID in license"),
    (0x729, "License not time limited"),
    (0x72A, "License issue time in the future"),
    (0x72B, "License time period too long"),
    (
        0x72C,
        "Exception in device specific code: check each device",
    ),
    (0x72D, "License file read twice"),
    (0x72E, "Invalid signature"),
    (0x72F, "Invalid public key certificate"),
    (0x730, "Public key not known from OEM"),
    (0x731, "License not valid for this system ID"),
    (0x732, "Demo license prohibited"),
    (0x733, "Invalid function ID"),
    (0x734, "Outside the valid range"),
    (0x735, "Invalid alignment"),
    (0x736, "Invalid platform level"),
    (0x737, "Context - forward to passive level"),
    (0x738, "Content - forward to dispatch level"),
    (0x739, "Context - forward to real-time"),
    (0x740, "General client error"),
    (0x741, "Invalid parameter at service"),
    (0x742, "Polling list is empty"),
    (0x743, "Var connection already in use"),
    (0x744, "Invoke ID in use"),
    (0x745, "Timeout elapsed: check route setting"),
    (0x746, "Error in Win32 subsystem"),
    (0x747, "Invalid client timeout value"),
    (0x748, "ADS port not opened"),
    (0x749, "No AMS address"),
    (0x750, "Internal error in ADS sync"),
    (0x751, "Hash table overflow"),
    (0x752, "Key not found in hash"),
    (0x753, "No more symbols in cache"),
    (0x754, "Invalid response received"),
    (0x755, "Sync port is locked"),
    (0x1000, "Internal error in real-time system"),
    (0x1001, "Timer value not valid"),
    (0x1002, "Task pointer has invalid value 0"),
    (0x1003, "Stack pointer has invalid value 0"),
    (0x1004, "Requested task priority already assigned"),
    (0x1005, "No free Task Control Block"),
    (0x1006, "No free semaphores"),
    (0x1007, "No free space in the queue"),
    (0x100D, "External sync interrupt already applied"),
    (0x100E, "No external sync interrupt applied"),
    (0x100F, "External sync interrupt application failed"),
    (0x1010, "Call of service function in wrong context"),
    (0x1017, "Intel VT-x not supported"),
    (0x1018, "Intel VT-x not enabled in BIOS"),
    (0x1019, "Missing function in Intel VT-x"),
    (0x101A, "Activation of Intel VT-x failed"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_told_with_their_meaning() {
        for (code, told) in [
            (0x710, "Symbol not found (ADS error 0x710)"),
            (
                0x7,
                "Target machine not found, possibly missing ADS routes (ADS error 0x7)",
            ),
            (0x9999, "unknown error (ADS error 0x9999)"),
        ] {
            assert_eq!(AdsCode(code).explain(), told);
        }
        assert!(
            MEANINGS.is_sorted_by(|a, b| a.0 < b.0),
            "it is searched by halves"
        );
    }

    #[test]
    fn states_have_names() {
        assert_eq!(state_name(RUN), "Run");
        assert_eq!(state_name(6), "Stop");
        assert_eq!(state_name(77), "number 77");
    }
}
