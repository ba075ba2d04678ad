//! The catalogue of sensors: those of the program and those in a folder of the user.

use std::fs;
use std::path::Path;

use serde_json::{Map, Value};
use tautline_core::robot::FieldError;
use tautline_files::{Location, ReadError, quoted};

use super::Sensor;
use crate::error::fail;
use crate::folders::Folders;
use crate::json::{parse_versioned_toml, read_versioned_toml};

/// Built-in files, by identifier.
const EMBEDDED: [(&str, &str); 8] = [
    (
        "class-0.1mm",
        include_str!("../../../assets/sensors/class-0.1mm.toml"),
    ),
    (
        "class-0.3mm",
        include_str!("../../../assets/sensors/class-0.3mm.toml"),
    ),
    (
        "class-1mm",
        include_str!("../../../assets/sensors/class-1mm.toml"),
    ),
    (
        "class-3mm",
        include_str!("../../../assets/sensors/class-3mm.toml"),
    ),
    (
        "dimetix-d-1mm",
        include_str!("../../../assets/sensors/dimetix-d-1mm.toml"),
    ),
    (
        "dimetix-d-3mm",
        include_str!("../../../assets/sensors/dimetix-d-3mm.toml"),
    ),
    (
        "leica-disto-d330",
        include_str!("../../../assets/sensors/leica-disto-d330.toml"),
    ),
    (
        "tr-llb500-1mm",
        include_str!("../../../assets/sensors/tr-llb500-1mm.toml"),
    ),
];

/// A sensor with its identifier.
#[derive(Debug, Clone, PartialEq)]
pub struct CatalogueEntry {
    /// Identifier: the name of its file without `.toml`.
    pub id: String,
    /// The sensor.
    pub sensor: Sensor,
}

/// Sensors by identifier.
#[derive(Debug, Clone, PartialEq)]
pub struct Catalogue {
    entries: Vec<CatalogueEntry>,
}

impl Catalogue {
    /// The built-in sensors, and those of the files `*.toml` in the user's folder, which take precedence.
    ///
    /// # Errors
    /// If a file of the user is not valid.
    pub fn of_user() -> Result<Self, ReadError> {
        let folder = Folders::of_user().ok().map(|folders| folders.sensors());
        Self::with(folder.as_deref().filter(|folder| folder.is_dir()))
    }

    /// The built-in sensors, and those in a folder.
    ///
    /// # Errors
    /// If a file there is not valid.
    pub fn with(folder: Option<&Path>) -> Result<Self, ReadError> {
        let mut entries = match folder {
            Some(folder) => own(folder)?,
            None => Vec::new(),
        };
        for (id, text) in EMBEDDED {
            if entries.iter().any(|entry| entry.id == id) {
                continue;
            }
            entries.push(CatalogueEntry {
                id: id.to_owned(),
                sensor: parse_versioned_toml(text.as_bytes(), id)?.value,
            });
        }
        Ok(Self { entries })
    }

    /// All sensors.
    #[must_use]
    pub fn entries(&self) -> &[CatalogueEntry] {
        &self.entries
    }

    /// The sensor with an identifier.
    ///
    /// # Errors
    /// A sentence with the identifier that was found, and those that exist.
    pub fn find(&self, id: &str) -> Result<&Sensor, String> {
        let found = self.entries.iter().find(|entry| entry.id == id);
        found.map(|entry| &entry.sensor).ok_or_else(|| {
            let known: Vec<&str> = self.entries.iter().map(|entry| entry.id.as_str()).collect();
            format!(
                "found {}, expected a sensor of the catalogue: {}",
                quoted(id),
                known.join(", ")
            )
        })
    }
}

/// The sensors in a folder, sorted by name.
fn own(folder: &Path) -> Result<Vec<CatalogueEntry>, ReadError> {
    let place = folder.display().to_string();
    let files =
        fs::read_dir(folder).map_err(|error| ReadError::io(&place, Location::File, &error))?;
    let mut paths: Vec<_> = files.flatten().map(|file| file.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == "toml"));
    paths.sort();
    let entry = |path: &std::path::PathBuf| {
        Ok(CatalogueEntry {
            id: path
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            sensor: read_versioned_toml(path)?.value,
        })
    };
    paths.iter().map(entry).collect()
}

/// Replaces the sensor that a robot file refers to by its standard deviation:
/// `"laser": {"sensor": "leica-disto-d330", ...}` instead of `sd_m`.
pub(crate) fn resolve_in_robot(document: &mut Map<String, Value>) -> Result<(), FieldError> {
    let pointer = "/laser/sensor";
    let Some(Value::Object(laser)) = document.get("laser") else {
        return Ok(());
    };
    let Some(named) = laser.get("sensor") else {
        return Ok(());
    };
    let Value::String(id) = named else {
        return fail(pointer, "expected the name of a sensor of the catalogue");
    };
    let id = id.clone();
    if laser.contains_key("sd_m") {
        let message = format!(
            "found both {} and sd_m, expected only one of them",
            quoted(&id)
        );
        return fail(pointer, message);
    }
    let catalogue = Catalogue::of_user().or_else(|error| fail(pointer, error.to_string()))?;
    let sensor = catalogue
        .find(&id)
        .or_else(|message| fail(pointer, message))?;
    let sd_m = sensor.reading_sd_m(expected_distances(document));
    if let Some(Value::Object(laser)) = document.get_mut("laser") {
        laser.remove("sensor");
        laser.insert("sd_m".to_owned(), sd_m.into());
    }
    Ok(())
}

/// Expected distances: the distance from the home pose to the target plane, plus and minus half of it.
fn expected_distances(document: &Map<String, Value>) -> [f64; 2] {
    let at = |path: &str| -> Option<Vec<f64>> {
        let mut parts = path.split('/');
        let mut value = document.get(parts.next()?)?;
        for part in parts {
            value = value.get(part)?;
        }
        match value {
            Value::Array(values) => values.iter().map(Value::as_f64).collect(),
            other => Some(vec![other.as_f64()?]),
        }
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let distance = || {
        let normal = at("laser/target_plane/normal")?;
        let offset = *at("laser/target_plane/offset_m")?.first()?;
        let origin = at("laser/origin_m")?;
        let home = at("home/position_m").unwrap_or_else(|| vec![0.0; 3]);
        Some((offset - dot(&normal, &origin) - dot(&normal, &home)).abs())
    };
    let middle = distance().unwrap_or(1.0);
    [0.5 * middle, 1.5 * middle]
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::parse_robot;

    #[test]
    fn sensors_of_makers_name_their_source() {
        let catalogue = Catalogue::with(None).expect("valid");
        assert_eq!(catalogue.entries().len(), EMBEDDED.len());
        for CatalogueEntry { id, sensor } in catalogue.entries() {
            assert_eq!(sensor.maker.is_none(), id.starts_with("class-"), "{id}");
            let Some(maker) = &sensor.maker else { continue };
            assert!(!sensor.sources.is_empty(), "{maker}");
            assert!(sensor.assumed.contains("check the data sheet"), "{maker}");
            for source in &sensor.sources {
                assert!(source.address.starts_with("http"), "{maker}");
                assert!(
                    !source.quote.is_empty() && source.date.len() >= 4,
                    "{maker}"
                );
            }
        }
    }

    #[test]
    fn users_add_and_replace_sensors() {
        let folder = tempfile::tempdir().expect("a folder");
        let write =
            |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
        let head = "format = \"tautline-sensor\"\nversion = 1\n";
        write(
            "mine.toml",
            &format!("{head}name = \"Mine\"\nrandom_sd_m = 2e-4\n"),
        );
        write(
            "class-1mm.toml",
            &format!("{head}name = \"Ours\"\nrandom_sd_m = 9e-4\n"),
        );
        write("notes.txt", "no sensor");
        let catalogue = Catalogue::with(Some(folder.path())).expect("valid");
        assert_eq!(catalogue.find("mine").expect("there").name, "Mine");
        assert_eq!(catalogue.find("class-1mm").expect("there").name, "Ours");
        assert_eq!(catalogue.entries().len(), EMBEDDED.len() + 1);
        write(
            "bad.toml",
            &format!("{head}name = \"Bad\"\nrandom_sd_m = 0\n"),
        );
        let error = Catalogue::with(Some(folder.path()))
            .expect_err("refused")
            .to_string();
        assert!(
            error.ends_with("bad.toml, /random_sd_m: found 0, expected a number greater than 0")
        );
    }

    fn robot_with(laser: Value) -> Value {
        let mini = tautline_core::robot::presets::find("mini")
            .expect("there")
            .robot;
        let mut robot = serde_json::to_value(&mini).expect("JSON");
        robot["format"] = "tautline-robot".into();
        robot["version"] = 1.into();
        for (key, value) in laser.as_object().expect("an object") {
            robot["laser"][key] = value.clone();
        }
        robot
    }

    #[test]
    fn robot_files_name_a_sensor() {
        let mut robot = robot_with(json!({"sensor": "class-1mm"}));
        let both = parse_robot(robot.to_string().as_bytes(), "r.json").expect_err("refused");
        assert!(
            both.to_string().contains("and sd_m, expected only one"),
            "{both}"
        );
        robot["laser"]
            .as_object_mut()
            .expect("an object")
            .remove("sd_m");
        let read = parse_robot(robot.to_string().as_bytes(), "r.json").expect("a robot");
        assert_eq!(read.value.laser.expect("there").sd_m, 1e-3);
        assert!(read.notices.is_empty(), "{:?}", read.notices);
        robot["laser"]["sensor"] = "class-7mm".into();
        let unknown = parse_robot(robot.to_string().as_bytes(), "r.json").expect_err("refused");
        let message = unknown.to_string();
        assert!(
            message.starts_with("r.json, /laser/sensor: found \"class-7mm\", expected"),
            "{message}"
        );
    }
}
