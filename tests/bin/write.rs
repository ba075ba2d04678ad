//! Prints validation tables: `truth`, `table1`, `hangprinter`, `nist`; `write` puts all into
//! docs/VALIDATION.md.

use anyhow::{Result, bail};
use tautline_validation::truth;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let sets = arguments.get(1).map_or(Ok(1000), |n| n.parse())?;
    match arguments.first().map(String::as_str) {
        Some("truth") => {
            let rows: Result<Vec<_>> = ["mini", "hall", "suspended", "planar"]
                .iter()
                .map(|name| truth::study(name, sets, 1000))
                .collect();
            println!("{}", truth::markdown(&rows?));
        }
        _ => bail!("what to validate: truth"),
    }
    Ok(())
}
