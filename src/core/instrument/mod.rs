//! Phase 1 instruments: winches, force sensors, the home reference platform.
