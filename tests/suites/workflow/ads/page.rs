//! docs/ADS.md agrees with the program.

use std::path::Path;

use serde_json::Value;
use tautline_core::robot::presets::{NAMES, find};
use tautline_session::SymbolMapping;

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/ADS.md");
    std::fs::read_to_string(path).expect("docs/ADS.md")
}

/// All texts in a document.
fn texts(value: &Value) -> Vec<&str> {
    match value {
        Value::String(text) => vec![text],
        Value::Array(list) => list.iter().flat_map(texts).collect(),
        Value::Object(map) => map.values().flat_map(texts).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn the_sample_program_has_every_default_symbol() {
    let page = page();
    let declared: Vec<&str> = page
        .lines()
        .filter_map(|line| line.split_once(':'))
        .map(|(name, _)| name.trim())
        .collect();
    for robot in NAMES.into_iter().filter_map(find).map(|p| p.robot) {
        let mapping = serde_json::to_value(SymbolMapping::default_for(&robot)).expect("JSON");
        let symbols = texts(&mapping).into_iter();
        let symbols: Vec<&str> = symbols
            .filter_map(|text| text.strip_prefix("GVL_Tautline."))
            .collect();
        assert!(symbols.len() > 20, "{}", symbols.len());
        for symbol in symbols {
            assert!(declared.contains(&symbol), "{symbol} is not declared");
        }
    }
}

#[test]
fn the_example_of_a_mapping_is_valid() {
    let page = page();
    let (_, rest) = page.split_once("```json\n").expect("an example");
    let (example, _) = rest.split_once("```").expect("its end");
    let document: Value = serde_json::from_str(&format!("{{{example}}}")).expect("JSON");
    let ads = document["connection"]["ads"].clone();
    let mapping: SymbolMapping = serde_json::from_value(ads).expect("a mapping");
    let robot = find("mini").expect("a preset").robot;
    mapping.check(&robot).expect("a good mapping");
    assert_eq!(mapping.parameters.len(), 2);
}
