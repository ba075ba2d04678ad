//! Licences and sources of all dependencies, on all platforms, by the rules of deny.toml, and the reasons for what it ignores.
//! Works offline once `cargo fetch` has run, and without cargo-deny.

use std::path::Path;
use std::process::Command;

use serde_json::Value;
use spdx::{Expression, ParseMode};

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Packages that are not ours.
fn dependencies() -> Vec<Value> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--format-version", "1", "--locked", "--quiet"])
        .current_dir(root())
        .output()
        .expect("cargo");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let packages = metadata["packages"].as_array().expect("a list").clone();
    packages
        .into_iter()
        .filter(|package| !package["source"].is_null())
        .collect()
}

fn rules() -> toml::Table {
    let text = std::fs::read_to_string(root().join("deny.toml")).expect("deny.toml");
    text.parse().expect("TOML")
}

fn words(list: &toml::Value) -> Vec<String> {
    let words = list.as_array().expect("a list").iter();
    words
        .map(|word| word.as_str().expect("a word").to_owned())
        .collect()
}

/// A list of words in deny.toml.
fn rule(section: &str, key: &str) -> Vec<String> {
    words(&rules()[section][key])
}

/// Licences that are allowed for one crate alone.
fn exceptions_for(name: &str) -> Vec<String> {
    let rules = rules();
    let exceptions = rules["licenses"]["exceptions"].as_array();
    let own = exceptions.into_iter().flatten();
    let own = own.filter(|exception| exception["crate"].as_str() == Some(name));
    own.flat_map(|exception| words(&exception["allow"]))
        .collect()
}

/// Whether one of the alternative licences of a package is allowed, with its exceptions.
fn is_allowed(licence: &str, allowed: &[String]) -> bool {
    let expression = Expression::parse_mode(licence, ParseMode::LAX);
    expression.is_ok_and(|e| e.evaluate(|requirement| allowed.contains(&requirement.to_string())))
}

#[test]
fn expressions_are_read_as_meant() {
    let allowed = ["MIT".to_owned(), "Unicode-3.0".to_owned()];
    for good in [
        "MIT",
        "MIT OR GPL-3.0-only",
        "MIT/Apache-2.0",
        "(MIT OR Apache-2.0) AND Unicode-3.0",
    ] {
        assert!(is_allowed(good, &allowed), "{good}");
    }
    for bad in [
        "GPL-3.0-only",
        "MIT AND GPL-3.0-only",
        "Apache-2.0 WITH LLVM-exception",
        "",
        "free",
    ] {
        assert!(!is_allowed(bad, &allowed), "{bad}");
    }
}

#[test]
fn licences_are_allowed() {
    let allowed = rule("licenses", "allow");
    let packages = dependencies();
    assert!(packages.len() > 10, "only {} packages", packages.len());
    for package in packages {
        let licence = package["license"].as_str().unwrap_or("no licence");
        let name = package["name"].as_str().expect("a name");
        let allowed = [allowed.clone(), exceptions_for(name)].concat();
        assert!(is_allowed(licence, &allowed), "{name}: {licence}");
    }
}

#[test]
fn sources_are_allowed() {
    let registries = rule("sources", "allow-registry");
    for package in dependencies() {
        let source = package["source"].as_str().expect("a source");
        let is_known = source
            .strip_prefix("registry+")
            .is_some_and(|registry| registries.iter().any(|known| known == registry));
        assert!(is_known, "{}: {source}", package["name"]);
    }
}

#[test]
fn an_ignored_advisory_has_a_crate_that_is_needed_a_date_and_a_reason() {
    let packages = dependencies();
    let rules = rules();
    let ignored = rules["advisories"]["ignore"].as_array().expect("a list");
    for advisory in ignored {
        let reason = advisory.get("reason").and_then(toml::Value::as_str);
        let (named, why) = reason
            .and_then(|reason| reason.split_once(": "))
            .expect("a reason");
        let (name, date) = named.split_once(", ").expect("a crate and a date");
        let digits = date
            .split('-')
            .map(|part| part.parse::<u32>().expect("a number"));
        assert_eq!(digits.count(), 3, "{date}");
        assert!(why.len() > 40, "{name}: {why}");
        assert!(
            packages.iter().any(|package| package["name"] == name),
            "{name} is gone"
        );
    }
}

#[test]
fn advisories_are_fetched_on_a_schedule() {
    let path = root().join(".github/workflows/advisories.yml");
    let workflow = std::fs::read_to_string(path).expect("the workflow");
    for part in ["schedule:", "- cron:", "cargo-deny", "check advisories"] {
        assert!(workflow.contains(part), "{part}");
    }
}
