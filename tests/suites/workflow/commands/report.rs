//! report: HTML and PDF of a session.

use super::program::{Folder, tautline};

#[test]
fn a_report_is_written_as_html_and_as_pdf() {
    let folder = Folder::new();
    let data = folder.join("mini");
    let effect = "winch_scale:cable-3:scale=0.02";
    tautline(&[
        "simulate", "--robot", "mini", "--poses", "20", "--effect", effect, "--out", &data,
    ])
    .succeeded();
    let html = folder.join("report.html");
    tautline(&["report", &data, "--out", &html]).succeeded();
    let text = std::fs::read_to_string(&html).expect("the report");
    for heading in [
        "Result",
        "Robot",
        "Method",
        "Identified values",
        "Goodness of fit",
    ] {
        assert!(
            text.contains(&format!(">{heading}</h2>")),
            "no heading {heading}"
        );
    }
    assert!(text.contains("cable-3"), "the finding is named");
    let pdf = folder.join("report.pdf");
    tautline(&["report", &data, "--out", &pdf]).succeeded();
    let bytes = std::fs::read(&pdf).expect("the report");
    assert!(bytes.starts_with(b"%PDF-") && bytes.len() > 20_000);
}

#[test]
fn parts_of_a_report_are_chosen() {
    let folder = Folder::new();
    let data = folder.join("mini");
    let arguments = [
        "simulate", "--robot", "mini", "--poses", "1", "--out", &data,
    ];
    tautline(&arguments).succeeded();
    let written = |more: &[&str]| {
        let out = folder.join("report.html");
        tautline(&[&["report", &data, "--out", &out, "--replace"], more].concat()).succeeded();
        std::fs::read_to_string(&out).expect("the report")
    };
    let text = written(&["--sections", "robot,about", "--title", "Own title"]);
    assert!(text.contains(">Robot</h2>") && !text.contains(">Result</h2>"));
    assert!(text.contains("<h1>Own title</h1>"));
    let text = written(&["--without", "robot"]);
    assert!(text.contains(">Result</h2>") && !text.contains(">Robot</h2>"));
    let out = folder.join("r.html");
    let wrong = ["report", &data, "--out", &out, "--without", "nonsense"];
    let answer = tautline(&wrong);
    assert_eq!(answer.code, Some(2));
    for part in ["nonsense", "adjustments"] {
        assert!(answer.stderr.contains(part), "{}", answer.stderr);
    }
}

#[test]
fn a_report_needs_a_name_that_says_its_format_and_something_to_report_on() {
    let folder = Folder::new();
    let data = folder.join("nothing");
    tautline(&["report", &data, "--out", &folder.join("r.html")]).refused(&["nothing"]);
    tautline(&["report", &data, "--out", &folder.join("r.doc")]).refused(&["r.doc", ".html"]);
    let table = folder.write("winch.csv", "cable,revolutions,length_m\ncable-1,1,0.1\n");
    tautline(&["report", &table, "--out", &folder.join("r.pdf")]).refused(&["winch.csv"]);
}

#[test]
fn a_report_judges_by_a_tolerance() {
    let folder = Folder::new();
    let data = folder.join("mini");
    let poses = [
        "simulate", "--robot", "mini", "--poses", "20", "--out", &data,
    ];
    tautline(&poses).succeeded();
    let out = folder.join("report.html");
    tautline(&["report", &data, "--out", &out, "--tolerance", "500"]).succeeded();
    let text = std::fs::read_to_string(&out).expect("the report");
    assert!(text.contains("All 8 pulleys are within the tolerance of 500 mm"));
    assert!(text.contains("Measured by: name, date, signature"));
    let other = folder.join("other.html");
    let wrong = ["report", &data, "--out", &other, "--tolerance", "0"];
    tautline(&wrong).refused(&["--tolerance", "positive"]);
}

#[test]
fn a_report_computes_only_what_its_parts_show() {
    let folder = Folder::new();
    let data = folder.join("mini");
    let simulate = [
        "simulate", "--robot", "mini", "--poses", "12", "--out", &data,
    ];
    tautline(&simulate).succeeded();
    // With two rows nothing can be identified.
    let path = format!("{data}/poses.csv");
    let text = std::fs::read_to_string(&path).expect("a file");
    let lines: Vec<&str> = text.lines().take(3).collect();
    std::fs::write(&path, lines.join("\n") + "\n").expect("written");
    let out = folder.join("r.html");
    let whole = tautline(&["report", &data, "--out", &folder.join("whole.html")]);
    assert!(whole.stderr.contains("found 2 rows"), "{}", whole.stderr);
    let parts = ["report", &data, "--out", &out, "--sections", "data,log"];
    tautline(&parts).succeeded();
    let text = std::fs::read_to_string(&out).expect("the report");
    assert!(text.contains(">Data</h2>") && !text.contains(">Result</h2>"));
}

/// The details of a certificate in which nothing is empty, but for the given lines.
fn details(folder: &Folder, without: &[&str]) -> String {
    let lines = [
        "format = \"tautline-certificate-details\"",
        "version = 1",
        "number = \"2026-017\"",
        "laboratory = \"Robot Works & Sons, Leeds\"",
        "country = \"GB\"",
        "place = \"Hall 3\"",
        "manufacturer = \"Cable Machines\"",
        "measured_from = \"2018-07-23\"",
        "measured_to = \"2018-07-24\"",
        "temperature_c = 21.5",
        "temperature_sd_k = 0.4",
        "expansion_per_k = 12e-6",
        "operation = \"20 kg, 0.5 m/s\"",
        "decision_rule = \"probability95\"",
        "[[instruments]]",
        "name = \"Laser DX-1\"",
        "serial_number = \"4711\"",
        "certificate = \"D-K-1\"",
        "calibrated_on = \"2017-03-12\"",
        "due_on = \"2018-03-12\"",
        "traceable_to = \"PTB\"",
    ];
    let is_wanted = |line: &&&str| !without.iter().any(|name| line.starts_with(name));
    let kept: Vec<&str> = lines.iter().filter(is_wanted).copied().collect();
    folder.write("certificate.toml", &kept.join("\n"))
}

#[test]
fn a_certificate_states_what_it_was_given_and_what_is_missing() {
    let folder = Folder::new();
    let data = folder.join("mini");
    let simulate = [
        "simulate", "--robot", "mini", "--poses", "20", "--out", &data,
    ];
    tautline(&simulate).succeeded();
    let (out, dcc) = (folder.join("c.html"), folder.join("c.xml"));
    let of = |details: &str, out: &str, further: &[&str]| {
        let who = ["--company", "Owner Ltd", "--operator", "A. Smith"];
        let base = ["report", &data, "--details", details, "-o", out];
        let more = ["--replace", "--tolerance", "20"];
        tautline(&[&base[..], &who, &more, further].concat())
    };
    let drawn = ["--monte-carlo", "100"];
    let answer = of(
        &details(&folder, &["operation", "serial_number"]),
        &out,
        &drawn,
    );
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let stated = "Serial number of the robot (in its description), Load, speed and warming up";
    assert!(answer.stderr.contains(stated), "{}", answer.stderr);
    let text = std::fs::read_to_string(&out).expect("the certificate");
    for part in [
        "<h1>Calibration certificate 2026-017</h1>",
        "Laboratory: Robot Works &amp; Sons, Leeds",
        "Measured: 2018-07-23 to 2018-07-24",
        "Laser DX-1: its calibration was due on 2018-03-12.",
        "distances are shorter by 0.0180 ± 0.0048 mm per metre",
        "a verdict needs a probability of 95 %",
        "Probability that all pulleys are within the tolerance",
        "must not be reproduced except in full",
        "Laser DX-1: serial number",
        "effective degrees of freedom",
        "100 of the identifications converged",
        "End of the document.",
    ] {
        assert!(text.contains(part), "no {part}");
    }
    of(&details(&folder, &["country", "number"]), &dcc, &[])
        .refused(&["Number of the certificate and Country of the laboratory"]);
    of(&details(&folder, &[]), &dcc, &[]).succeeded();
    of(&details(&folder, &[]), &dcc, &drawn).refused(&["--monte-carlo", ".html or .pdf"]);
    let page = include_str!("../../../../docs/CERTIFICATE.md");
    let example = page
        .split("```")
        .nth(1)
        .and_then(|code| code.strip_prefix("toml"));
    let example = folder.write("example.toml", example.expect("an example"));
    of(&example, &dcc, &[]).succeeded();
    let wrong = folder.write(
        "wrong.toml",
        "format = \"tautline-certificate-details\"\nversion = 1\nnumer = \"1\"\n",
    );
    of(&wrong, &out, &[]).refused(&["wrong.toml", "numer"]);
}
