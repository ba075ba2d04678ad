//! The Tautline program.

fn main() {}
