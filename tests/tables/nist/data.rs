//! Reader of the NIST StRD files under `tests/tables/nist/files`.

use std::path::Path;

use anyhow::{Context, Result, ensure};

/// One problem as NIST states it.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Name of the dataset.
    pub name: String,
    /// Level of difficulty: Lower, Average or Higher.
    pub level: String,
    /// Starting values, one list per start; none for linear problems.
    pub starts: Vec<Vec<f64>>,
    /// Certified parameters.
    pub parameters: Vec<f64>,
    /// Certified standard deviations of the parameters.
    pub standard_deviations: Vec<f64>,
    /// Certified residual standard deviation.
    pub residual_sd: f64,
    /// Response of each observation.
    pub y: Vec<f64>,
    /// Predictors of each observation.
    pub x: Vec<Vec<f64>>,
}

/// Reads `NAME.dat`.
///
/// # Errors
/// If the file is missing or not laid out as expected.
pub fn read(name: &str) -> Result<Problem> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tables/nist/files");
    let text =
        std::fs::read_to_string(folder.join(format!("{name}.dat"))).context(name.to_owned())?;
    parse(name, &text).with_context(|| name.to_owned())
}

fn parse(name: &str, text: &str) -> Result<Problem> {
    let lines: Vec<&str> = text.lines().collect();
    let data_line = lines
        .iter()
        .rposition(|line| line.starts_with("Data:"))
        .context("no data")?;
    let level = lines
        .iter()
        .find_map(|line| line.trim().strip_suffix(" Level of Difficulty"))
        .context("no level")?;
    let residual_sd = lines
        .iter()
        .find_map(|line| line.strip_prefix("Residual Standard Deviation:"))
        .context("no residual standard deviation")?;
    let mut problem = Problem {
        name: name.to_owned(),
        level: level.to_owned(),
        starts: Vec::new(),
        parameters: Vec::new(),
        standard_deviations: Vec::new(),
        residual_sd: residual_sd.trim().parse()?,
        y: Vec::new(),
        x: Vec::new(),
    };
    lines[..data_line]
        .iter()
        .for_each(|line| problem.read_parameter(line));
    for line in &lines[data_line + 1..] {
        let numbers = numbers(line).context("a data line is not numbers")?;
        let [y, x @ ..] = numbers.as_slice() else {
            continue;
        };
        problem.y.push(*y);
        problem.x.push(x.to_vec());
    }
    ensure!(!problem.parameters.is_empty(), "no certified values");
    Ok(problem)
}

impl Problem {
    /// Takes `b1 = start1 start2 value sd` (nonlinear) or `B1 value sd` (linear); passes over any
    /// other line.
    fn read_parameter(&mut self, line: &str) {
        let line = line.trim();
        let Some(rest) = line.strip_prefix(['b', 'B']) else {
            return;
        };
        let (_, values) = rest.split_at(rest.find([' ', '=']).unwrap_or(0));
        let Some(values) = numbers(values.trim_start().trim_start_matches('=')) else {
            return;
        };
        let [starts @ .., value, sd] = values.as_slice() else {
            return;
        };
        self.starts.resize(starts.len(), Vec::new());
        for (list, start) in self.starts.iter_mut().zip(starts) {
            list.push(*start);
        }
        self.parameters.push(*value);
        self.standard_deviations.push(*sd);
    }
}

fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split_whitespace()
        .map(|cell| cell.parse().ok())
        .collect()
}
