//! What is typed into the connection dialog, and the settings that it makes.

use tautline_core::robot::{FieldError, Robot};
use tautline_session::{
    AdsMapping, AdsPlace, Connection, ControllerKind, LaserSettings, LastConnection,
    RecordingPlace, Session,
};

use super::laser::LaserDraft;
use super::symbols::SymbolRows;
use crate::widgets::parse_number;

/// A field that can be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Field {
    /// Folder of the recording.
    Folder,
    /// Speed of the recording.
    Speed,
    /// Host of the controller.
    Host,
    /// Its TCP port.
    Port,
    /// Its AMS Net ID.
    NetId,
    /// Its AMS port.
    AmsPort,
    /// Timeout.
    Timeout,
    /// A row of the symbols.
    Symbol(usize),
    /// Something of all symbols.
    Symbols,
    /// Host of the laser.
    LaserHost,
    /// Port of the laser.
    LaserPort,
    /// Serial port of the laser.
    Device,
    /// Baud rate.
    Baud,
    /// Line pattern.
    Pattern,
    /// Something else of the laser.
    Laser,
}

impl Field {
    /// Where the field is.
    #[must_use]
    pub fn part(self) -> Part {
        match self {
            Self::Symbol(_) | Self::Symbols => Part::Symbols,
            Self::LaserHost
            | Self::LaserPort
            | Self::Device
            | Self::Baud
            | Self::Pattern
            | Self::Laser => Part::Laser,
            _ => Part::Controller,
        }
    }
}

/// A part of the window.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Part {
    /// Kind and place of the controller.
    #[default]
    Controller,
    /// Names of its symbols.
    Symbols,
    /// The laser.
    Laser,
}

impl Part {
    /// Label in the window.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Controller => "Controller",
            Self::Symbols => "Symbols",
            Self::Laser => "Laser source",
        }
    }
}

/// What is wrong with fields: one sentence each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Problems(Vec<(Field, String)>);

impl Problems {
    /// A field is wrong.
    pub fn add(&mut self, field: Field, text: impl Into<String>) {
        self.0.push((field, text.into()));
    }

    /// What is wrong with a field.
    #[must_use]
    pub fn of(&self, field: Field) -> Option<&str> {
        let mut all = self.0.iter();
        let found = all.find(|(wrong, _)| *wrong == field);
        found.map(|(_, text)| text.as_str())
    }

    /// What is wrong first.
    #[must_use]
    pub fn first(&self) -> Option<(Field, &str)> {
        self.0.first().map(|(field, text)| (*field, text.as_str()))
    }

    /// The value of an answer, whose error belongs to a field.
    pub fn take<T>(&mut self, field: Field, answer: Result<T, String>) -> Option<T> {
        answer.map_err(|text| self.add(field, text)).ok()
    }
}

/// What the session has at present.
#[derive(Debug, Clone)]
pub struct Present {
    /// The robot.
    pub robot: Robot,
    /// How its controller is reached.
    pub connection: Connection,
    /// Where the laser distance comes from.
    pub laser: LaserSettings,
    /// Whether its simulated robot is that of a demonstration.
    pub is_demo: bool,
}

impl Present {
    /// What a session has.
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

/// What is typed.
#[derive(Debug)]
pub struct Draft {
    /// Id of the session that it belongs to.
    pub session_id: u64,
    /// The part that is shown.
    pub part: Part,
    /// Kind of controller.
    pub kind: ControllerKind,
    /// Folder of a recording.
    pub folder: String,
    /// Its speed.
    pub speed: String,
    /// Place of a controller that speaks ADS.
    pub host: String,
    /// Its TCP port.
    pub port: String,
    /// Its AMS Net ID.
    pub net_id: String,
    /// Its AMS port.
    pub ams_port: String,
    /// Timeout (s).
    pub timeout: String,
    /// Whether the names of the symbols are one's own.
    pub own: bool,
    /// Names of the symbols.
    pub symbols: SymbolRows,
    /// The laser.
    pub laser: LaserDraft,
    /// Why connecting failed last.
    pub refused: Option<String>,
    /// Whether the window closes once there is a connection.
    pub connects: bool,
}

impl Draft {
    /// The settings of a session; of what it does not have, those that were used last.
    #[must_use]
    pub fn of(session: &Session, session_id: u64, reached: &LastConnection) -> Self {
        let connection = &session.connection;
        let place = connection.place.clone().or_else(|| reached.place.clone());
        let number = |value: Option<f64>| format!("{}", value.unwrap_or(1.0));
        let text = |of: fn(&AdsPlace) -> String, usual: &str| {
            place.as_ref().map_or_else(|| usual.to_owned(), of)
        };
        let default = AdsMapping::default_for(&session.robot);
        let mapping = connection.ads.as_ref().unwrap_or(&default);
        let recording = connection.recording.as_ref();
        Self {
            session_id,
            part: Part::default(),
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
            own: connection.ads.is_some(),
            symbols: SymbolRows::of(mapping, &session.robot),
            laser: LaserDraft::of(&session.laser_source, &reached.laser),
            refused: None,
            connects: false,
        }
    }

    /// The settings that it makes, those of other kinds of controller as in the session.
    ///
    /// # Errors
    /// What is wrong with which field.
    pub fn settings(&self, present: &Present) -> Result<(Connection, LaserSettings), Problems> {
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
                connection.ads = self.mapping(&present.robot, &mut problems);
            }
        }
        let laser = self.laser.settings(&mut problems);
        match (problems.0.is_empty(), laser) {
            (true, Some(laser)) => Ok((connection, laser)),
            _ => Err(problems),
        }
    }

    /// Takes names of one's own.
    pub fn use_symbols(&mut self, mapping: &AdsMapping, robot: &Robot) {
        self.own = true;
        self.symbols = SymbolRows::of(mapping, robot);
    }

    fn recording(&self, problems: &mut Problems) -> Option<RecordingPlace> {
        let speed = parse_number(&self.speed);
        let speed = problems.take(Field::Speed, speed)?;
        let place = RecordingPlace {
            folder: self.folder.trim().to_owned(),
            speed,
        };
        let fields = [("/folder", Field::Folder), ("/speed", Field::Speed)];
        checked(place.check(), &fields, problems)?;
        Some(place)
    }

    /// Where the controller is found.
    pub fn place(&self, problems: &mut Problems) -> Option<AdsPlace> {
        let host = self.host.trim().to_owned();
        if host.is_empty() {
            let text = "found nothing, expected the name or address of the controller, such as 192.168.0.5";
            problems.add(Field::Host, text);
        }
        let port = problems.take(Field::Port, port(&self.port));
        let net_id = problems.take(Field::NetId, net_id(&self.net_id));
        let ams_port = problems.take(Field::AmsPort, self::port(&self.ams_port));
        let timeout_s = problems.take(Field::Timeout, parse_number(&self.timeout));
        let place = AdsPlace {
            host,
            port: port?,
            net_id: net_id?,
            ams_port: ams_port?,
            timeout_s: timeout_s?,
        };
        let fields = [("/host", Field::Host), ("/timeout_s", Field::Timeout)];
        if problems.of(Field::Host).is_none() {
            checked(place.check(), &fields, problems)?;
        }
        Some(place)
    }

    /// Names of the symbols; `None` where they are the usual ones or wrong.
    pub fn mapping(&self, robot: &Robot, problems: &mut Problems) -> Option<AdsMapping> {
        self.own.then(|| self.symbols.mapping(robot, problems))?
    }
}

fn checked(
    result: Result<(), FieldError>,
    fields: &[(&str, Field)],
    problems: &mut Problems,
) -> Option<()> {
    let error = match result {
        Ok(()) => return Some(()),
        Err(error) => error,
    };
    let found = fields.iter().find(|(at, _)| *at == error.pointer);
    let field = found.map_or(Field::Host, |(_, field)| *field);
    problems.add(field, error.message);
    None
}

/// A port.
///
/// # Errors
/// What was found and what was expected.
pub fn port(text: &str) -> Result<u16, String> {
    let number = text.trim().parse().ok().filter(|port| *port != 0);
    number.ok_or_else(|| format!("found \"{text}\", expected a number from 1 to 65535"))
}

/// Six numbers with points between them.
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
            ads: Some(AdsMapping::default_for(&session.robot)),
        };
        for kind in [
            ControllerKind::Ads,
            ControllerKind::Recording,
            ControllerKind::Simulated,
        ] {
            session.connection.controller = kind;
            let settings = draft(&session)
                .settings(&Present::of(&session))
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
            .settings(&Present::of(&session))
            .expect_err("no folder");
        assert!(problems.of(Field::Folder).is_some());
        draft.kind = ControllerKind::Ads;
        draft.net_id = "1.2.3".into();
        draft.port = "0".into();
        draft.timeout = "soon".into();
        let problems = draft.settings(&Present::of(&session)).expect_err("wrong");
        for field in [Field::Host, Field::Port, Field::NetId, Field::Timeout] {
            let text = problems.of(field).expect("a problem");
            assert!(text.contains("expected"), "{text}");
        }
        assert_eq!(problems.of(Field::AmsPort), None);
        draft.host = "plc".into();
        draft.net_id = "1.2.3.4.1.1".into();
        draft.port = "48898".into();
        draft.timeout = "2".into();
        let (connection, _) = draft.settings(&Present::of(&session)).expect("settings");
        assert_eq!(connection.place.map(|place| place.timeout_s), Some(2.0));
        assert_eq!(connection.ads, None, "the usual names");
    }
}
