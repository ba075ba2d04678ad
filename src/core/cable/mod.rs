//! What a cable does between drum and platform: elasticity, measured elongation, sag.

mod elongation_surface;
mod unstrained;

pub use elongation_surface::ElongationSurface;
pub use unstrained::{CableLaw, Unstrained};
