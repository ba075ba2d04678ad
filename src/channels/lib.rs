//! Recordings of laboratories as channels with units.
//!
//! A [`Source`] is a file, recognised by its content, whatever its name. It has [`Series`] of channels that were sampled
//! together: a [`Channel`] has a name, the unit that the file states and its [`Values`]; a [`TextChannel`] has states or names of
//! points. Whatever was not understood is in the notices of the source; nothing is dropped silently. Damaged files are
//! refused in one sentence with the place ([`tautline_files::ReadError`]); none panics, and memory is bounded by a
//! [`MemoryBudget`].
//!
//! ```no_run
//! # fn main() -> Result<(), tautline_files::ReadError> {
//! let source = tautline_channels::read_source("run1.tdms".as_ref())?;
//! for series in &source.series {
//!     for channel in &series.channels {
//!         println!("{} ({:?}): {} values", channel.name, channel.unit, channel.values.len());
//!     }
//! }
//! # Ok(())
//! # }
//! ```

mod formats;
mod input;
mod memory;
mod source;
mod table;
mod text;
mod units;
mod values;

pub use formats::{HAS_MORE_FORMATS, read_source, read_watched, text_head};
pub use input::Watch;
pub use memory::{MemoryBudget, OverBudget};
pub use source::{Channel, Format, Series, Source, Summary, TextChannel, owner_of};
pub use units::{Dimension, Unit, parse_unit, split_heading};
pub use values::Values;
