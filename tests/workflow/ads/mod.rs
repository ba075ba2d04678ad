//! The ADS link against a server that shares no code with it: pyads' test server in a process of its own, with the
//! simulated robot behind it.

mod adjusting;
mod calibrating;
mod faults;
mod page;
mod program;
mod setting_up;
