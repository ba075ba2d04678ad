//! The compiled part of the Python package `tautline`.
//!
//! Robots and results cross as the JSON of the commands, measured poses as the text of `poses.csv`: both have one reader, with
//! its checks and sentences. The modules of `tautline/` make arrays and dataclasses of them.

mod boundary;
mod computing;
mod files;
mod fitting;
mod importing;
mod study;
mod table;

use pyo3::prelude::*;

#[pymodule]
mod _tautline {
    #[pymodule_export]
    use super::boundary::TautlineError;
    #[pymodule_export]
    use super::computing::{
        check, check_health, compare, diagnose, effects, history, parse_effect, plan, predict,
        replay, simulate,
    };
    #[pymodule_export]
    use super::files::{
        check_poses, checked_robot, export, precalibrate, preset, presets_names, read_dataset,
        read_robot, read_session, report, write_dataset, write_robot,
    };
    #[pymodule_export]
    use super::fitting::{fit_tables, identify};
    #[pymodule_export]
    use super::importing::{channels, import_readings, import_robot, robot_of_places};
    #[pymodule_export]
    use super::study::{
        merge_study, plan_study, read_study, report_study, run_study, study_calibrations,
        study_from_toml,
    };
    #[pymodule_export]
    const USUAL_POSES: usize = tautline_core::planning::USUAL_POSES;
    #[pymodule_export]
    const LEVEL: f64 = tautline_workflow::comparison::LEVEL;
    #[pymodule_export]
    const TIME_LIMIT_S: f64 = tautline_workflow::diagnosis::TIME_LIMIT_S;
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // as Python calls it
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
