//! Controllers that speak ADS, Beckhoff's protocol.
//!
//! A [`tautline_session::AdsMapping`] says which symbol holds what; `docs/ADS.md` describes the handshake between this
//! program and that of the controller. Requests are sent only by calls from outside, and each is over, answered or not,
//! after at most [`AdsOptions::timeout_s`]. There is no thread: an answer is read by whoever asked. Nothing is written
//! before [`crate::Controller::arm`].
//!
//! Readings are polled, because one request returns all readings of one moment. Notifications of several symbols arrive
//! one by one and queue up where nobody takes them.

mod address;
mod client;
mod codes;
mod controller;
mod layout;
mod options;
mod pose;
mod program;
mod sample;
mod symbols;
mod wire;

pub use address::AdsAddress;
pub use controller::AdsController;
pub use options::AdsOptions;
pub use program::check_symbols;
pub use symbols::{SymbolCheck, SymbolFound};
