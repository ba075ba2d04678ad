//! The candidate formulas: a size with a unit times at most two factors, which are circumstances on which a reading may depend,
//! their absolute values, or periods of the motor.

use std::collections::BTreeMap;

use tautline_core::diagnosis::Quantity;
use tautline_core::estimation::Solution;
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::measurement::Dataset;

/// Smallest and largest typical error of a reading that a formula describes.
const LENGTH_M: [f64; 2] = [1e-4, 1e-2];
const TENSION_N: [f64; 2] = [0.3, 30.0];
/// Periods of a motor revolution that are tried.
const PERIODS: [usize; 6] = [1, 2, 3, 4, 6, 8];
/// Prefix of the identifiers of formulas.
pub const PATTERN: &str = "pattern_";

/// A kind of reading whose error a formula may describe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// The lengths of a cable.
    Length,
    /// The tensions of a cable.
    Tension,
    /// The laser distance.
    Laser,
}

impl Reading {
    /// The kind for a quantity; `None` for instruments whose errors no formula describes.
    #[must_use]
    pub fn of(quantity: Quantity) -> Option<Self> {
        match quantity {
            Quantity::Length => Some(Self::Length),
            Quantity::Tension => Some(Self::Tension),
            Quantity::Laser => Some(Self::Laser),
            _ => None,
        }
    }

    /// Quantity that a formula changes, and its unit.
    fn target(self) -> (&'static str, &'static str) {
        match self {
            Self::Length => ("paid", "m"),
            Self::Tension => ("tension", "N"),
            Self::Laser => ("laser_bias", "m"),
        }
    }

    fn typical(self) -> [f64; 2] {
        match self {
            Self::Length | Self::Laser => LENGTH_M,
            Self::Tension => TENSION_N,
        }
    }

    fn scope(self) -> &'static str {
        match self {
            Self::Length | Self::Tension => "cable",
            Self::Laser => "robot",
        }
    }
}

/// A formula as a hypothesis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Formula {
    /// Identifier of the hypothesis.
    pub id: String,
    /// The formula without its size, such as `wrap * position_z`.
    pub expression: String,
    /// The text of the hypothesis.
    pub text: String,
}

/// A circumstance with its unit and its range over the poses.
#[derive(Debug, Clone, Copy)]
struct Circumstance {
    name: &'static str,
    unit: &'static str,
    /// Root mean square over the poses, in SI units.
    size: f64,
    has_both_signs: bool,
}

/// The formulas for a kind of reading over the poses of a dataset.
#[must_use]
pub fn formulas(reading: Reading, dataset: &Dataset, solution: &Solution) -> Vec<Formula> {
    let all = circumstances(reading, dataset, solution);
    let (target, unit) = reading.target();
    let mut found = Vec::new();
    let mut push = |expression: String, units: &[&str], size: f64| {
        let [low, high] = reading.typical().map(|error| decade(error / size));
        found.push(formula(
            reading,
            &expression,
            &ratio(unit, units),
            [low, high],
            None,
        ));
    };
    for (k, one) in all.iter().enumerate() {
        push(one.name.to_owned(), &[one.unit], one.size);
        if one.has_both_signs {
            push(format!("abs({})", one.name), &[one.unit], one.size);
        }
        for other in &all[k..] {
            // The square of a sign is a constant.
            if one.name == "direction" && other.name == "direction" {
                continue;
            }
            let expression = format!("{} * {}", one.name, other.name);
            push(expression, &[one.unit, other.unit], one.size * other.size);
        }
    }
    if reading == Reading::Length {
        for period in PERIODS {
            let phase = format!("2 * pi * {period} * revolutions");
            let waves = Some((format!("sin({phase})"), format!("cos({phase})")));
            let expression = format!("a wave of {period} per motor revolution");
            found.push(formula(
                reading,
                &expression,
                unit,
                reading.typical(),
                waves,
            ));
        }
    }
    // The catalogue has the effect that changes a quantity by a share of itself.
    found.retain(|formula| formula.expression != target);
    found
}

fn formula(
    reading: Reading,
    expression: &str,
    unit: &str,
    [low, high]: [f64; 2],
    waves: Option<(String, String)>,
) -> Formula {
    let (target, _) = reading.target();
    let words = |c: char| if c.is_alphanumeric() { c } else { '_' };
    let id: String = expression.chars().map(words).collect();
    let id = format!(
        "{PATTERN}{target}_{}",
        id.trim_matches('_').replace("___", "_")
    );
    let of = match reading.scope() {
        "cable" => " of {cable}",
        _ => "",
    };
    let typical = format!("typical = [{low:e}, {high:e}]");
    let (parameters, change) = match &waves {
        None => (
            format!("[parameters.size]\nunit = \"{unit}\"\n{typical}\n"),
            format!("{target} + size * {expression}"),
        ),
        Some((sine, cosine)) => (
            ["sine", "cosine"]
                .map(|name| format!("[parameters.{name}]\nunit = \"{unit}\"\n{typical}\n"))
                .join("\n"),
            format!("{target} + sine * {sine} + cosine * {cosine}"),
        ),
    };
    let text = format!(
        "# A pattern that the readings show: give it a title and a cause of your own.\n\
         id = \"{id}\"\n\
         title = \"Pattern: {expression}\"\n\
         scope = \"{}\"\n\
         cause = \"The {target} reading{of} has an error like {expression}.\"\n\
         workshop = \"Find out what depends on this.\"\n\n\
         {parameters}\n\
         [change]\n\
         {target} = \"{change}\"\n",
        reading.scope()
    );
    Formula {
        id,
        expression: expression.to_owned(),
        text,
    }
}

/// The nearest power of ten: formulas of similar data are the same text.
fn decade(value: f64) -> f64 {
    10_f64.powf(value.log10().round())
}

/// The unit that makes a product of units one of `target`.
fn ratio(target: &str, units: &[&str]) -> String {
    let mut powers: BTreeMap<&str, i32> = BTreeMap::new();
    *powers.entry(target).or_default() += 1;
    for unit in units.iter().filter(|unit| **unit != "1") {
        *powers.entry(unit).or_default() -= 1;
    }
    let part = |is_wanted: fn(i32) -> bool| {
        let own = powers.iter().filter(|(_, power)| is_wanted(**power));
        own.map(|(unit, power)| match power.abs() {
            1 => (*unit).to_owned(),
            power => format!("{unit}^{power}"),
        })
        .collect::<Vec<_>>()
    };
    let (above, below) = (part(|power| power > 0), part(|power| power < 0));
    let above = match above.is_empty() {
        true => "1".to_owned(),
        false => above.join("*"),
    };
    below
        .iter()
        .fold(above, |unit, below| format!("{unit}/{below}"))
}

/// The circumstances that vary over the poses.
fn circumstances(reading: Reading, dataset: &Dataset, solution: &Solution) -> Vec<Circumstance> {
    let (robot, data) = (&dataset.robot, &dataset.measurements);
    let model = solution.globals.model(robot);
    let mut values: Vec<(&'static str, &'static str, Vec<f64>)> = Vec::new();
    let poses = || solution.poses.iter().map(|(_, pose)| pose);
    let names = [
        ["position_x", "position_y", "position_z"],
        ["rotation_x", "rotation_y", "rotation_z"],
    ];
    for axis in 0..3 {
        values.push((
            names[0][axis],
            "m",
            poses().map(|pose| pose.position[axis]).collect(),
        ));
        let rotations = poses().map(|pose| pose.orientation.scaled_axis()[axis]);
        values.push((names[1][axis], "rad", rotations.collect()));
    }
    let finite = |values: &[f64]| values.iter().copied().filter(|v| v.is_finite()).collect();
    values.push(("time", "s", finite(&data.time_s)));
    if reading != Reading::Laser {
        let cables: Vec<_> = poses()
            .filter_map(|pose| inverse_kinematics(&model, pose).ok())
            .collect();
        let each =
            |of: &dyn Fn(&tautline_core::kinematics::CableState) -> Option<f64>| -> Vec<f64> {
                cables.iter().flatten().filter_map(of).collect()
            };
        let lengths = each(&|cable| Some(cable.length_m));
        let mean = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
        values.push((
            "paid",
            "m",
            lengths.iter().map(|length| length - mean).collect(),
        ));
        values.push(("wrap", "rad", each(&|cable| Some(cable.wrap_rad))));
        values.push(("swivel", "rad", each(&|cable| cable.swivel_rad)));
        values.push(("direction", "1", vec![1.0, -1.0]));
        if robot.has_tensions() {
            values.push((
                "tension",
                "N",
                finite(
                    &(0..data.force_n.rows())
                        .flat_map(|row| data.force_n.row(row).to_vec())
                        .collect::<Vec<_>>(),
                ),
            ));
        }
    }
    values
        .into_iter()
        .filter_map(|(name, unit, values)| circumstance(name, unit, &values))
        .collect()
}

/// A circumstance by its values; `None` if it does not vary.
fn circumstance(name: &'static str, unit: &'static str, values: &[f64]) -> Option<Circumstance> {
    let count = values.len().max(1) as f64;
    let size = (values.iter().map(|value| value * value).sum::<f64>() / count).sqrt();
    let [low, high] = values
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(*value), high.max(*value)]
        });
    let varies = high - low > 1e-6 * size && size > 0.0;
    varies.then_some(Circumstance {
        name,
        unit,
        size,
        has_both_signs: low < 0.0 && high > 0.0 && name != "direction",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_products_are_balanced() {
        for (target, units, expected) in [
            ("m", vec!["m"], "1"),
            ("m", vec!["N", "N"], "m/N^2"),
            ("m", vec!["m", "m"], "1/m"),
            ("N", vec!["rad", "1"], "N/rad"),
            ("m", vec!["m", "s"], "1/s"),
        ] {
            assert_eq!(ratio(target, &units), expected);
        }
    }
}
