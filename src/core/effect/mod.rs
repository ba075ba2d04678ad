//! Physical effects that extend the nominal model.

mod setting;

pub use setting::EffectSetting;
