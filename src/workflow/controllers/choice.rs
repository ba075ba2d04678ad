//! The choice of a controller as text.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use tautline_link::LinkError;
use tautline_link::ads::AdsAddress;
use tautline_link::opcua::OpcUaAddress;
use tautline_session::{Connection, ControllerKind, Session, without_user};

/// The possible choices, for error messages.
const KNOWN: &str =
    "expected sim, replay:DIR, ads:HOST[:PORT]/NETID[:AMSPORT] or opc.tcp://HOST[:PORT]";
const REPLAY: &str = "replay:";
const ADS: &str = "ads:";
const OPC_UA: &str = "opc.tcp:";

/// A controller: `sim`, `replay:DIR`, `ads:HOST[:PORT]/NETID[:AMSPORT]` or `opc.tcp://HOST[:PORT]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ControllerChoice {
    /// The simulated robot of the session.
    Simulated,
    /// A recorded dataset folder that is played back.
    Replay(PathBuf),
    /// A Beckhoff controller over ADS.
    Ads(AdsAddress),
    /// A controller over OPC UA.
    OpcUa(OpcUaAddress),
}

/// A text that does not name a controller, with the reason.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ControllerChoiceError(String);

impl ControllerChoice {
    /// The controller of a session's settings.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        Self::of_connection(&session.connection)
    }

    /// The controller of connection settings.
    #[must_use]
    pub fn of_connection(connection: &Connection) -> Self {
        // Checked sessions contain the settings that their kind of controller needs.
        match (
            connection.controller,
            &connection.recording,
            &connection.place,
            &connection.opcua,
        ) {
            (ControllerKind::Recording, Some(recording), _, _) => {
                Self::Replay(PathBuf::from(&recording.folder))
            }
            (ControllerKind::Ads, _, Some(place), _) => Self::Ads(AdsAddress {
                host: place.host.clone(),
                port: place.port,
                net_id: place.net_id,
                ams_port: place.ams_port,
            }),
            (ControllerKind::OpcUa, _, _, Some(place)) => Self::OpcUa(place.into()),
            _ => Self::Simulated,
        }
    }
}

impl FromStr for ControllerChoice {
    type Err = ControllerChoiceError;

    fn from_str(text: &str) -> Result<Self, ControllerChoiceError> {
        let refuse = |expected| {
            Err(ControllerChoiceError(format!(
                "found \"{}\", {expected}",
                without_user(text)
            )))
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
        let to_error = |error: LinkError| ControllerChoiceError(error.to_string());
        match text.strip_prefix(ADS) {
            Some(address) => address.parse().map(Self::Ads).map_err(to_error),
            None if text.starts_with(OPC_UA) => text.parse().map(Self::OpcUa).map_err(to_error),
            None => refuse(KNOWN),
        }
    }
}

impl fmt::Display for ControllerChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulated => f.write_str("sim"),
            Self::Replay(folder) => write!(f, "{REPLAY}{}", folder.display()),
            Self::Ads(address) => write!(f, "{ADS}{address}"),
            Self::OpcUa(address) => write!(f, "{address}"),
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
            "ads:robot.local:48897/5.24.120.30.1.1:852",
            "opc.tcp://192.168.0.5:4840",
            "opc.tcp://plc:4840?security=SignAndEncrypt&user=anna",
        ] {
            let choice: ControllerChoice = text.parse().expect(text);
            assert_eq!(choice.to_string(), text);
        }
        let choice = "ads:robot:851/1.2.3.4.1.1".parse();
        let expected = AdsAddress {
            host: "robot".into(),
            port: 851,
            net_id: [1, 2, 3, 4, 1, 1],
            ams_port: 851,
        };
        assert_eq!(choice, Ok(ControllerChoice::Ads(expected)));
    }

    #[test]
    fn what_names_no_controller_is_refused_with_what_was_expected() {
        for (text, expected) in [
            ("", "expected sim, replay:DIR"),
            ("simulated", "found \"simulated\", expected sim"),
            ("replay:", "the dataset folder"),
            (
                "http://user:secret@plc",
                "found \"http://...@plc\", expected sim",
            ),
            ("ads:robot", "has no Net ID"),
            ("ads:/1.2.3.4.1.1", "has no host"),
            ("opc.tcp://", "has no host"),
            ("ads:robot/1.2.3.4.1", "a Net ID that"),
            ("ads:robot/1.2.3.4.1.256", "a Net ID that"),
            ("ads:robot:many/1.2.3.4.1.1", "an invalid port"),
        ] {
            let error = text.parse::<ControllerChoice>().expect_err(text);
            assert!(error.to_string().contains(expected), "{text}: {error}");
        }
    }
}
