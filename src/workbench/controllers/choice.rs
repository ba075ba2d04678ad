//! Which controller somebody asks for, as one word.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// What can be asked for.
const KNOWN: &str = "expected sim, replay:DIR or ads:HOST[:PORT]/NETID";
const REPLAY: &str = "replay:";
const ADS: &str = "ads:";

/// A controller: `sim`, `replay:DIR` or `ads:HOST[:PORT]/NETID`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ControllerChoice {
    /// The simulated robot of the session.
    Simulated,
    /// A recorded dataset folder that is played back.
    Replay(PathBuf),
    /// A Beckhoff controller.
    Ads(AdsAddress),
}

/// Where a Beckhoff controller is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdsAddress {
    /// Name or address of its computer.
    pub host: String,
    /// TCP port, where it is not the usual one.
    pub port: Option<u16>,
    /// AMS Net ID: six numbers with dots between.
    pub net_id: String,
}

/// A word that names no controller.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("found \"{found}\", {expected}")]
pub struct NoChoice {
    found: String,
    expected: &'static str,
}

impl FromStr for ControllerChoice {
    type Err = NoChoice;

    fn from_str(text: &str) -> Result<Self, NoChoice> {
        let refuse = |expected| {
            Err(NoChoice {
                found: text.to_owned(),
                expected,
            })
        };
        if text == "sim" {
            return Ok(Self::Simulated);
        }
        if let Some(folder) = text.strip_prefix(REPLAY) {
            return match folder {
                "" => refuse("expected the dataset folder after replay:"),
                folder => Ok(Self::Replay(folder.into())),
            };
        }
        let Some(address) = text.strip_prefix(ADS) else {
            return refuse(KNOWN);
        };
        match ads_address(address) {
            Some(address) => Ok(Self::Ads(address)),
            None => refuse("expected ads:HOST[:PORT]/NETID with a Net ID such as 5.24.120.30.1.1"),
        }
    }
}

fn ads_address(text: &str) -> Option<AdsAddress> {
    let (place, net_id) = text.rsplit_once('/')?;
    let numbers: Result<Vec<u8>, _> = net_id.split('.').map(str::parse).collect();
    if numbers.ok()?.len() != 6 {
        return None;
    }
    let (host, port) = match place.rsplit_once(':') {
        Some((host, port)) => (host, Some(port.parse().ok()?)),
        None => (place, None),
    };
    (!host.is_empty()).then(|| AdsAddress {
        host: host.to_owned(),
        port,
        net_id: net_id.to_owned(),
    })
}

impl fmt::Display for ControllerChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulated => f.write_str("sim"),
            Self::Replay(folder) => write!(f, "{REPLAY}{}", folder.display()),
            Self::Ads(AdsAddress { host, port, net_id }) => {
                let port = port.map_or(String::new(), |port| format!(":{port}"));
                write!(f, "{ADS}{host}{port}/{net_id}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_is_read_again() {
        for text in [
            "sim",
            "replay:runs/one",
            "replay:/a:b/c",
            "ads:192.168.0.5/5.24.120.30.1.1",
            "ads:robot.local:48898/5.24.120.30.1.1",
        ] {
            let choice: ControllerChoice = text.parse().expect(text);
            assert_eq!(choice.to_string(), text);
        }
        let choice = "ads:robot:851/1.2.3.4.1.1".parse();
        let expected = AdsAddress {
            host: "robot".into(),
            port: Some(851),
            net_id: "1.2.3.4.1.1".into(),
        };
        assert_eq!(choice, Ok(ControllerChoice::Ads(expected)));
    }

    #[test]
    fn what_names_no_controller_is_refused_with_what_was_expected() {
        for (text, expected) in [
            ("", "expected sim, replay:DIR"),
            ("simulated", "found \"simulated\", expected sim"),
            ("replay:", "the dataset folder"),
            ("ads:robot", "a Net ID"),
            ("ads:/1.2.3.4.1.1", "a Net ID"),
            ("ads:robot/1.2.3.4.1", "a Net ID"),
            ("ads:robot/1.2.3.4.1.256", "a Net ID"),
            ("ads:robot:many/1.2.3.4.1.1", "a Net ID"),
        ] {
            let error = text.parse::<ControllerChoice>().expect_err(text);
            assert!(error.to_string().contains(expected), "{text}: {error}");
        }
    }
}
