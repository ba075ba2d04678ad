//! Parameters as text, for entering them into a controller by other means.

use std::collections::HashSet;
use std::fmt::Write;

use tautline_core::robot::Robot;
use tautline_session::csv_row;

use crate::adjusting::Difference;
use crate::parameters::{ParameterInfo, parameters_and_home_lengths};

/// The table `name,unit,controller,identified,difference,sd`; unknown values are empty cells.
#[must_use]
pub fn differences_csv(differences: &[Difference]) -> String {
    let mut text = "name,unit,controller,identified,difference,sd\n".to_owned();
    let cell = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for line in differences {
        text += &csv_row(&[
            line.name.clone(),
            line.unit.to_owned(),
            cell(line.controller),
            cell(line.identified),
            cell(line.difference),
            cell(line.sd),
        ]);
    }
    text
}

/// The parameters of an identified model and its lengths at home, as constants in Structured Text.
#[must_use]
pub fn identified_constants(model: &Robot) -> String {
    let title = format!("Identified parameters of {}", model.name);
    structured_text(&title, &parameters_and_home_lengths(model))
}

/// A block of constants in Structured Text (IEC 61131-3), in TwinCAT's syntax; `title` is in its first comment.
fn structured_text(title: &str, parameters: &[ParameterInfo]) -> String {
    let mut text = format!("(* {} *)\nVAR_GLOBAL CONSTANT\n", comment(title));
    let mut used = HashSet::new();
    for parameter in parameters {
        let mut name = identifier(&parameter.name);
        let mut number = 2;
        while !used.insert(name.to_lowercase()) {
            name = format!("{}_{number}", identifier(&parameter.name));
            number += 1;
        }
        // Writing to a string cannot fail. An LREAL has a decimal point.
        let _ = writeln!(
            text,
            "    {name} : LREAL := {:?}; (* {}, {} *)",
            parameter.value,
            comment(&parameter.name),
            unit(parameter.unit)
        );
    }
    text.push_str("END_VAR\n");
    text
}

fn unit(unit: &str) -> &str {
    if unit == "1" { "ratio" } else { unit }
}

/// Text for a comment: on one line, without the start or end of a (possibly nested) comment.
fn comment(text: &str) -> String {
    let one_line = text.replace(char::is_control, " ");
    one_line.replace("*)", "* )").replace("(*", "( *")
}

/// A name of letters, digits and single underscores that starts with a letter.
fn identifier(name: &str) -> String {
    let mut result = String::new();
    for letter in name.chars() {
        if letter.is_ascii_alphanumeric() {
            result.push(letter);
        } else if !result.ends_with('_') {
            result.push('_');
        }
    }
    let result = result.trim_matches('_');
    if result.starts_with(|first: char| first.is_ascii_alphabetic()) {
        result.to_owned()
    } else {
        format!("p_{result}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(name: &str, value: f64) -> ParameterInfo {
        ParameterInfo {
            name: name.into(),
            unit: "m",
            value,
        }
    }

    #[test]
    fn names_become_identifiers_of_their_own() {
        let parameters = [
            parameter("cable-1.entry_point.x_m", 0.5),
            parameter("cable 1.entry_point.x_m", -1e-7),
            parameter("1 *) x", 2.0),
            parameter("(*) y\u{1b}[2J", 3.0),
        ];
        let text = structured_text("MINI\n", &parameters);
        let expected = "(* MINI  *)\nVAR_GLOBAL CONSTANT\n    \
                        cable_1_entry_point_x_m : LREAL := 0.5; (* cable-1.entry_point.x_m, m *)\n    \
                        cable_1_entry_point_x_m_2 : LREAL := -1e-7; (* cable 1.entry_point.x_m, m *)\n    \
                        p_1_x : LREAL := 2.0; (* 1 * ) x, m *)\n    \
                        y_2J : LREAL := 3.0; (* ( * ) y [2J, m *)\nEND_VAR\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn the_table_has_empty_cells_where_nothing_is_known() {
        let lines = [Difference {
            name: "a,b".into(),
            unit: "m",
            controller: None,
            identified: Some(0.25),
            in_model: true,
            difference: None,
            sd: Some(1e-3),
            gain_m: None,
        }];
        let expected = "name,unit,controller,identified,difference,sd\n\"a,b\",m,,0.25,,0.001\n";
        assert_eq!(differences_csv(&lines), expected);
    }

    #[test]
    fn a_name_is_never_a_formula_and_a_number_stays_one() {
        let lines = [Difference {
            name: "=1+1.entry_point.x_m".into(),
            unit: "m",
            controller: Some(-1.5),
            identified: Some(-1.25),
            in_model: true,
            difference: Some(0.25),
            sd: None,
            gain_m: None,
        }];
        let table = differences_csv(&lines);
        let row = table.lines().nth(1);
        assert_eq!(row, Some("'=1+1.entry_point.x_m,m,-1.5,-1.25,0.25,"));
    }
}
