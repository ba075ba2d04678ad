//! What a cable does between drum and platform: elasticity, measured elongation, sag.

mod elongation_surface;

pub use elongation_surface::ElongationSurface;
