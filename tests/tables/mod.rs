//! The tables of docs/validation.

pub mod adjusted;
pub mod certificate;
pub mod damaged_files;
pub mod field;
pub mod formulas;
pub mod hangprinter;
pub mod health;
pub mod hidden;
pub mod hypothesis_files;
pub mod isolability;
pub mod kills;
pub mod live_readings;
pub mod lives;
pub mod many_poses;
pub mod motion;
pub mod nist;
pub mod parallel;
pub mod random_robots;
pub mod soak;
pub mod study_speed;
pub mod table1;
pub mod tolerances;
pub mod truth;
pub mod until;
pub mod which_sensor;
