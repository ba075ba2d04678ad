//! The window of the Tautline program.

// Items are public only for the tests.
#![allow(missing_docs)]

mod commands;
pub mod model;
mod screens;
pub mod shell;
pub mod theme;
pub mod views;
mod widgets;
