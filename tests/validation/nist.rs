//! Curve and linear fits against NIST's certified values.

use tautline_validation::nist;

#[test]
fn fits_agree_with_certified_values() -> anyhow::Result<()> {
    let rows = nist::table()?;
    println!("{}", nist::markdown(&rows));
    Ok(())
}
