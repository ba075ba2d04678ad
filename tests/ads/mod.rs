//! A controller that speaks ADS, for tests and benches: pyads' test server in a process of its own, with the
//! simulated robot behind it. It shares no code with the link.

mod plant;
mod server;
pub mod symbols;

pub use plant::Plant;
pub use server::Server;
