//! Helpers of the cross-crate suites.

pub mod adjusted;
pub mod ads;
pub mod bad_input_cases;
pub mod console_page;
pub mod hangprinter;
pub mod harness;
pub mod hidden;
pub mod hypotheses;
pub mod isolability;
pub mod live_readings;
pub mod lives;
pub mod many_poses;
pub mod motion;
pub mod nist;
pub mod program;
pub mod screenshots;
pub mod sessions;
pub mod study_speed;
pub mod table1;
pub mod tables;
pub mod tolerances;
pub mod truth;
pub mod until;
pub mod which_sensor;
pub mod window;
pub mod your_data;
