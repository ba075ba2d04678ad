//! Files of Tautline: dataset folders, session files, model files.
//!
//! Every reader accepts bytes from any source and returns a valid value or a [`ReadError`](tautline_files::ReadError) of one
//! sentence; none panics, and the memory it needs is bounded by a fixed multiple of the size of its input. Every writer
//! replaces its file atomically.

mod atomic;
mod dataset;
mod error;
mod events_table;
mod fingerprint;
mod folders;
mod hypothesis_file;
mod import;
mod json;
mod opcua_key;
mod pem;
mod phases;
mod plan_table;
mod plots;
mod poses;
mod preferences;
mod recovery;
mod robot_file;
mod sensors;
mod session;
mod symbols_file;
mod table;
mod trusted_servers;
mod user_certificate;

pub use atomic::{ReservedFile, link_target, reserve, write_bytes, write_text};
pub use dataset::{
    DatasetFolder, read_calibration_tables, read_check_file, read_dataset, read_table_file,
    write_dataset,
};
pub use error::{Loaded, WriteError};
pub use events_table::{EVENTS, RobotEvent, read_events};
pub use fingerprint::Fingerprint;
pub use folders::Folders;
pub use hypothesis_file::{HypothesisFolder, add_hypothesis, parse_hypothesis, read_hypothesis};
pub use import::{Import, import, is_own};
pub use json::{
    Migration, Schema, VersionedFile, parse_versioned, parse_versioned_toml, read_versioned,
    read_versioned_toml, schema_for, versioned, versioned_schema, write_versioned,
};
pub use opcua_key::OpcUaKey;
pub use phases::{
    CheckKind, CheckPose, CheckRow, ElongationPoint, ForcePair, HomePose, HomeReading, PhaseData,
    PoseDistance, WinchPair, read_check, read_elongation, read_force, read_home, read_winch,
    write_check, write_elongation, write_force, write_home, write_winch,
};
pub use plan_table::{read_plan, write_plan};
pub use plots::{PlotArea, PlotShare, Plots};
pub use poses::{PoseColumns, PoseLines, pose_columns, read_poses, write_poses};
pub use preferences::{LastConnection, Layout, Preferences, RecentSession, Theme};
pub use recovery::{
    RecoveredSession, RecoveryWriter, SessionChanges, UnsavedSession, find_unsaved_sessions,
    remove_discarded,
};
pub use robot_file::{parse_robot, read_robot, write_robot};
pub use sensors::{Catalogue, CatalogueEntry, Growth, Sensor, SensorSource};
pub use session::{
    Acceptance, Adjustment, AdsPlace, AuditTrail, CalibratedInstrument, CertificateDetails,
    Connection, ControllerKind, DecisionRule, DiagnosisSettings, ForeignWrite,
    IdentificationSettings, LaserParity, LaserPort, LaserSettings, LaserUnit, LineLaserSettings,
    LogEntry, MeasuredPose, MeasuringWarning, Method, NamedValue, NotATimestamp, OpcUaPlace,
    OpcUaPolicy, OpcUaSecurity, Outcome, Phase, PlannedPose, RecordingPlace, ResultDocument,
    ResultRecord, RunValues, Session, Settings, Simulator, Stage, StoppedVerification,
    SymbolCommand, SymbolList, SymbolMapping, SymbolNames, SymbolParameter, SymbolPose,
    SymbolReadings, SymbolRotation, SymbolStatus, SymbolValue, Timestamp, TrailAuthor, TrailEntry,
    TrailFault, TrailPart, TrailRecord, UntilSettings, UserCertificateFiles, ValueChange,
    Verification, day, is_per_cable, name_of_cable, parse_session, read_session, without_user,
    write_session,
};
pub use symbols_file::{parse_symbols, read_symbols, write_symbols};
pub use table::{csv_row, escape_formula};
pub use trusted_servers::{CertificateFingerprint, NotAFingerprint, TrustedServers};
pub use user_certificate::exposed_key;

/// The JSON Schemas of all files that are read.
#[must_use]
pub fn schemas() -> Vec<Schema> {
    vec![
        versioned_schema::<tautline_core::robot::Robot>(),
        versioned_schema::<session::SessionFile>(),
        versioned_schema::<SymbolMapping>(),
        versioned_schema::<Sensor>(),
        versioned_schema::<CertificateDetails>(),
    ]
}
