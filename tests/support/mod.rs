//! Support shared by suites, generators and tables: test controllers, the built program, and the window without a display.

pub mod ads;
pub mod bad_input_cases;
pub mod console_page;
pub mod decisions;
pub mod harness;
pub mod keyring;
pub mod phase_tables;
pub mod process;
pub mod program;
pub mod python;
pub mod window;
