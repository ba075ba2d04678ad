//! The choice of a controller as one word of text.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use tautline_link::ads::AdsAddress;
use tautline_session::{ControllerKind, Session};

/// The choices, for error messages.
const KNOWN: &str = "expected sim, replay:DIR or ads:HOST[:PORT]/NETID[:AMSPORT]";
const REPLAY: &str = "replay:";
const ADS: &str = "ads:";

/// A controller: `sim`, `replay:DIR` or `ads:HOST[:PORT]/NETID[:AMSPORT]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ControllerChoice {
    /// The simulated robot of the session.
    Simulated,
    /// A recorded dataset folder that is played back.
    Replay(PathBuf),
    /// A Beckhoff controller.
    Ads(AdsAddress),
}

/// A text that names no controller, and why.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ControllerChoiceError(String);

impl ControllerChoice {
    /// The controller of a session's settings.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        let connection = &session.connection;
        // Checked sessions have the settings that their kind of controller needs.
        match (
            connection.controller,
            &connection.recording,
            &connection.place,
        ) {
            (ControllerKind::Recording, Some(recording), _) => {
                Self::Replay(PathBuf::from(&recording.folder))
            }
            (ControllerKind::Ads, _, Some(place)) => Self::Ads(AdsAddress {
                host: place.host.clone(),
                port: place.port,
                net_id: place.net_id,
                ams_port: place.ams_port,
            }),
            _ => Self::Simulated,
        }
    }
}

impl FromStr for ControllerChoice {
    type Err = ControllerChoiceError;

    fn from_str(text: &str) -> Result<Self, ControllerChoiceError> {
        let refuse = |expected| {
            Err(ControllerChoiceError(format!(
                "found \"{text}\", {expected}"
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
        let Some(address) = text.strip_prefix(ADS) else {
            return refuse(KNOWN);
        };
        let address: Result<AdsAddress, _> = address.parse();
        address
            .map(Self::Ads)
            .map_err(|error| ControllerChoiceError(error.to_string()))
    }
}

impl fmt::Display for ControllerChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulated => f.write_str("sim"),
            Self::Replay(folder) => write!(f, "{REPLAY}{}", folder.display()),
            Self::Ads(address) => write!(f, "{ADS}{address}"),
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
            ("ads:robot", "has no Net ID"),
            ("ads:/1.2.3.4.1.1", "has no host"),
            ("ads:robot/1.2.3.4.1", "a Net ID that"),
            ("ads:robot/1.2.3.4.1.256", "a Net ID that"),
            ("ads:robot:many/1.2.3.4.1.1", "a port that is none"),
        ] {
            let error = text.parse::<ControllerChoice>().expect_err(text);
            assert!(error.to_string().contains(expected), "{text}: {error}");
        }
    }
}
