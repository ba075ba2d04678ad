//! Import of foreign files: logs, motion capture, point lists and spreadsheets as datasets, and robot descriptions.
//!
//! A **source** is a file with **series** of **channels** (`tautline_channels`). A **recipe** assigns channels to quantities of the robot, with unit, factor, offset and sign. **Cutting** turns rows into poses: every
//! row, rows of one label, or standstills. Notices report what was not understood; nothing is dropped silently.

mod actuators;
mod alignment;
mod check;
mod commands;
mod coverage;
mod cutting;
mod document;
mod draft;
mod external;
mod importing;
mod median;
mod naming;
mod orientation;
mod outline;
mod proposal;
mod recipe;
mod robot_files;
mod robots;
mod sources;
mod turning;

pub use alignment::{AlignedClock, ClockFit, align_clocks};
pub use check::{Change, Line, Mistake, Suggestion, TableCheck, check_table};
pub use coverage::channel_names;
pub use document::{
    ChannelReport, ImportDocument, PoseReport, Reading, SeriesReport, SourceReport,
};
pub use draft::{Draft, clock_times, uses};
pub use importing::{ImportError, Imported, found, import, import_corrected};
pub use naming::pattern_of;
pub use orientation::arrange_per_cable;
pub use outline::outline;
pub use proposal::{propose, propose_around};
pub use recipe::{
    AngleOrder, Angles, Assignment, Clock, Cutting, Instrument, Placement, Quantity, QuantityKind,
    Recipe, Rest, Step, read_recipe,
};
pub use robot_files::{is_robot_description, read_robot_description};
pub use robots::{
    Dialect, ForeignRobot, Meaning, Parameter, PartPlaces, Setting, read_description_text,
};
pub use sources::{read_source, read_sources};

#[cfg(test)]
mod tests;
