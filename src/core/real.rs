//! The scalar type of the prediction: plain reals, SIMD lanes, dual numbers.
