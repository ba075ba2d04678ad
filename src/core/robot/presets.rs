//! Ready-made robots.
