//! A controller that speaks ADS, the protocol of Beckhoff's.
//!
//! Which symbol is what says a [`tautline_session::AdsMapping`]; how controller and program deal with each other says
//! `docs/ADS.md`. No request is sent but by a call from outside, and each waits at most as long as
//! [`AdsOptions::timeout_s`]; the library under it has one thread for each connection, which takes the answers.
//! Nothing is written before [`crate::Controller::arm`].
//!
//! Readings are asked for, not subscribed to: one request has all readings of one moment, while notifications of
//! several symbols come one by one, pile up where nobody takes them, and end in a failure of the library's thread when
//! the connection is dropped amid one.

mod address;
mod check;
mod controller;
mod layout;
mod line;
mod live;
mod options;
mod pose;
mod probe;
mod reading;
mod symbols;

pub use address::AdsAddress;
pub use check::{SymbolCheck, SymbolFound, check_symbols};
pub use controller::AdsController;
pub use options::AdsOptions;
