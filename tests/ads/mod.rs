//! A controller that speaks ADS, for tests and benches, with the simulated robot behind it: pyads' test server in a process
//! of its own, or one that misbehaves. Neither shares code with the link.

mod host;
mod plant;
mod server;
pub mod symbols;
pub mod unruly;

pub use host::Host;
pub use plant::Plant;
pub use server::Server;
