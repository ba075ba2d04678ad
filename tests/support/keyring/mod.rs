//! Keyrings of tests: one in memory, and a Secret Service in a process of its own.

mod memory;
mod secret_service;

pub use memory::MemoryPasswords;
pub use secret_service::{SecretService, StoredItem};
