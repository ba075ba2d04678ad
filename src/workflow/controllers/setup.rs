//! Setup of the connection to a session's controller.

use std::path::{Path, PathBuf};

use tautline_core::effect::{EffectSetting, find};
use tautline_core::robot::Robot;
use tautline_core::simulation::{TensionRange, Workspace, draw_deviations};
use tautline_link::ads::{AdsAddress, AdsOptions};
use tautline_link::opcua::{Account, Credentials, OpcUaAddress, OpcUaOptions, OpcUaServer};
use tautline_link::simulated::SimulatedSetup;
use tautline_link::{LastState, Limits, LinkProtection};
use tautline_session::{
    Connection, ControllerKind, Folders, LaserSettings, Session, SymbolMapping,
    UserCertificateFiles, exposed_key,
};

use super::choice::ControllerChoice;

/// Kind of robot behind a connection: simulated, recorded or real.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RobotKind {
    /// The simulated robot of the session, which also gave its readings.
    OfSession,
    /// A robot simulated from the description only; its readings say nothing about a real robot.
    OfDescription,
    /// A played-back recording.
    Recording,
    /// A real robot.
    Real,
}

impl RobotKind {
    /// Kind of robot by the settings of a session.
    #[must_use]
    pub fn offered(session: &Session) -> Self {
        match session.connection.controller {
            ControllerKind::Simulated => Self::simulated(session),
            ControllerKind::Recording => Self::Recording,
            ControllerKind::Ads | ControllerKind::OpcUa => Self::Real,
        }
    }

    fn simulated(session: &Session) -> Self {
        match session.simulator {
            Some(_) => Self::OfSession,
            None => Self::OfDescription,
        }
    }
}

/// Setup of a connection.
#[derive(Debug, Clone)]
pub struct ConnectionSetup {
    /// Kind of robot.
    pub kind: RobotKind,
    pub(super) source: Source,
    /// File in which a simulated controller saves its values while they are written.
    pub(super) values_file: Option<PathBuf>,
    pub(super) limits: Limits,
    /// State of the controller when the last pose of the session was measured.
    pub(super) seen: Option<LastState>,
    pub(super) laser: LaserSettings,
    /// Number of home pose measurements in the session, so that a simulated instrument continues with new noise.
    pub(super) home_measurements: usize,
}

/// Source of the readings.
#[derive(Debug, Clone)]
pub(super) enum Source {
    Simulated(Box<SimulatedSetup>),
    Replay(PathBuf),
    Ads(AdsAddress, Box<SymbolMapping>, AdsOptions),
    OpcUa(Box<OpcUaServer>, Box<SymbolMapping>),
}

/// Symbols and options for ADS from settings; without symbols, those of the sample program.
pub(super) fn ads_parts(connection: &Connection, robot: &Robot) -> (SymbolMapping, AdsOptions) {
    let own = connection.ads.clone();
    let mut options = AdsOptions::default();
    let place = connection.place.as_ref();
    options.timeout_s = place.map_or(options.timeout_s, |place| place.timeout_s);
    (
        own.unwrap_or_else(|| SymbolMapping::default_for(robot)),
        options,
    )
}

/// Server and symbols for OPC UA from settings.
pub(super) fn opcua_parts(
    address: &OpcUaAddress,
    connection: &Connection,
    robot: &Robot,
) -> (OpcUaServer, SymbolMapping) {
    let own = connection.nodes.clone();
    let mut options = OpcUaOptions::default();
    let place = connection.opcua.as_ref();
    options.timeout_s = place.map_or(options.timeout_s, |place| place.timeout_s);
    let server = OpcUaServer {
        address: address.clone(),
        options,
        credentials: Credentials::default(),
    };
    (
        server,
        own.unwrap_or_else(|| SymbolMapping::default_nodes_for(robot)),
    )
}

impl Source {
    /// Symbols of a real controller.
    fn mapping(&self) -> Option<&SymbolMapping> {
        match self {
            Self::Ads(_, mapping, _) | Self::OpcUa(_, mapping) => Some(mapping),
            Self::Simulated(_) | Self::Replay(_) => None,
        }
    }
}

/// Longest possible delay of a message over a lost connection, as a multiple of the timeout of a response.
const LATE: f64 = 1.5;
/// Seed of the deviations and the noise of a robot simulated from its description.
const SEED: u64 = 1;

impl ConnectionSetup {
    /// The controller in a session's settings; a simulated one can correct the effects of its robot, of the model and
    /// those `identified`.
    #[must_use]
    pub fn of(session: &Session, identified: &[EffectSetting]) -> Self {
        Self::chosen(session, identified, &ControllerChoice::of(session), None)
    }

    /// A controller chosen for a session. A simulated one corrects the effects stated at [`ConnectionSetup::of`], and
    /// stores its values in the file `values_file` from the first write on.
    #[must_use]
    pub fn chosen(
        session: &Session,
        identified: &[EffectSetting],
        choice: &ControllerChoice,
        values_file: Option<&Path>,
    ) -> Self {
        let limits = Limits::of(&session.robot);
        let (kind, source) = match choice {
            ControllerChoice::Simulated => {
                let setup = setup_of(session, identified, &limits);
                let kind = RobotKind::simulated(session);
                (kind, Source::Simulated(Box::new(setup)))
            }
            ControllerChoice::Replay(path) => (RobotKind::Recording, Source::Replay(path.clone())),
            ControllerChoice::Ads(address) => {
                let (mapping, options) = ads_parts(&session.connection, &session.robot);
                let source = Source::Ads(address.clone(), Box::new(mapping), options);
                (RobotKind::Real, source)
            }
            ControllerChoice::OpcUa(address) => {
                let (server, mapping) = opcua_parts(address, &session.connection, &session.robot);
                let source = Source::OpcUa(Box::new(server), Box::new(mapping));
                (RobotKind::Real, source)
            }
        };
        Self {
            kind,
            values_file: values_file.map(Path::to_owned),
            seen: source.mapping().and_then(|mapping| seen(session, mapping)),
            source,
            limits,
            laser: session.laser_source.clone(),
            home_measurements: session.phases.home_poses.len(),
        }
    }

    /// The same with the credentials of the client for the server.
    #[must_use]
    pub fn with_credentials(mut self, credentials: Credentials) -> Self {
        if let Source::OpcUa(server, _) = &mut self.source {
            server.credentials = credentials;
        }
        self
    }

    /// Whether the server of the controller may ask for a user name and a password or certificate.
    #[must_use]
    pub fn asks_who_connects(&self) -> bool {
        matches!(self.source, Source::OpcUa(..))
    }

    /// The user at the server, whose password is required.
    #[must_use]
    pub fn account(&self) -> Option<Account> {
        match &self.source {
            Source::OpcUa(server, _) => server.address.account(),
            _ => None,
        }
    }

    /// The files of the user at the server, if it is known by a certificate.
    #[must_use]
    pub fn user_certificate(&self) -> Option<&UserCertificateFiles> {
        match &self.source {
            Source::OpcUa(server, _) => server.address.user_certificate.as_ref(),
            _ => None,
        }
    }

    /// Warnings about the connection to a real controller, one sentence each.
    #[must_use]
    pub fn warnings(&self, protection: Option<&LinkProtection>) -> Vec<String> {
        let Some(mapping) = self.source.mapping() else {
            return Vec::new();
        };
        let lacks = |is_lacking: bool, text: &str| is_lacking.then(|| text.to_owned());
        let found = [
            lacks(
                protection == Some(&LinkProtection::Open),
                "the connection is not encrypted: everybody on its network can read and change what is sent",
            ),
            lacks(
                mapping.release.is_none(),
                "the mapping has no release: neither a switch at the robot nor another program that is armed is noticed",
            ),
            lacks(
                mapping.watchdog.is_none(),
                "the mapping has no watchdog: the controller does not notice that this program has ended, nor this program that another one is armed",
            ),
        ];
        let own = Folders::of_user().map(|folders| folders.opcua_key());
        let users = self
            .user_certificate()
            .map(|files| files.key.clone().into());
        let keys = own.into_iter().chain(users);
        let exposed = keys.filter_map(|key| exposed_key(&key));
        found.into_iter().flatten().chain(exposed).collect()
    }

    /// Whether motion is limited to real time, as for a real controller.
    #[must_use]
    pub fn runs_in_real_time(&self) -> bool {
        self.kind == RobotKind::Real
    }

    /// Whether a lost connection is restored, as for a real controller.
    #[must_use]
    pub fn reconnects(&self) -> bool {
        self.kind == RobotKind::Real
    }

    /// Time after which nothing that was sent over a lost connection can still arrive (s): longer than the timeout of a
    /// response.
    #[must_use]
    pub fn late_s(&self) -> f64 {
        LATE * match &self.source {
            Source::Ads(_, _, options) => options.timeout_s,
            Source::OpcUa(server, _) => server.options.timeout_s,
            Source::Simulated(_) | Source::Replay(_) => 0.0,
        }
    }

    /// Whether an external instrument observes the robot; otherwise the user enters the poses.
    #[must_use]
    pub fn has_instrument(&self) -> bool {
        matches!(self.source, Source::Simulated(_))
    }

    /// Whether the controller has parameters for an effect, so that it can correct for it.
    #[must_use]
    pub fn corrects(&self, setting: &EffectSetting) -> bool {
        let Source::Simulated(setup) = &self.source else {
            return false;
        };
        let mut known = setup.nominal.effects.iter();
        known.any(|known| same(known, setting))
    }

    /// The robot as described, without the values of the controller.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.limits.robot
    }

    /// Limits for the distribution of tensions.
    #[must_use]
    pub fn tension(&self) -> TensionRange {
        self.limits.tension
    }

    /// Workspace to which the platform may be commanded.
    #[must_use]
    pub fn workspace(&self) -> &Workspace {
        &self.limits.workspace
    }
}

/// The state of the controller according to the last measured pose of a session. A simulated one is created anew for every
/// connection, at home and with its clock at 0.
fn seen(session: &Session, mapping: &SymbolMapping) -> Option<LastState> {
    let measured = &session.measurements;
    let row = measured.len().checked_sub(1)?;
    // A controller without a clock uses the time of the connection.
    let has_clock = mapping.readings.time.is_some();
    let time_s = measured.time_s.get(row).copied();
    Some(LastState {
        time_s: time_s.filter(|time_s| has_clock && time_s.is_finite()),
        started: session.controller_started,
        resting: measured.commanded.get(row).copied().flatten(),
        revolutions: match measured.revolutions.is_empty() {
            true => Vec::new(),
            false => measured.revolutions.row(row).to_vec(),
        },
        was_away: true,
    })
}

fn setup_of(session: &Session, identified: &[EffectSetting], limits: &Limits) -> SimulatedSetup {
    let parameters: Vec<(String, f64)> = session
        .controller
        .iter()
        .map(|held| (held.name.clone(), held.value))
        .collect();
    let mut nominal = session.robot.clone();
    let held = parameters.iter().filter_map(|(name, _)| effect_of(name));
    let model = session.settings.identification.effects.iter();
    let wanted: Vec<EffectSetting> = held.chain(model.chain(identified).map(neutral)).collect();
    for setting in wanted {
        let is_it = |known: &EffectSetting| same(known, &setting);
        if !nominal.effects.iter().any(is_it) {
            nominal.effects.push(setting);
        }
    }
    let (truth, seed) = match &session.simulator {
        Some(simulator) => (simulator.truth.clone(), simulator.seed),
        None => (as_built(&session.robot), SEED),
    };
    let half_extents_m = limits.workspace.half_extent_m;
    let velocity_m_s = half_extents_m.into_iter().fold(0.0, f64::max);
    let velocity_m_s = velocity_m_s.clamp(0.1, 2.0);
    SimulatedSetup {
        parameters,
        tension: limits.tension,
        velocity_m_s,
        acceleration_m_s2: 5.0 * velocity_m_s,
        // A run that continues after a break needs new noise.
        ..SimulatedSetup::new(nominal, truth, seed_after(seed, session.measurements.len()))
    }
}

/// A machine built from a description: its parts deviate within the stated tolerances.
fn as_built(robot: &Robot) -> Robot {
    Robot {
        deviations: draw_deviations(robot, SEED),
        ..robot.clone()
    }
}

/// The seed of a run that starts after `poses` measured poses.
pub(super) fn seed_after(seed: u64, poses: usize) -> u64 {
    // An odd factor, so that no two counts share a seed: the fractional bits of the golden ratio.
    seed.wrapping_add((poses as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

fn same(a: &EffectSetting, b: &EffectSetting) -> bool {
    a.effect == b.effect && a.targets == b.targets
}

/// The same effect at neutral values.
fn neutral(setting: &EffectSetting) -> EffectSetting {
    let parameters = find(&setting.effect).map_or(&[][..], |effect| effect.parameters());
    EffectSetting {
        parameters: parameters
            .iter()
            .map(|parameter| (parameter.name.to_owned(), parameter.neutral))
            .collect(),
        ..setting.clone()
    }
}

/// The effect that a parameter of a controller belongs to, neutral.
fn effect_of(name: &str) -> Option<EffectSetting> {
    let (effect, rest) = name.strip_prefix("effect.")?.split_once('.')?;
    let targets = rest.rsplit_once('.').map(|(targets, _)| targets);
    let targets = targets.map_or_else(Vec::new, |targets| {
        targets.split('+').map(str::to_owned).collect()
    });
    Some(neutral(&EffectSetting {
        effect: effect.to_owned(),
        targets,
        parameters: Default::default(),
    }))
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::{PartTolerances, presets};
    use tautline_session::{NamedValue, Timestamp};

    use super::*;

    #[test]
    fn limits_follow_the_description_whatever_the_robot_is_called() {
        let preset = presets::find("mini").expect("a preset");
        let mut robot = preset.robot;
        robot.name = "another".into();
        let session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
        let setup = ConnectionSetup::of(&session, &[]);
        assert_eq!(setup.tension(), preset.tension);
        assert_eq!(*setup.workspace(), preset.workspace);
        // Sensors that read twice the tension.
        assert!(setup.limits.check_forces(&[310.0; 8], &[]).is_ok());
        let refused = setup.limits.check_forces(&[500.0; 8], &[]);
        let refused = refused.expect_err("250 N").to_string();
        assert!(
            refused.contains("pulls with 250 N, at most 150 N"),
            "{refused}"
        );
    }

    #[test]
    fn a_robot_of_a_description_has_parts_within_their_tolerances() {
        let mut robot = presets::find("mini").expect("a preset").robot;
        robot.tolerances = Some(PartTolerances::typical());
        let session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
        let rig = ConnectionSetup::of(&session, &[]);
        let Source::Simulated(setup) = &rig.source else {
            panic!("a session offers a simulated robot");
        };
        let deviations = &setup.truth.deviations;
        let of_drums = deviations.iter().filter(|d| d.effect == "winch_scale");
        assert_eq!(of_drums.count(), 8);
        assert!(setup.nominal.deviations.is_empty());
        // The next connection is to the same machine.
        let again = ConnectionSetup::of(&session, &[]);
        let Source::Simulated(again) = &again.source else {
            panic!("a session offers a simulated robot");
        };
        assert_eq!(again.truth, setup.truth);
    }

    #[test]
    fn what_a_connection_lacks_is_said() {
        let robot = presets::find("mini").expect("a preset").robot;
        let mut session = Session::new("test", robot.clone(), Timestamp::from_unix_seconds(0));
        let choice: ControllerChoice = "ads:plc/1.2.3.4.1.1".parse().expect("an address");
        let said = |session: &Session, protection| {
            let setup = ConnectionSetup::chosen(session, &[], &choice, None);
            let said = setup.warnings(Some(&protection)).join("; ");
            ["not encrypted", "no release", "no watchdog"].map(|part| said.contains(part))
        };
        let protected = || LinkProtection::Protected("signed".to_owned());
        assert_eq!(said(&session, protected()), [false; 3]);
        assert_eq!(said(&session, LinkProtection::Open), [true, false, false]);
        let mut mapping = SymbolMapping::default_for(&robot);
        (mapping.release, mapping.watchdog) = (None, None);
        session.connection.ads = Some(mapping);
        assert_eq!(said(&session, protected()), [false, true, true]);
        let simulated = ConnectionSetup::of(&session, &[]);
        assert!(simulated.warnings(None).is_empty());
    }

    #[test]
    fn a_controller_keeps_the_effects_it_held() {
        let robot = presets::find("mini").expect("a preset").robot;
        let mut session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
        session.controller = vec![
            NamedValue {
                name: "effect.winch_scale.cable-3.scale".into(),
                value: 0.01,
            },
            NamedValue {
                name: "effect.laser_scale.scale".into(),
                value: 0.002,
            },
        ];
        let rig = ConnectionSetup::of(&session, &[]);
        let setting = |effect: &str, targets: &[&str]| EffectSetting {
            effect: effect.into(),
            targets: targets.iter().map(|t| (*t).to_owned()).collect(),
            parameters: Default::default(),
        };
        assert_eq!(rig.kind, RobotKind::OfDescription);
        assert!(rig.corrects(&setting("winch_scale", &["cable-3"])));
        assert!(rig.corrects(&setting("laser_scale", &[])));
        assert!(!rig.corrects(&setting("winch_scale", &["cable-4"])));
        let Source::Simulated(setup) = &rig.source else {
            panic!("a session offers a simulated robot");
        };
        assert!(setup.nominal.check().is_ok());
    }
}
