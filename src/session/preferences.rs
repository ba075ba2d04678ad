//! Preferences of the user and recent sessions.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::robot::FieldError;

use crate::error::{Loaded, WriteError, below, fail};
use crate::json::{Migration, VersionedFile, read_versioned, write_versioned};
use crate::plots::Plots;
use crate::session::{
    AdsPlace, CalibratedInstrument, LaserSettings, OpcUaPlace, Session, Timestamp,
};

/// Largest number of recent sessions.
const MAX_RECENT: usize = 12;
/// Smallest and largest scale of the interface.
const SCALES: [f64; 2] = [0.5, 4.0];

/// Settings that belong to the user rather than to a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Preferences {
    /// Colours of the interface.
    pub theme: Theme,
    /// Size of text and controls relative to the default of the screen.
    pub interface_scale: f64,
    /// Width and height of the window when it was last closed, in points.
    pub window_size: Option<[f64; 2]>,
    /// Sizes of the parts of the window.
    pub layout: Layout,
    /// Arrangement of the plots.
    pub plots: Plots,
    /// Content of reports.
    pub report: Report,
    /// Settings of the last connection to a controller.
    #[serde(alias = "reached", skip_serializing_if = "LastConnection::is_empty")]
    pub last_connection: LastConnection,
    /// Name of the operator, for the log of adjustments and the report.
    pub operator: String,
    recent: Vec<RecentSession>,
}

/// Colours of the interface.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Theme {
    /// Theme of the operating system.
    #[default]
    System,
    /// Dark.
    Dark,
    /// Light.
    Light,
}

/// Sizes of the parts of the window, if changed by the user.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Layout {
    /// Width of the phase panel (points).
    pub panel_width: Option<f64>,
    /// Height of the plots (points).
    pub plots_height: Option<f64>,
}

/// Content of reports.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Report {
    /// The customer.
    pub company: String,
    /// Line above the title.
    pub header: String,
    /// Names of the parts to leave out; unknown names are ignored.
    pub without: Vec<String>,
    /// Name and address of the laboratory that issues certificates.
    pub laboratory: String,
    /// Its country: two letters of ISO 3166-1.
    pub country: String,
    /// Instruments of the workshop, from which each session chooses.
    pub instruments: Vec<CalibratedInstrument>,
}

/// Settings of the last connection, proposed for sessions without settings of their own.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct LastConnection {
    /// Address of the last ADS controller.
    pub place: Option<AdsPlace>,
    /// Address of the last OPC UA controller.
    pub opcua: Option<OpcUaPlace>,
    /// Source of the laser distance.
    pub laser: LaserSettings,
}

impl LastConnection {
    /// Whether no connection is stored.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// A recently opened session.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct RecentSession {
    /// Its file.
    path: String,
    /// Its name.
    pub name: String,
    /// Time when it was last open.
    pub when: Timestamp,
    /// Name of its robot, with the serial number if it has one; absent in files of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Time of its last measurement, if it had any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<Timestamp>,
    /// How it stands, in a few words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<String>,
    /// Lines of its cables for a small picture: x and y of both ends, from 0 to 1000, y downwards.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outline: Vec<[i16; 4]>,
}

impl RecentSession {
    /// The entry of a session; `None` if its path is not valid Unicode.
    #[must_use]
    pub fn of(path: &Path, session: &Session, when: Timestamp) -> Option<Self> {
        Some(Self {
            path: absolute(path)?,
            name: session.name.clone(),
            when,
            robot: Some(session.robot.label()),
            measured: session.measured(),
            verdict: None,
            outline: Vec::new(),
        })
    }

    /// Its file.
    #[must_use]
    pub fn path(&self) -> &Path {
        Path::new(&self.path)
    }

    /// Whether the file exists.
    #[must_use]
    pub fn exists(&self) -> bool {
        self.path().is_file()
    }
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            theme: Theme::default(),
            interface_scale: 1.0,
            window_size: None,
            layout: Layout::default(),
            plots: Plots::default(),
            report: Report::default(),
            last_connection: LastConnection::default(),
            operator: String::new(),
            recent: Vec::new(),
        }
    }
}

impl VersionedFile for Preferences {
    const FORMAT: &'static str = "tautline-preferences";
    const VERSION: u32 = 2;
    const MIGRATIONS: &'static [Migration] = &[Plots::MIGRATION];
    const MAX_BYTES: u64 = 1 << 20;

    fn check(&self) -> Result<(), FieldError> {
        let [smallest, largest] = SCALES;
        let scale = self.interface_scale;
        if !(smallest..=largest).contains(&scale) {
            let message = format!("found {scale}, expected a number from {smallest} to {largest}");
            return fail("/interface_scale", message);
        }
        let is_size = |length: &f64| length.is_finite() && *length > 0.0;
        for (pointer, length) in [
            ("/layout/panel_width", self.layout.panel_width),
            ("/layout/plots_height", self.layout.plots_height),
        ] {
            if let Some(length) = length.filter(|length| !is_size(length)) {
                return fail(pointer, format!("found {length}, expected a length"));
            }
        }
        self.plots.check().map_err(|error| below("/plots", error))?;
        let last = &self.last_connection;
        let place = last.place.as_ref().map_or(Ok(()), AdsPlace::check);
        place.map_err(|error| below("/last_connection/place", error))?;
        let place = last.opcua.as_ref().map_or(Ok(()), OpcUaPlace::check);
        place.map_err(|error| below("/last_connection/opcua", error))?;
        let laser = last.laser.check();
        laser.map_err(|error| below("/last_connection/laser", error))?;
        match self.window_size {
            Some(size) if !size.iter().all(is_size) => {
                let message = format!("found {size:?}, expected a width and a height");
                fail("/window_size", message)
            }
            _ => Ok(()),
        }
    }
}

impl Preferences {
    /// Reads the preferences. If the file does not exist, they are the defaults; if it cannot be read,
    /// they are the defaults with a notice.
    #[must_use]
    pub fn load(path: &Path) -> Loaded<Self> {
        let defaults = |notices| Loaded {
            value: Self::default(),
            notices,
        };
        if matches!(path.try_exists(), Ok(false)) {
            return defaults(Vec::new());
        }
        match read_versioned::<Self>(path) {
            Ok(mut loaded) => {
                loaded.value.recent.truncate(MAX_RECENT);
                loaded
            }
            Err(error) => defaults(vec![format!("{error}; the default preferences are used")]),
        }
    }

    /// Writes the preferences atomically; the folder is created if necessary.
    ///
    /// # Errors
    /// If a number is invalid or the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), WriteError> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| WriteError::io(folder, error))?;
        }
        write_versioned(path, self)
    }

    /// Recently opened sessions, the latest first; their files may no longer exist.
    #[must_use]
    pub fn recent(&self) -> &[RecentSession] {
        &self.recent
    }

    /// Adds a session as the latest.
    pub fn remember(&mut self, recent: RecentSession) {
        self.recent.retain(|other| other.path != recent.path);
        self.recent.insert(0, recent);
        self.recent.truncate(MAX_RECENT);
    }

    /// Removes a session from the recent ones.
    pub fn forget(&mut self, path: &Path) {
        let path = absolute(path);
        self.recent
            .retain(|recent| Some(&recent.path) != path.as_ref());
    }
}

fn absolute(path: &Path) -> Option<String> {
    let path = std::path::absolute(path).ok()?;
    path.to_str().map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plots::{PlotArea, PlotShare};
    use crate::session::tests::session;

    fn tabs(plots: &[&str]) -> PlotArea {
        PlotArea::Tabs {
            plots: plots.iter().map(ToString::to_string).collect(),
            shown: plots.first().map(ToString::to_string),
        }
    }

    fn at(seconds: i64) -> Timestamp {
        Timestamp::from_unix_seconds(seconds)
    }

    fn entry(path: &Path, seconds: i64) -> RecentSession {
        RecentSession::of(path, &session(), at(seconds)).expect("a path of letters")
    }

    #[test]
    fn preferences_read_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("new/preferences.json");
        let mut preferences = Preferences {
            theme: Theme::Dark,
            interface_scale: 1.5,
            window_size: Some([1280.0, 800.0]),
            layout: Layout {
                panel_width: Some(500.0),
                plots_height: None,
            },
            plots: Plots {
                area: Some(PlotArea::Row(vec![
                    PlotShare {
                        share: 0.25,
                        area: tabs(&["laser", "variable"]),
                    },
                    PlotShare {
                        share: 0.75,
                        area: tabs(&["residuals"]),
                    },
                ])),
                detached: vec!["scope".into()],
            },
            operator: "B. Smith".into(),
            ..Preferences::default()
        };
        preferences.remember(entry(&folder.path().join("a.json"), 1));
        preferences.save(&path).expect("written");
        let loaded = Preferences::load(&path);
        assert_eq!((loaded.value, loaded.notices), (preferences, Vec::new()));
    }

    #[test]
    fn no_file_is_no_news_and_a_broken_one_is_no_error() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("preferences.json");
        let loaded = Preferences::load(&path);
        assert_eq!(
            (loaded.value, loaded.notices.len()),
            (Preferences::default(), 0)
        );
        let head = r#"{"format": "tautline-preferences", "version": "#;
        for (text, pointer) in [
            ("", "empty file"),
            ("{", "cut off"),
            (&format!("{head}3}}"), "/version"),
            (&format!("{head}1, \"theme\": \"pink\"}}"), "/theme"),
            (
                &format!("{head}1, \"interface_scale\": 0}}"),
                "/interface_scale",
            ),
            (
                &format!("{head}1, \"window_size\": [0, 1]}}"),
                "/window_size",
            ),
            (
                &format!("{head}1, \"layout\": {{\"plots_height\": -1}}}}"),
                "/layout/plots_height",
            ),
            (
                &format!(
                    "{head}2, \"plots\": {{\"area\": {{\"row\": [{{\"share\": 0, \"area\": {{\"row\": []}}}}]}}}}}}"
                ),
                "/plots/area/row/0/share",
            ),
        ] {
            std::fs::write(&path, text).expect("written");
            let loaded = Preferences::load(&path);
            assert_eq!(loaded.value, Preferences::default());
            assert_eq!(loaded.notices.len(), 1);
            assert!(loaded.notices[0].contains(pointer), "{:?}", loaded.notices);
        }
        std::fs::write(&path, format!("{head}1}}")).expect("written");
        assert_eq!(Preferences::load(&path).value, Preferences::default());
    }

    #[test]
    fn a_file_of_an_earlier_version_is_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("preferences.json");
        let text = r#"{"format": "tautline-preferences", "version": 1,
            "reached": {"place": {"host": "plc", "net_id": [5, 23, 9, 1, 1, 1]}},
            "recent": [{"path": "/a.json", "name": "Monday", "when": "2018-07-23T09:05:00Z"}]}"#;
        std::fs::write(&path, text).expect("written");
        let loaded = Preferences::load(&path);
        assert_eq!(loaded.notices, Vec::<String>::new());
        assert_eq!(loaded.value.recent()[0].robot, None);
        let place = loaded.value.last_connection.place.expect("a place");
        assert_eq!(place.host, "plc");
    }

    #[test]
    fn the_grid_of_plots_of_version_1_gives_way_to_the_usual_arrangement() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("preferences.json");
        let text = r#"{"format": "tautline-preferences", "version": 1, "operator": "B. Smith",
            "plots": {"arrangement": "side-by-side", "panes": ["laser"]}}"#;
        std::fs::write(&path, text).expect("written");
        let loaded = Preferences::load(&path);
        assert_eq!(loaded.notices, Vec::<String>::new());
        assert_eq!(loaded.value.plots, Plots::default());
        assert_eq!(loaded.value.operator, "B. Smith");
    }

    #[test]
    fn recent_sessions_come_latest_first_and_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |k: usize| folder.path().join(format!("{k}.json"));
        let mut preferences = Preferences::default();
        for k in 0..20 {
            preferences.remember(entry(&path(k), k as i64));
        }
        preferences.remember(entry(&path(15), 30));
        std::fs::write(path(15), "").expect("written");
        let recent = preferences.recent();
        assert_eq!(recent[0].robot.as_deref(), Some("two"));
        assert_eq!(recent[0].measured, session().measured());
        assert_eq!(recent.len(), MAX_RECENT);
        assert_eq!(
            (recent[0].path(), recent[0].when),
            (path(15).as_path(), at(30))
        );
        assert!(recent[0].exists() && !recent[1].exists());
        assert_eq!(recent[1].path(), path(19));
        assert_eq!(recent.iter().filter(|r| r.path() == path(15)).count(), 1);
        preferences.forget(&path(19));
        assert_eq!(preferences.recent()[1].path(), path(18));
    }
}
