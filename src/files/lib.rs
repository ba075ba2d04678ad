//! Input files: opening them, surviving damaged ones, and errors of one sentence that name file and place.

mod damaged;
mod error;
mod input_file;

pub use damaged::read_damaged;
pub use error::{Location, ReadError, quoted};
pub use input_file::{open_input, was_read};
