//! Curve and linear fits against NIST's certified values.

use tautline_validation::tables::nist::{self, Row};

/// Digits that a problem must reach: of the parameters, of their standard deviations, of the
/// residual standard deviation. NIST certifies 11 digits of the nonlinear and 15 of the linear problems.
fn required(row: &Row) -> [f64; 3] {
    match (row.problem.as_str(), row.start) {
        // Of the 15.9 digits as many are lost as the condition number has, and rounding of all rows costs up to two more.
        (_, 0) => {
            let [of_columns, of_worst] = row.conditions.map(|k| 13.9 - k.log10());
            [of_worst, of_columns, of_columns]
        }
        // The residuals of 1e-13 are a few hundred roundings of responses up to 2.5: f64 arithmetic leaves
        // them 3 digits (measured 2.9), and with them the standard deviations.
        ("Lanczos1", _) => [10.0, 2.5, 2.5],
        _ => [8.0, 7.0, 10.0],
    }
}

#[test]
fn fits_agree_with_certified_values() -> anyhow::Result<()> {
    let rows = nist::study()?;
    println!("{}", nist::markdown(&rows));
    assert_eq!(rows.len(), 11 + 2 * 27, "every problem from every start");
    let short: Vec<&Row> = rows
        .iter()
        .filter(|row| {
            let reached = [row.parameter_digits, row.sd_digits, row.residual_sd_digits];
            let enough = reached.iter().zip(required(row)).all(|(r, min)| *r >= min);
            !(enough && row.converged)
        })
        .collect();
    assert!(short.is_empty(), "too few digits:\n{short:#?}");
    Ok(())
}
