//! All operations on a session, without a user interface: identification, diagnosis, planning, adjustment,
//! comparison, verification, the tables of the first phases, reports, result documents and their wording. Commands and window
//! build on these.

pub mod accuracy;
pub mod adjusting;
pub mod audit;
pub mod clock;
pub mod column;
pub mod comparison;
pub mod controllers;
pub mod diagnosis;
pub mod effects;
pub mod exporting;
pub mod fonts;
pub mod foreign_writes;
pub mod formulas;
pub mod health;
pub mod history;
pub mod identification;
pub mod importing;
pub mod isolability;
pub mod machines;
pub mod planning;
pub mod plot;
pub mod precalibration;
pub mod readiness;
pub mod replay;
pub mod report;
pub mod results;
pub mod samples;
pub mod sequential;
pub mod session_file;
pub mod signature;
pub mod templates;
pub mod tolerances;
pub mod wording;
