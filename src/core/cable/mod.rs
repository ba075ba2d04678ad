//! Models of a cable between drum and platform: elasticity, measured elongation, sag.

mod elongation_fit;
mod elongation_surface;
mod unstrained;

pub use elongation_fit::{
    DegreeChoice, DegreeScore, ElongationFitError, ElongationTriple, choose_elongation_degree,
    fit_elongation_surface,
};
pub use elongation_surface::{ElongationSurface, OutsideMeasuredRange, SurfaceValue};
pub use unstrained::{CableLaw, Unstrained};
