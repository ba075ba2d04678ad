//! Input of the connection dialog, and the settings made from it.

use std::path::Path;

use tautline_core::robot::{FieldError, Robot};
use tautline_link::UntrustedServer;
use tautline_link::opcua::{Account, OpcUaAddress, Password};
use tautline_session::{
    AdsPlace, Connection, ControllerKind, LaserSettings, LastConnection, OpcUaPlace, OpcUaPolicy,
    OpcUaSecurity, RecordingPlace, Session, SymbolMapping, UserCertificateFiles,
};

use super::laser::LaserDraft;
use super::names::{Names, default_names};
use super::problems::{DialogTab, FieldId, Problems};
use crate::model::command::{Setup, UserFile};
use crate::widgets::parse_number;

/// Present settings of the session.
#[derive(Debug, Clone)]
pub struct PresentSettings {
    pub robot: Robot,
    /// Connection to its controller.
    pub connection: Connection,
    /// Source of the laser distance.
    pub laser: LaserSettings,
    /// Whether its simulated robot belongs to a demonstration.
    pub is_demo: bool,
}

impl PresentSettings {
    #[must_use]
    pub fn of(session: &Session) -> Self {
        Self {
            robot: session.robot.clone(),
            connection: session.connection.clone(),
            laser: session.laser_source.clone(),
            is_demo: session.simulator.is_some(),
        }
    }
}

/// Authentication at a server.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SignIn {
    #[default]
    Anonymous,
    Name,
    Certificate,
}

impl SignIn {
    fn of(place: &OpcUaPlace) -> Self {
        match (&place.user, &place.user_certificate) {
            (_, Some(_)) => Self::Certificate,
            (Some(_), None) => Self::Name,
            (None, None) => Self::Anonymous,
        }
    }
}

#[derive(Debug)]
pub struct Draft {
    /// Problems of the fields, found anew in each frame.
    pub problems: Problems,
    /// Id of its session.
    pub session_id: u64,
    pub part: DialogTab,
    pub kind: ControllerKind,
    pub folder: String,
    pub speed: String,
    /// Address of an ADS controller.
    pub host: String,
    pub port: String,
    pub net_id: String,
    pub ams_port: String,
    /// Timeout (s).
    pub timeout: String,
    /// Address of an OPC UA controller.
    pub url: String,
    pub security: Option<OpcUaSecurity>,
    pub policy: Option<OpcUaPolicy>,
    pub sign_in: SignIn,
    pub user: String,
    /// Password of the user, which is not part of the settings.
    pub password: Password,
    /// Whether the password is stored on this computer.
    pub keeps_password: bool,
    /// Paths of the certificate of the user and of its private key.
    pub certificate: String,
    pub key: String,
    pub url_timeout: String,
    ads: Names,
    nodes: Names,
    pub laser: LaserDraft,
    /// Untrusted server, and whether to connect once it is trusted.
    pub untrusted: Option<(Box<UntrustedServer>, bool)>,
    /// Error of the last attempt to connect.
    pub refused: Option<String>,
    /// Set while connecting from this dialog, which then closes.
    pub connects: bool,
}

impl Draft {
    /// Settings of a session, completed by those used last.
    #[must_use]
    pub fn of(session: &Session, session_id: u64, reached: &LastConnection) -> Self {
        let connection = &session.connection;
        let place = connection.place.clone().or_else(|| reached.place.clone());
        let number = |value: Option<f64>| format!("{}", value.unwrap_or(1.0));
        let text = |of: fn(&AdsPlace) -> String, usual: &str| {
            place.as_ref().map_or_else(|| usual.to_owned(), of)
        };
        let opcua = connection.opcua.clone().or_else(|| reached.opcua.clone());
        let files = opcua
            .as_ref()
            .and_then(|place| place.user_certificate.as_ref());
        let robot = &session.robot;
        let names = |own: &Option<SymbolMapping>, kind| {
            Names::of(own.as_ref(), &default_names(kind, robot), robot)
        };
        let recording = connection.recording.as_ref();
        Self {
            problems: Problems::default(),
            session_id,
            part: DialogTab::default(),
            kind: connection.controller,
            folder: recording.map_or_else(String::new, |place| place.folder.clone()),
            speed: number(recording.map(|place| place.speed)),
            host: text(|place| place.host.clone(), ""),
            port: text(
                |place| place.port.to_string(),
                &AdsPlace::ROUTER_PORT.to_string(),
            ),
            net_id: text(|place| place.net_id.map(|n| n.to_string()).join("."), ""),
            ams_port: text(
                |place| place.ams_port.to_string(),
                &AdsPlace::PROGRAM_PORT.to_string(),
            ),
            timeout: number(place.as_ref().map(|place| place.timeout_s)),
            url: opcua.as_ref().map_or_else(String::new, url_of),
            security: opcua.as_ref().and_then(|place| place.security),
            policy: opcua.as_ref().and_then(|place| place.policy),
            user: opcua
                .as_ref()
                .and_then(|place| place.user.clone())
                .unwrap_or_default(),
            sign_in: opcua.as_ref().map(SignIn::of).unwrap_or_default(),
            password: Password::default(),
            keeps_password: false,
            certificate: files.map_or_else(String::new, |files| files.certificate.clone()),
            key: files.map_or_else(String::new, |files| files.key.clone()),
            url_timeout: number(opcua.as_ref().map(|place| place.timeout_s)),
            ads: names(&connection.ads, ControllerKind::Ads),
            nodes: names(&connection.nodes, ControllerKind::OpcUa),
            laser: LaserDraft::of(&session.laser_source, &reached.laser),
            untrusted: None,
            refused: None,
            connects: false,
        }
    }

    /// Settings made from the input; those of other kinds of controller as in the session.
    ///
    /// # Errors
    /// Errors of the fields.
    pub fn settings(
        &self,
        present: &PresentSettings,
    ) -> Result<(Connection, LaserSettings), Problems> {
        let mut problems = Problems::default();
        let mut connection = present.connection.clone();
        connection.controller = self.kind;
        match self.kind {
            ControllerKind::Simulated => {}
            ControllerKind::Recording => {
                connection.recording = self.recording(&mut problems);
            }
            ControllerKind::Ads => {
                connection.place = self.place(&mut problems);
                connection.ads = self.ads.mapping(&present.robot, &mut problems);
            }
            ControllerKind::OpcUa => {
                connection.opcua = self.opcua(&mut problems);
                connection.nodes = self.nodes.mapping(&present.robot, &mut problems);
            }
        }
        let laser = self.laser.settings(&mut problems);
        match (problems.is_empty(), laser) {
            (true, Some(laser)) => Ok((connection, laser)),
            _ => Err(problems),
        }
    }

    /// Sets custom names of symbols.
    pub fn use_symbols(&mut self, mapping: &SymbolMapping, robot: &Robot) {
        *self.names_mut() = Names::of(Some(mapping), mapping, robot);
    }

    /// Names of the symbols for the chosen kind of controller.
    pub fn names(&self) -> &Names {
        match self.kind {
            ControllerKind::OpcUa => &self.nodes,
            _ => &self.ads,
        }
    }

    pub fn names_mut(&mut self) -> &mut Names {
        match self.kind {
            ControllerKind::OpcUa => &mut self.nodes,
            _ => &mut self.ads,
        }
    }

    fn recording(&self, problems: &mut Problems) -> Option<RecordingPlace> {
        let speed = parse_number(&self.speed);
        let speed = problems.take(FieldId::Speed, speed)?;
        let place = RecordingPlace {
            folder: self.folder.trim().to_owned(),
            speed,
        };
        let fields = [("/folder", FieldId::Folder), ("/speed", FieldId::Speed)];
        checked(place.check(), &fields, problems)?;
        Some(place)
    }

    /// Network location of an ADS controller.
    fn place(&self, problems: &mut Problems) -> Option<AdsPlace> {
        let host = self.host.trim().to_owned();
        if host.is_empty() {
            let text = "found nothing, expected the name or address of the controller, such as 192.168.0.5";
            problems.add(FieldId::Host, text);
        }
        let port = problems.take(FieldId::Port, port(&self.port));
        let net_id = problems.take(FieldId::NetId, net_id(&self.net_id));
        let ams_port = problems.take(FieldId::AmsPort, self::port(&self.ams_port));
        let timeout_s = problems.take(FieldId::Timeout, parse_number(&self.timeout));
        let place = AdsPlace {
            host,
            port: port?,
            net_id: net_id?,
            ams_port: ams_port?,
            timeout_s: timeout_s?,
        };
        let fields = [("/host", FieldId::Host), ("/timeout_s", FieldId::Timeout)];
        if problems.of(FieldId::Host).is_none() {
            checked(place.check(), &fields, problems)?;
        }
        Some(place)
    }

    /// Typed password, if the user signs in with one.
    #[must_use]
    pub fn password(&self) -> Option<Password> {
        let has_one = self.sign_in == SignIn::Name && !self.password.is_empty();
        has_one.then(|| self.password.clone())
    }

    /// Command that sets the password; it is stored only if it was typed.
    #[must_use]
    pub fn use_password(&self) -> Setup {
        let password = self.password();
        Setup::UsePassword {
            keeps: self.keeps_password && password.is_some(),
            password,
        }
    }

    /// User whose password may be stored, as far as known.
    #[must_use]
    pub fn account(&self) -> Option<Account> {
        let place = self.opcua(&mut Problems::default())?;
        OpcUaAddress::from(&place).account()
    }

    /// Sets the path of a user's file.
    pub fn set_user_file(&mut self, which: UserFile, path: &Path) {
        let field = match which {
            UserFile::Certificate => &mut self.certificate,
            UserFile::Key => &mut self.key,
        };
        *field = path.display().to_string();
    }

    fn opcua(&self, problems: &mut Problems) -> Option<OpcUaPlace> {
        let address = self.url.trim().parse::<OpcUaAddress>();
        let address = problems.take(FieldId::Url, address.map_err(|error| error.to_string()));
        let timeout_s = problems.take(FieldId::UrlTimeout, parse_number(&self.url_timeout));
        let place = address?.place(timeout_s?);
        // A user in the address takes precedence.
        let sign_in = match SignIn::of(&place) {
            SignIn::Anonymous => self.sign_in,
            _ => SignIn::Anonymous,
        };
        let user = (sign_in == SignIn::Name).then(|| self.user.trim().to_owned());
        let files = || UserCertificateFiles {
            certificate: self.certificate.trim().to_owned(),
            key: self.key.trim().to_owned(),
        };
        let user_certificate = (sign_in == SignIn::Certificate).then(|| files().absolute());
        // The address takes precedence over the other fields, so that a copied address is complete.
        let place = OpcUaPlace {
            security: place.security.or(self.security),
            policy: place.policy.or(self.policy),
            user: place.user.or(user),
            user_certificate: place.user_certificate.or(user_certificate),
            ..place
        };
        let fields = [
            ("/host", FieldId::Url),
            ("/policy", FieldId::Policy),
            ("/user", FieldId::User),
            ("/user_certificate/certificate", FieldId::UserCertificate),
            ("/user_certificate/key", FieldId::UserKey),
            ("/timeout_s", FieldId::UrlTimeout),
        ];
        checked(place.check(), &fields, problems)?;
        Some(place)
    }
}

/// Address only; the rest has separate fields.
fn url_of(place: &OpcUaPlace) -> String {
    OpcUaAddress::from(place).url()
}

fn checked(
    result: Result<(), FieldError>,
    fields: &[(&str, FieldId)],
    problems: &mut Problems,
) -> Option<()> {
    let error = match result {
        Ok(()) => return Some(()),
        Err(error) => error,
    };
    let found = fields.iter().find(|(at, _)| *at == error.pointer);
    let field = found.map_or(FieldId::Host, |(_, field)| *field);
    problems.add(field, error.message);
    None
}

/// Parses a port number.
///
/// # Errors
/// If the text is not a port number; the message states what was found and expected.
pub fn port(text: &str) -> Result<u16, String> {
    let number = text.trim().parse().ok().filter(|port| *port != 0);
    number.ok_or_else(|| format!("found \"{text}\", expected a number from 1 to 65535"))
}

/// Six numbers separated by points.
fn net_id(text: &str) -> Result<[u8; 6], String> {
    let numbers: Option<Vec<u8>> = text
        .trim()
        .split('.')
        .map(|part| part.parse().ok())
        .collect();
    let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
    numbers.ok_or_else(|| {
        format!("found \"{text}\", expected six numbers from 0 to 255, such as 192.168.0.5.1.1")
    })
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;
    use tautline_session::Timestamp;

    use super::*;

    fn session() -> Session {
        let robot = presets::find("mini").expect("a preset").robot;
        Session::new("test", robot, Timestamp::from_unix_seconds(0))
    }

    fn draft(session: &Session) -> Draft {
        Draft::of(session, 1, &LastConnection::default())
    }

    #[test]
    fn what_a_session_has_comes_back_unchanged() {
        let mut session = session();
        session.laser_source = "tcp:laser:4001?no_return=E255&command=D%0D%0A"
            .parse()
            .expect("settings");
        session.connection = Connection {
            controller: ControllerKind::Ads,
            recording: Some(RecordingPlace {
                folder: "runs/one".into(),
                speed: 4.0,
            }),
            place: Some(AdsPlace {
                host: "plc".into(),
                port: 1234,
                net_id: [5, 23, 9, 1, 1, 1],
                ams_port: 852,
                timeout_s: 0.5,
            }),
            ads: Some(SymbolMapping::default_for(&session.robot)),
            opcua: Some(OpcUaPlace {
                host: "plc".into(),
                port: 4841,
                path: "/UA".into(),
                security: Some(OpcUaSecurity::SignAndEncrypt),
                policy: Some(OpcUaPolicy::Basic256Sha256),
                user: Some("anna".into()),
                user_certificate: None,
                timeout_s: 0.5,
            }),
            nodes: Some(SymbolMapping::default_nodes_for(&session.robot)),
        };
        let certified = OpcUaPlace {
            user: None,
            user_certificate: Some(
                UserCertificateFiles {
                    certificate: "anna.der".into(),
                    key: "anna.key".into(),
                }
                .absolute(),
            ),
            ..session.connection.opcua.clone().expect("an address")
        };
        let anonymous = OpcUaPlace {
            user_certificate: None,
            ..certified.clone()
        };
        session.connection.controller = ControllerKind::OpcUa;
        for place in [
            certified,
            anonymous,
            session.connection.opcua.clone().expect("it"),
        ] {
            session.connection.opcua = Some(place);
            let settings = draft(&session).settings(&PresentSettings::of(&session));
            assert_eq!(settings.expect("settings").0, session.connection);
        }
        for kind in [
            ControllerKind::Ads,
            ControllerKind::OpcUa,
            ControllerKind::Recording,
            ControllerKind::Simulated,
        ] {
            session.connection.controller = kind;
            let settings = draft(&session)
                .settings(&PresentSettings::of(&session))
                .expect("settings");
            assert_eq!(settings.0, session.connection);
            assert_eq!(settings.1, session.laser_source);
        }
    }

    #[test]
    fn wrong_entries_are_told_beside_their_fields() {
        let session = session();
        let mut draft = draft(&session);
        draft.kind = ControllerKind::Recording;
        let problems = draft
            .settings(&PresentSettings::of(&session))
            .expect_err("no folder");
        assert!(problems.of(FieldId::Folder).is_some());
        draft.kind = ControllerKind::Ads;
        draft.net_id = "1.2.3".into();
        draft.port = "0".into();
        draft.timeout = "soon".into();
        let problems = draft
            .settings(&PresentSettings::of(&session))
            .expect_err("wrong");
        for field in [
            FieldId::Host,
            FieldId::Port,
            FieldId::NetId,
            FieldId::Timeout,
        ] {
            let text = problems.of(field).expect("a problem");
            assert!(text.contains("expected"), "{text}");
        }
        assert_eq!(problems.of(FieldId::AmsPort), None);
        draft.host = "plc".into();
        draft.net_id = "1.2.3.4.1.1".into();
        draft.port = "48898".into();
        draft.timeout = "2".into();
        let (connection, _) = draft
            .settings(&PresentSettings::of(&session))
            .expect("settings");
        assert_eq!(connection.place.map(|place| place.timeout_s), Some(2.0));
        assert_eq!(connection.ads, None, "the usual names");
        draft.kind = ControllerKind::OpcUa;
        draft.url = "plc:4840".into();
        let problems = draft
            .settings(&PresentSettings::of(&session))
            .expect_err("wrong");
        let text = problems.of(FieldId::Url).expect("a problem");
        assert!(text.contains("expected opc.tcp://"), "{text}");
        draft.url = "opc.tcp://plc".into();
        for (sign_in, field, expected) in [
            (SignIn::Name, FieldId::User, "the name of a user"),
            (
                SignIn::Certificate,
                FieldId::UserCertificate,
                "the file with the certificate",
            ),
        ] {
            draft.sign_in = sign_in;
            let problems = draft
                .settings(&PresentSettings::of(&session))
                .expect_err("empty");
            let text = problems.of(field).expect("a problem");
            assert!(text.contains(expected), "{text}");
        }
    }
}
