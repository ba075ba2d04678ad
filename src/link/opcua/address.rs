//! Address of an OPC UA controller.

use std::fmt;
use std::str::FromStr;

use tautline_session::without_user;

use crate::error::LinkError;

/// Prefix of addresses.
const SCHEME: &str = "opc.tcp://";
/// Default port of the standard.
const PORT: u16 = 4840;

/// Address of a controller: `opc.tcp://HOST[:PORT][/PATH]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpcUaAddress {
    /// Host name or address.
    pub host: String,
    /// TCP port; 4840 by default.
    pub port: u16,
    /// Path with its leading slash; empty for most controllers.
    pub path: String,
}

impl FromStr for OpcUaAddress {
    type Err = LinkError;

    fn from_str(text: &str) -> Result<Self, LinkError> {
        let wrong = |what: &str| {
            LinkError::Setup(format!(
                "the address {:?} {what}, expected opc.tcp://HOST[:PORT], like opc.tcp://192.168.0.5:4840",
                without_user(text)
            ))
        };
        let rest = text.trim().strip_prefix(SCHEME);
        let rest = rest.ok_or_else(|| wrong("does not begin with opc.tcp://"))?;
        let (place, path) = rest.split_at(rest.find('/').unwrap_or(rest.len()));
        // A numeric IPv6 host contains colons and is written in brackets.
        let (host, port) = match place.rsplit_once(':') {
            Some((host, port)) if !port.ends_with(']') => {
                (host, port.parse().ok().filter(|port| *port != 0))
            }
            _ => (place, Some(PORT)),
        };
        let host = host.trim_start_matches('[').trim_end_matches(']');
        let strange = |c: char| c.is_whitespace() || c.is_control() || c == '@';
        if host.is_empty() || rest.contains(strange) {
            return Err(wrong("has no host, or a character that is not allowed"));
        }
        Ok(Self {
            host: host.to_owned(),
            port: port.ok_or_else(|| wrong("has an invalid port"))?,
            path: path.to_owned(),
        })
    }
}

impl fmt::Display for OpcUaAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { host, port, path } = self;
        match host.contains(':') {
            true => write!(f, "{SCHEME}[{host}]:{port}{path}"),
            false => write!(f, "{SCHEME}{host}:{port}{path}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_and_shown() {
        for (text, shown) in [
            ("opc.tcp://plc", "opc.tcp://plc:4840"),
            ("opc.tcp://10.0.0.5:4841", "opc.tcp://10.0.0.5:4841"),
            (
                "opc.tcp://[fe80::1]/UA/Server",
                "opc.tcp://[fe80::1]:4840/UA/Server",
            ),
        ] {
            let address: OpcUaAddress = text.parse().expect(text);
            assert_eq!(address.to_string(), shown);
            assert_eq!(shown.parse(), Ok(address));
        }
        for (text, why) in [
            ("plc:4840", "does not begin"),
            ("opc.tcp://", "has no host"),
            ("opc.tcp://plc:0", "an invalid port"),
            ("opc.tcp://user:secret@plc", "not allowed"),
        ] {
            let told = text.parse::<OpcUaAddress>().expect_err(text).to_string();
            assert!(told.contains(why), "{text}: {told}");
            assert!(!told.contains("secret"), "{told}");
        }
    }
}
