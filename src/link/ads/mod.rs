//! Controllers that speak ADS, Beckhoff's protocol.
//!
//! A [`tautline_session::AdsMapping`] says which symbol holds what; `docs/ADS.md` describes the handshake between this
//! program and that of the controller. Requests are sent only by calls from outside, and each waits at most
//! [`AdsOptions::timeout_s`]; the library below has one thread per connection, which receives the answers. Nothing is
//! written before [`crate::Controller::arm`].
//!
//! Readings are polled, because one request returns all readings of one moment. Notifications of several symbols arrive
//! one by one, queue up where nobody takes them, and make the library's thread fail when the connection is dropped
//! while one arrives.

mod address;
mod client;
mod controller;
mod layout;
mod options;
mod pose;
mod probe;
mod program;
mod sample;
mod symbols;

pub use address::AdsAddress;
pub use controller::AdsController;
pub use options::AdsOptions;
pub use program::check_symbols;
pub use symbols::{SymbolCheck, SymbolFound};
