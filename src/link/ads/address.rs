//! Address of an ADS controller.

use std::fmt;
use std::str::FromStr;

use tautline_session::without_user;

use crate::error::LinkError;

/// Default TCP port of routers.
const TCP_PORT: u16 = 48898;
/// Port of the first PLC program in TwinCAT 3.
const PLC_PORT: u16 = 851;

/// Address of a controller: `HOST[:PORT]/NETID[:AMSPORT]`, like `192.168.0.5/192.168.0.5.1.1`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdsAddress {
    /// Host name or address.
    pub host: String,
    /// TCP port; 48898 by default.
    pub port: u16,
    /// AMS Net ID, six numbers.
    pub net_id: [u8; 6],
    /// AMS port of the program; 851 by default.
    pub ams_port: u16,
}

impl FromStr for AdsAddress {
    type Err = LinkError;

    fn from_str(text: &str) -> Result<Self, LinkError> {
        let wrong = |what: &str| {
            LinkError::Setup(format!(
                "the address {:?} {what}, expected HOST[:PORT]/NETID[:AMSPORT], like 192.168.0.5/192.168.0.5.1.1:851",
                without_user(text)
            ))
        };
        let (place, ams) = text
            .trim()
            .split_once('/')
            .ok_or_else(|| wrong("has no Net ID"))?;
        // A numeric IPv6 host contains colons and is written in brackets.
        let (host, port) = match place.rsplit_once(':') {
            Some((host, port)) if !port.ends_with(']') => (host, port_of(port)),
            _ => (place, Some(TCP_PORT)),
        };
        let host = host.trim_start_matches('[').trim_end_matches(']');
        let strange = |c: char| c.is_whitespace() || c == '@';
        if host.is_empty() || host.contains(strange) {
            return Err(wrong("has no host, or a character that is not allowed"));
        }
        let (net_id, ams_port) = match ams.split_once(':') {
            Some((net_id, port)) => (net_id, port_of(port)),
            None => (ams, Some(PLC_PORT)),
        };
        let numbers: Option<Vec<u8>> = net_id.split('.').map(|n| n.parse().ok()).collect();
        let net_id = numbers.and_then(|numbers| numbers.try_into().ok());
        Ok(Self {
            host: host.to_owned(),
            port: port.ok_or_else(|| wrong("has an invalid port"))?,
            net_id: net_id.ok_or_else(|| wrong("has a Net ID that is not six numbers"))?,
            ams_port: ams_port.ok_or_else(|| wrong("has an invalid AMS port"))?,
        })
    }
}

fn port_of(text: &str) -> Option<u16> {
    text.parse().ok().filter(|port| *port != 0)
}

impl fmt::Display for AdsAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.host.contains(':') {
            true => write!(f, "[{}]", self.host)?,
            false => f.write_str(&self.host)?,
        }
        if self.port != TCP_PORT {
            write!(f, ":{}", self.port)?;
        }
        let [a, b, c, d, e, g] = self.net_id;
        write!(f, "/{a}.{b}.{c}.{d}.{e}.{g}")?;
        if self.ams_port != PLC_PORT {
            write!(f, ":{}", self.ams_port)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_and_written() {
        for text in [
            "plc/5.23.9.1.1.1",
            "10.0.0.7:1234/5.23.9.1.1.1:852",
            "[fe80::1]:9/1.2.3.4.5.6",
            "[fe80::1]/1.2.3.4.5.6",
        ] {
            let address: AdsAddress = text.parse().unwrap();
            assert_eq!(address.to_string(), text);
        }
        let address: AdsAddress = "plc:48898/1.2.3.4.5.6:851".parse().unwrap();
        assert_eq!((address.port, address.ams_port), (48898, 851));
        assert_eq!(address.to_string(), "plc/1.2.3.4.5.6");
    }

    #[test]
    fn what_is_no_address_is_refused_with_an_example() {
        for (text, what) in [
            ("plc", "has no Net ID"),
            ("/1.2.3.4.5.6", "has no host"),
            ("plc/1.2.3.4.5", "not six numbers"),
            ("plc/1.2.3.4.5.256", "not six numbers"),
            ("user:secret@plc/1.2.3.4.5.6", "has an invalid port"),
            ("user:secret@plc:1/1.2.3.4.5.6", "has no host"),
            ("plc:0/1.2.3.4.5.6", "has an invalid port"),
            ("plc:a/1.2.3.4.5.6", "has an invalid port"),
            ("plc/1.2.3.4.5.6:70000", "has an invalid AMS port"),
        ] {
            let told = text.parse::<AdsAddress>().unwrap_err().to_string();
            assert!(
                told.contains(what) && told.contains("192.168.0.5") && !told.contains("secret"),
                "{told}"
            );
        }
    }
}
