//! A controller that speaks ADS or OPC UA, for tests and benches, with the simulated robot behind it: the server of pyads or
//! of asyncua in a process of its own, or one that misbehaves. None shares code with the link.

mod host;
mod keys;
mod plant;
mod server;
pub mod symbols;
pub mod unruly;
mod user;

pub use host::Host;
pub use keys::TestKeys;
pub use plant::Plant;
pub use server::{PASSWORD, Protocol, Server, USER, user_certificates};
pub use user::User;
