//! The Tautline program: the window.

// Its items are public for the tests alone.
#![allow(missing_docs)]

mod commands;
pub mod model;
mod screens;
pub mod shell;
pub mod theme;
pub mod views;
mod widgets;
