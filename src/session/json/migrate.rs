//! Migration of files from older versions, step by step.

use serde_json::{Map, Value};
use tautline_files::{Location, ReadError, quoted};

use super::{VersionedFile, explain};

/// Migration from one version of a format to the next.
#[derive(Clone, Copy)]
pub struct Migration {
    /// The version it starts from.
    pub from: u32,
    /// Changes the JSON object; returns an error if it cannot interpret it.
    pub apply: fn(&mut Map<String, Value>) -> Result<(), String>,
}

/// Checks and removes `format` and `version`, and migrates the rest to the present version.
pub(crate) fn bring_up_to_date<T: VersionedFile>(
    document: &mut Map<String, Value>,
    migrations: &[Migration],
    file: &str,
) -> Result<(), ReadError> {
    take_format(document, T::FORMAT, file)?;
    let mut version = take_version::<T>(document, file)?;
    while version < T::VERSION {
        let fail = |message| ReadError::new(file, Location::Pointer("/version".into()), message);
        let Some(step) = migrations.iter().find(|step| step.from == version) else {
            return Err(fail(format!(
                "found version {version} of {:?}, which this program cannot read, expected {}",
                T::FORMAT,
                T::VERSION
            )));
        };
        (step.apply)(document)
            .map_err(|why| fail(format!("cannot be migrated from version {version}: {why}")))?;
        version += 1;
    }
    Ok(())
}

fn take_format(
    document: &mut Map<String, Value>,
    expected: &str,
    file: &str,
) -> Result<(), ReadError> {
    let message = match document.remove("format") {
        Some(Value::String(found)) if found == expected => return Ok(()),
        Some(Value::String(found)) => format!("found {}, expected {expected:?}", quoted(&found)),
        Some(other) => format!("found {}, expected {expected:?}", explain::kind(&other)),
        None => format!("not given, expected {expected:?}"),
    };
    Err(ReadError::new(
        file,
        Location::Pointer("/format".into()),
        message,
    ))
}

fn take_version<T: VersionedFile>(
    document: &mut Map<String, Value>,
    file: &str,
) -> Result<u32, ReadError> {
    let present = T::VERSION;
    let message = match document.remove("version") {
        Some(Value::Number(number)) => match number.as_u64() {
            Some(found) if (1..=u64::from(present)).contains(&found) => {
                return Ok(u32::try_from(found).unwrap_or(present));
            }
            Some(found) if found > u64::from(present) => format!(
                "found version {found} of {:?}, which is newer than this program, \
                 expected at most {present}",
                T::FORMAT
            ),
            _ => format!("found {number}, expected a whole number from 1 to {present}"),
        },
        Some(other) => format!(
            "found {}, expected a whole number from 1 to {present}",
            explain::kind(&other)
        ),
        None => format!("not given, expected {present}"),
    };
    Err(ReadError::new(
        file,
        Location::Pointer("/version".into()),
        message,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use schemars::JsonSchema;
    use serde::{Deserialize, Serialize};

    #[derive(Serialize, Deserialize, JsonSchema)]
    struct Note {
        text: String,
    }

    impl VersionedFile for Note {
        const FORMAT: &'static str = "tautline-note";
        const VERSION: u32 = 3;
        const MAX_BYTES: u64 = 1 << 20;
    }

    const STEPS: [Migration; 2] = [
        Migration {
            from: 2,
            apply: |document| {
                let text = document.remove("body").ok_or("no body")?;
                document.insert("text".into(), text);
                Ok(())
            },
        },
        Migration {
            from: 1,
            apply: |document| {
                document.insert("body".into(), "from version 1".into());
                Ok(())
            },
        },
    ];

    fn migrated(json: Value) -> Result<Map<String, Value>, String> {
        let mut document = json.as_object().cloned().expect("an object");
        bring_up_to_date::<Note>(&mut document, &STEPS, "note.json")
            .map(|()| document)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn steps_form_a_chain() {
        let head = serde_json::json!({"format": "tautline-note", "version": 1});
        let document = migrated(head).expect("two steps");
        assert_eq!(
            Value::Object(document),
            serde_json::json!({"text": "from version 1"})
        );
    }

    #[test]
    fn a_failing_step_says_why() {
        let head = serde_json::json!({"format": "tautline-note", "version": 2});
        assert_eq!(
            migrated(head).expect_err("no body"),
            "note.json, /version: cannot be migrated from version 2: no body"
        );
    }

    #[test]
    fn newer_versions_are_refused_by_name() {
        let head = serde_json::json!({"format": "tautline-note", "version": 4});
        assert_eq!(
            migrated(head).expect_err("newer"),
            "note.json, /version: found version 4 of \"tautline-note\", which is newer than this \
             program, expected at most 3"
        );
    }

    #[test]
    fn a_missing_step_is_an_error() {
        let mut document = Map::new();
        document.insert("format".into(), "tautline-note".into());
        document.insert("version".into(), 1.into());
        let error = bring_up_to_date::<Note>(&mut document, &STEPS[..1], "n").expect_err("gap");
        assert!(error.to_string().contains("found version 1"), "{error}");
    }
}
