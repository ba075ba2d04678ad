//! The ADS link against a server that shares no code with it: pyads' test server in a process of its own, with the
//! simulated robot behind it.

mod adjusting;
mod calibrating;
mod faults;
mod names;
mod page;
mod plant;
mod program;
mod server;
mod setting_up;
