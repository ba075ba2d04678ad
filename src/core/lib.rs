//! The numerical core of Tautline: kinematics of cable-driven parallel robots, models of their cables and
//! instruments, estimation of their geometry and its uncertainty, and diagnosis of model errors.
//!
//! This crate opens no file, reads no clock, draws nothing and starts no thread that outlives
//! the call. SI units throughout; frames are in the names (`base_from_platform`, `anchor_in_base`).
//!
//! # Example
//!
//! Simulate a calibration run and identify the robot from it:
//!
//! ```
//! use tautline_core::estimation::{Control, Options, Problem, solve};
//! use tautline_core::robot::presets;
//! use tautline_core::simulation::{SimulationOptions, simulate};
//!
//! let mini = presets::find("mini").unwrap();
//! let run = simulate(&mini.robot, &SimulationOptions::new(30, 1))?;
//! let problem = Problem::new(&run.dataset)?;
//! let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue)?;
//! assert!(solution.converged());
//!
//! let truth = run.truth.cables[0].pulley.entry_point_m;
//! let found = solution.globals.entry_points[0];
//! assert!((0..3).all(|axis| (found[axis] - truth[axis]).abs() < 3e-3));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod accuracy;
pub mod cable;
pub mod comparison;
pub mod conformance;
pub mod diagnosis;
pub mod effect;
pub mod estimation;
mod evidence;
pub mod fitting;
pub mod geometry;
pub mod history;
pub mod instrument;
pub mod kinematics;
pub mod measurement;
pub mod planning;
pub mod projection;
pub mod real;
pub mod robot;
pub mod sequential;
pub mod simulation;
mod small_cholesky;
pub mod statistics;
pub mod threads;
mod tolerances;
