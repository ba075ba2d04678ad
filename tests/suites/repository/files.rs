//! Files shown in the documents exist and are small.

use std::fs;
use std::path::Path;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Targets of the links of a document that are files of ours.
fn links(text: &str) -> Vec<&str> {
    let targets = text.split("](").skip(1);
    let targets = targets.filter_map(|rest| rest.split(')').next());
    let files = targets.filter(|target| !target.contains("://") && !target.starts_with('#'));
    files
        .filter_map(|target| target.split('#').next())
        .collect()
}

#[test]
fn links_lead_to_files() {
    for name in [
        "README.md",
        "docs/ARCHITECTURE.md",
        "docs/FORMATS.md",
        "docs/NOTATION.md",
    ] {
        let path = root().join(name);
        let text = fs::read_to_string(&path).expect("a document");
        let folder = path.parent().expect("a folder");
        for link in links(&text) {
            assert!(folder.join(link).exists(), "{name}: {link}");
        }
    }
    assert_eq!(
        links("[a](b.md#c), [d](https://e), ![f](g.png)"),
        ["b.md", "g.png"]
    );
}

#[test]
fn pictures_are_small() {
    let pictures = fs::read_dir(root().join("screenshots")).expect("pictures");
    let mut count = 0;
    for picture in pictures {
        let picture = picture.expect("a file");
        let most = if picture.file_name() == "tour.png" {
            3_000_000
        } else {
            250_000
        };
        let bytes = picture.metadata().expect("a size").len();
        assert!(bytes < most, "{:?}: {bytes} bytes", picture.file_name());
        count += 1;
    }
    assert!(count > 8, "only {count} pictures");
}
