//! Parts that screens are made of.

mod button;
mod text;

pub use button::{icon_button, icon_only, primary};
pub use text::{Verdict, empty, heading, muted, section, value, verdict};
