//! The files of packages exist and are consistent.

use std::fs;
use std::path::Path;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn text(name: &str) -> String {
    fs::read_to_string(Path::new(ROOT).join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The text between two others.
fn between<'a>(text: &'a str, begin: &str, end: &str) -> &'a str {
    let (_, after) = text.split_once(begin).expect(begin);
    after.split_once(end).expect(end).0
}

#[test]
fn a_session_has_one_type_with_an_icon_that_the_program_opens() {
    let desktop = text("assets/linux/tautline.desktop");
    let kind = text("assets/linux/tautline.xml");
    let about = text("assets/linux/tautline.metainfo.xml");
    let name = between(&kind, "<mime-type type=\"", "\"");
    assert!(desktop.contains(&format!("\nMimeType={name};\n")));
    assert!(about.contains(&format!("<mediatype>{name}</mediatype>")));
    let icon = text(&format!("assets/linux/{}.svg", name.replace('/', "-")));
    assert!(icon.starts_with("<svg"));
    assert!(desktop.contains("\nExec=tautline %f\n"));
    assert!(about.contains(">tautline.desktop</launchable>"));
    // The name that the window suggests for a new session.
    let suggested = text("src/workbench/commands/file.rs");
    let ending = between(&kind, "<glob pattern=\"*", "\"");
    assert!(
        suggested.contains(&format!("\"session{ending}\"")),
        "{ending}"
    );
    // The type is known by content, too: as the program writes sessions.
    let session = text("sessions/clean-mini/session.json");
    let magic = between(&kind, "offset=\"0:64\" value=\"", "\"/>").replace("&quot;", "\"");
    let compact = magic.replace(": ", ":");
    assert!(session[..80].contains(&compact), "{compact}");
}

#[test]
fn files_of_the_debian_package_are_there() {
    let manifest: toml::Table = text("src/workbench/Cargo.toml").parse().expect("TOML");
    let deb = &manifest["package"]["metadata"]["deb"];
    let assets = deb["assets"].as_array().expect("assets");
    let mut count = 0;
    for asset in assets {
        let source = asset[0].as_str().expect("a path");
        // The program, and the files that it writes itself.
        if !source.contains("target/") {
            let path = Path::new(ROOT).join("src/workbench").join(source);
            assert!(path.is_file(), "{source}");
            count += 1;
        }
    }
    // Copyright, changelog, menu entry, icons of the program and of a session, and the type of a session.
    assert_eq!(count, 6);
}

#[test]
fn packages_have_all_formats_and_store_passwords() {
    let script = text(".ci/package");
    let is_build = |line: &&str| line.trim_start().starts_with("cargo \"${for_cargo[@]}\"");
    let builds: Vec<&str> = script.lines().filter(is_build).collect();
    assert_eq!(builds.len(), 1);
    assert!(builds[0].ends_with(" --features more-formats,keyring"));
}

/// All files state the same publisher of the program.
#[test]
fn who_publishes_is_stated_alike() {
    let about = text("assets/linux/tautline.metainfo.xml");
    let developers = between(&about, "<developer_name>", "</developer_name>");
    for (file, said) in [
        ("CITATION.cff", format!("\n  - name: {developers}\n")),
        ("LICENSE-MIT", format!(" {developers}\n")),
        ("assets/linux/copyright", format!(" {developers}\n")),
        (
            "src/python/pyproject.toml",
            format!("authors = [{{ name = \"{developers}\" }}]"),
        ),
        (
            "src/workbench/Cargo.toml",
            format!("copyright = \"2026, {developers}\""),
        ),
    ] {
        assert!(text(file).contains(&said), "{file} lacks {said:?}");
    }
    let home = |file: &str, begin: &str, end: &str| {
        let text = text(file);
        let after = text.split_once(begin)?.1;
        Some(after.split_once(end).expect(end).0.to_owned())
    };
    let homes = [
        home(
            "assets/linux/tautline.metainfo.xml",
            "<url type=\"homepage\">",
            "</url>",
        ),
        home("src/workbench/Cargo.toml", "\nhomepage = \"", "\""),
        home("src/python/pyproject.toml", "\nHomepage = \"", "\""),
        home("CITATION.cff", "\nurl: \"", "\""),
    ];
    assert!(homes.iter().all(|home| *home == homes[0]), "{homes:?}");
}
