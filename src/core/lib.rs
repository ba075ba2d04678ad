//! The maths of Tautline: kinematics of cable-driven parallel robots, models of their cables and
//! instruments, estimation of their geometry with honest uncertainties.
//!
//! This crate opens no file, reads no clock, draws nothing and spawns nothing. SI units
//! throughout; frames are in the names (`base_from_platform`, `anchor_in_base`).

pub mod accuracy;
pub mod cable;
pub mod comparison;
pub mod diagnosis;
pub mod effect;
pub mod estimation;
pub mod fitting;
pub mod geometry;
pub mod instrument;
pub mod kinematics;
pub mod measurement;
pub mod planning;
pub mod real;
pub mod robot;
pub mod simulation;
mod small_cholesky;
pub mod statistics;
