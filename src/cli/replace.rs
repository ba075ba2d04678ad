//! `--replace`.

use std::fs;
use std::path::Path;

use anyhow::Result;

use crate::BadInput;
use crate::output::{self, JsonOutput, is_standard};

/// Permission to replace files that exist.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct Replace {
    /// Replace files that exist
    #[arg(long)]
    replace: bool,
}

impl Replace {
    /// Refuses, before anything is computed, to write over a file unless it is to be replaced, and to write two documents
    /// to standard output. A file written with `--json` is replaced like that of a redirection: the same command may be
    /// repeated.
    pub fn permit(self, files: &[Option<&Path>], json: Option<&JsonOutput>) -> Result<()> {
        let files = files.iter().flatten();
        let (standard, files): (Vec<&Path>, Vec<&Path>) = files.partition(|file| is_standard(file));
        let documents = standard.len() + usize::from(json.is_some_and(|json| !json.is_text()));
        if documents > 1 {
            return Err(BadInput::new(format!(
                "-: found {documents} outputs for standard output, expected one"
            )));
        }
        if !standard.is_empty() {
            output::expect_document();
        }
        match files.into_iter().find(|file| self.keeps(file)) {
            Some(file) => Err(BadInput::new(format!(
                "{}: already exists, expected --replace or another name",
                file.display()
            ))),
            None => Ok(()),
        }
    }

    /// Whether a file has content that must not be lost; devices and empty files, such as those of `mktemp`, have none.
    fn keeps(self, file: &Path) -> bool {
        !self.replace && fs::metadata(file).is_ok_and(|found| found.is_file() && found.len() > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_with_content_are_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let [full, empty, none] = ["full", "empty", "none"].map(|name| folder.path().join(name));
        fs::write(&full, "content").expect("written");
        fs::write(&empty, "").expect("written");
        let keeping = Replace { replace: false };
        let replacing = Replace { replace: true };
        for file in [&empty, &none] {
            keeping
                .permit(&[Some(file), None], None)
                .expect("permitted");
        }
        replacing.permit(&[Some(&full)], None).expect("permitted");
        let error = keeping.permit(&[Some(&none), Some(&full)], None);
        let error = error.expect_err("refused").to_string();
        assert!(error.starts_with(&full.display().to_string()), "{error}");
        assert!(error.contains("expected --replace"), "{error}");
    }

    #[test]
    fn standard_output_takes_one_document() {
        let standard = Some(Path::new("-"));
        let error = Replace::default().permit(&[standard, standard], None);
        let error = error.expect_err("refused").to_string();
        assert_eq!(
            error,
            "-: found 2 outputs for standard output, expected one"
        );
    }
}
