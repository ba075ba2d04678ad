//! Comparison with independent references.

mod caspr;
mod ceres;
mod hangprinter;
mod hidden_effects;
mod isolability;
mod motion;
mod nist;
mod published;
mod real_machines;
mod stories;
mod table1;
mod truth;
