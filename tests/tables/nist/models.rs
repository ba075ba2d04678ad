//! The curves of the NIST StRD nonlinear problems, `y = f(x; b)`.

use std::f64::consts::PI;

/// Response at predictors `x` with parameters `b`.
pub type Curve = fn(&[f64], &[f64]) -> f64;

/// Every nonlinear problem with its curve, by level of difficulty as NIST lists them.
pub const NONLINEAR: [(&str, Curve); 27] = [
    ("Misra1a", misra1a),
    ("Chwirut2", chwirut),
    ("Chwirut1", chwirut),
    ("Lanczos3", lanczos),
    ("Gauss1", gauss),
    ("Gauss2", gauss),
    ("DanWood", |x, b| b[0] * x[0].powf(b[1])),
    ("Misra1b", |x, b| {
        b[0] * (1.0 - (1.0 + b[1] * x[0] / 2.0).powi(-2))
    }),
    ("Kirby2", |x, b| {
        polynomial(x[0], &b[..3]) / (1.0 + x[0] * polynomial(x[0], &b[3..]))
    }),
    ("Hahn1", cubic_over_cubic),
    ("Nelson", |x, b| b[0] - b[1] * x[0] * (-b[2] * x[1]).exp()),
    ("MGH17", |x, b| {
        b[0] + b[1] * (-x[0] * b[3]).exp() + b[2] * (-x[0] * b[4]).exp()
    }),
    ("Lanczos1", lanczos),
    ("Lanczos2", lanczos),
    ("Gauss3", gauss),
    ("Misra1c", |x, b| {
        b[0] * (1.0 - (1.0 + 2.0 * b[1] * x[0]).powf(-0.5))
    }),
    ("Misra1d", |x, b| b[0] * b[1] * x[0] / (1.0 + b[1] * x[0])),
    ("Roszman1", |x, b| {
        b[0] - b[1] * x[0] - (b[2] / (x[0] - b[3])).atan() / PI
    }),
    ("ENSO", enso),
    ("MGH09", |x, b| {
        b[0] * (x[0] * x[0] + x[0] * b[1]) / (x[0] * x[0] + x[0] * b[2] + b[3])
    }),
    ("Thurber", cubic_over_cubic),
    ("BoxBOD", misra1a),
    ("Rat42", |x, b| b[0] / (1.0 + (b[1] - b[2] * x[0]).exp())),
    ("MGH10", |x, b| b[0] * (b[1] / (x[0] + b[2])).exp()),
    ("Eckerle4", |x, b| {
        b[0] / b[1] * (-0.5 * ((x[0] - b[2]) / b[1]).powi(2)).exp()
    }),
    ("Rat43", |x, b| {
        b[0] / (1.0 + (b[1] - b[2] * x[0]).exp()).powf(1.0 / b[3])
    }),
    ("Bennett5", |x, b| b[0] * (b[1] + x[0]).powf(-1.0 / b[2])),
];

fn polynomial(x: f64, coefficients: &[f64]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

fn misra1a(x: &[f64], b: &[f64]) -> f64 {
    b[0] * (1.0 - (-b[1] * x[0]).exp())
}

fn chwirut(x: &[f64], b: &[f64]) -> f64 {
    (-b[0] * x[0]).exp() / (b[1] + b[2] * x[0])
}

fn lanczos(x: &[f64], b: &[f64]) -> f64 {
    b.chunks_exact(2).map(|b| b[0] * (-b[1] * x[0]).exp()).sum()
}

fn gauss(x: &[f64], b: &[f64]) -> f64 {
    let peak = |b: &[f64]| b[0] * (-((x[0] - b[1]) / b[2]).powi(2)).exp();
    b[0] * (-b[1] * x[0]).exp() + peak(&b[2..5]) + peak(&b[5..8])
}

fn cubic_over_cubic(x: &[f64], b: &[f64]) -> f64 {
    polynomial(x[0], &b[..4]) / (1.0 + x[0] * polynomial(x[0], &b[4..]))
}

fn enso(x: &[f64], b: &[f64]) -> f64 {
    let wave = |period: f64, c: f64, s: f64| {
        let (sine, cosine) = (2.0 * PI * x[0] / period).sin_cos();
        c * cosine + s * sine
    };
    b[0] + wave(12.0, b[1], b[2]) + wave(b[3], b[4], b[5]) + wave(b[6], b[7], b[8])
}
