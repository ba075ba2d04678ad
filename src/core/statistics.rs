//! Probability distributions that tests and intervals need.
