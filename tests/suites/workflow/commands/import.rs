//! import: foreign files to datasets.

use tautline_validation::generators::your_data;

use super::program::{Folder, assert_valid, tautline};

/// A simulated dataset, and its poses as Excel in German writes them, in degrees.
fn bench() -> Folder {
    let folder = Folder::new();
    tautline(&[
        "simulate",
        "--robot",
        "mini",
        "--poses",
        "20",
        "--out",
        &folder.join("made"),
    ])
    .succeeded();
    let text = std::fs::read_to_string(folder.join("made/poses.csv")).expect("poses");
    let rows = text
        .lines()
        .map(|line| line.replace(',', ";").replace('.', ","));
    folder.write("log.csv", &rows.collect::<Vec<_>>().join("\r\n"));
    folder
}

fn entry_points(folder: &Folder, dataset: &str) -> Vec<f64> {
    let answer = tautline(&["identify", &folder.join(dataset), "--json", "-"])
        .succeeded()
        .json();
    let points = answer["entry_points_m"].as_array().expect("points").clone();
    points
        .iter()
        .flat_map(|point| point.as_array().expect("three").clone())
        .map(|value| value.as_f64().expect("a number"))
        .collect()
}

#[test]
fn a_foreign_log_gives_the_same_identification() {
    let folder = bench();
    let answer = tautline(&[
        "import",
        &folder.join("log.csv"),
        "--robot",
        "mini",
        "-o",
        &folder.join("data"),
        "--json",
        "-",
    ])
    .succeeded();
    let document = answer.json();
    assert_valid(&document);
    assert_eq!(
        (document["format"].as_str(), document["proposed"].as_bool()),
        (Some("tautline-import"), Some(true))
    );
    assert_eq!(
        document["suggestions"].as_array().map(Vec::len),
        Some(0),
        "{}",
        document["suggestions"]
    );
    assert_valid(&folder.json("data/recipe.json"));
    for (found, expected) in entry_points(&folder, "data")
        .iter()
        .zip(entry_points(&folder, "made"))
    {
        assert!((found - expected).abs() < 1e-9, "{found} and {expected}");
    }
    // The recipe is used again, and does not replace poses without being told.
    let recipe = folder.join("recipe.json");
    std::fs::copy(folder.join("data/recipe.json"), &recipe).expect("a copy");
    let again = [
        "import",
        &folder.join("log.csv"),
        "--recipe",
        &recipe,
        "-o",
        &folder.join("data"),
    ];
    tautline(&again).refused(&["poses.csv: already exists, expected --replace"]);
    tautline(&[&again[..], &["--replace"]].concat()).succeeded();
}

#[test]
fn channels_are_listed_with_a_proposal() {
    let folder = bench();
    let answer = tautline(&[
        "import",
        &folder.join("log.csv"),
        "--channels",
        "--robot",
        "mini",
    ])
    .succeeded();
    for part in [
        "log.csv: table",
        "rev_8",
        "force_1_n",
        "Recipe (proposed): every row is a pose",
        "rev_{i} is rev_{i}",
    ] {
        assert!(
            answer.stdout.contains(part),
            "{} lacks {part}",
            answer.stdout
        );
    }
    tautline(&["import", &folder.join("log.csv"), "--channels"]).refused(&["--robot: not given"]);
    tautline(&[
        "import",
        &folder.join("made/truth.json"),
        "--robot",
        "mini",
        "--channels",
    ])
    .refused(&["is a JSON file"]);
}

#[test]
fn mistakes_are_named_and_corrected() {
    let folder = bench();
    let text = std::fs::read_to_string(folder.join("made/poses.csv")).expect("poses");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let place = |name: &str| {
        header
            .iter()
            .position(|column| *column == name)
            .expect(name)
    };
    let (second, fifth) = (place("rev_2"), place("rev_5"));
    let exchanged = text.lines().skip(1).map(|line| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells.swap(second, fifth);
        cells.join(",")
    });
    let rows: Vec<String> = std::iter::once(header.join(",")).chain(exchanged).collect();
    let log = folder.write("exchanged.csv", &rows.join("\n"));
    let arguments = [
        "import",
        &log,
        "--robot",
        "mini",
        "-o",
        &folder.join("wrong"),
    ];
    let said = tautline(&arguments).succeeded().stdout;
    let sentence =
        "rev_2 follows the expected values of rev_5, and vice versa: their channels are swapped";
    assert!(said.contains(&format!("Check: {sentence}")), "{said}");
    let arguments = [
        "import",
        &log,
        "--robot",
        "mini",
        "-o",
        &folder.join("right"),
        "--apply-suggestions",
    ];
    let said = tautline(&arguments).succeeded().stdout;
    assert!(
        said.contains(&format!("Corrected: {sentence}")) && !said.contains("Check:"),
        "{said}"
    );
    assert_eq!(
        entry_points(&folder, "right"),
        entry_points(&folder, "made")
    );
}

/// A recording as two recorders wrote it: the winches, and the position of a marker by a camera with a clock of its own that is 3.2 s behind and 80 ppm
/// slow. Found within five standard deviations, which chance exceeds less often than once in a thousand.
#[test]
fn the_clock_of_a_second_recorder_is_found() {
    let folder = Folder::new();
    let made = folder.join("made");
    let simulate = [
        "simulate",
        "--robot",
        "mini",
        "--tracker",
        "--motion",
        "40",
        "--seed",
        "3",
        "--out",
        &made,
    ];
    tautline(&simulate).succeeded();
    let text = std::fs::read_to_string(folder.join("made/poses.csv")).expect("poses");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let (offset_s, drift) = (3.2, 8e-5);
    let part = |kept: &dyn Fn(&str) -> bool, own: &dyn Fn(f64) -> f64| {
        let columns: Vec<usize> = (0..header.len()).filter(|k| kept(header[*k])).collect();
        let names: Vec<&str> = columns.iter().map(|k| header[*k]).collect();
        let mut lines = vec![format!("time_s,{}", names.join(","))];
        let time = header
            .iter()
            .position(|name| *name == "time_s")
            .expect("times");
        for row in text.lines().skip(1) {
            let cells: Vec<&str> = row.split(',').collect();
            let values: Vec<&str> = columns.iter().map(|k| cells[*k]).collect();
            let at: f64 = cells[time].parse().expect("a time");
            lines.push(format!("{},{}", own(at), values.join(",")));
        }
        lines.join("\n")
    };
    let log = part(
        &|name| name.starts_with("rev_") || name.starts_with("force_"),
        &|time| time,
    );
    let take = part(
        &|name| name.starts_with("meas_") && name.ends_with("_m"),
        &|time| (time - offset_s) / (1.0 + drift),
    );
    let (log, take) = (
        folder.write("log.csv", &log),
        folder.write("take.csv", &take),
    );
    let out = folder.join("data");
    let arguments = [
        "import",
        &log,
        &take,
        "--robot",
        &folder.join("made/robot.json"),
        "--align-clocks",
        "-o",
        &out,
        "--json",
        "-",
    ];
    let answer = tautline(&arguments).succeeded();
    let said = answer
        .stderr
        .lines()
        .find(|line| line.contains("the clock of take"))
        .expect("a sentence");
    assert!(said.contains("behind that of log"), "{said}");
    let stated: Vec<f64> = said
        .split("(± ")
        .skip(1)
        .map(|rest| {
            rest.split(' ')
                .next()
                .and_then(|number| number.parse().ok())
                .expect("a number")
        })
        .collect();
    let clock = &folder.json("data/recipe.json")["clocks"][0];
    let number = |key: &str| clock[key].as_f64().unwrap_or(0.0);
    let expected = offset_s + drift * number("drift_from_s");
    let off = number("offset_s") - expected;
    assert!(
        off.abs() < 5e-3 * stated[0] && stated[0] < 10.0,
        "{said}: off by {off} s"
    );
    assert!(
        (number("drift") - drift).abs() < 5e-6 * stated[1] && stated[1] < 1000.0,
        "{said}"
    );
}

#[test]
fn a_dataset_and_its_results_are_exported() {
    let folder = bench();
    let made = folder.join("made");
    let file = folder.join("all.mat");
    let tables = [
        "--table", "poses", "--table", "values", "--table", "readings",
    ];
    let answer = tautline(&[&["export", &made, "-o", &file], &tables[..]].concat()).succeeded();
    assert!(
        answer.stdout.contains("poses with 21 rows"),
        "{}",
        answer.stdout
    );
    // The reader of MATLAB files finds the poses again, which give the same identification.
    let again = ["import", &file, "--robot", "mini", "--channels"];
    let listed = tautline(&again).succeeded().stdout;
    assert!(
        listed.contains("poses.rev_8") && listed.contains("values.sd"),
        "{listed}"
    );
    let csv = folder.join("values.csv");
    let one = ["export", &made, "-o", &csv];
    tautline(&[&one[..], &["--table", "values"]].concat()).succeeded();
    let values = std::fs::read_to_string(&csv).expect("values");
    assert!(
        values.starts_with("parameter,unit,nominal,value,sd,prior_sd,from_95,to_95\n"),
        "{values}"
    );
    let other = folder.join("other.csv");
    let several = [&["export", &made, "-o", &other], &tables[..]].concat();
    tautline(&several).refused(&["--table: found 3 tables"]);
    tautline(&["export", &made, "-o", &folder.join("a.xlsx")])
        .refused(&["expected a file that ends in .csv, .parquet or .mat"]);
}

#[test]
fn a_robot_of_caspr_becomes_a_robot() {
    let folder = Folder::new();
    let cable = |k: usize, place: &str| {
        format!(
            "<cable_ideal name=\"cable {k}\" attachment_reference=\"joint\"><attachments><attachment><link>0</link><location>{place}</location></attachment><attachment><link>1</link><location>0 0 0</location></attachment></attachments></cable_ideal>"
        )
    };
    let cables: Vec<String> = ["0 0 3", "4 0 3", "4 4 3", "0 4 3"]
        .iter()
        .enumerate()
        .map(|(k, place)| cable(k + 1, place))
        .collect();
    let text = format!(
        "<cables default_cable_set=\"a\"><cable_set id=\"a\">{}</cable_set></cables>",
        cables.join("\n")
    );
    let cables = folder.write("frame_cables.xml", &text);
    let bodies = folder.write("frame_bodies.xml", "<links><link_rigid num=\"1\"><joint type=\"T_XYZ\" q_initial=\"2 2 1\" q_min=\"1 1 0.5\" q_max=\"3 3 1.5\"/><physical><mass>2</mass></physical></link_rigid></links>");
    let robot = folder.join("robot.json");
    let answer = tautline(&["import", &cables, &bodies, "-o", &robot]).succeeded();
    assert!(
        answer.stdout.ends_with("robot.json: frame with 4 cables\n"),
        "{}",
        answer.stdout
    );
    tautline(&[
        "simulate",
        "--robot",
        &robot,
        "--poses",
        "3",
        "--out",
        &folder.join("made"),
    ])
    .succeeded();
}

#[test]
fn channels_that_nobody_recognises_are_assigned_on_the_command_line() {
    let folder = Folder::new();
    let made = folder.join("made");
    let simulated = [
        "simulate", "--robot", "mini", "--poses", "20", "--out", &made,
    ];
    tautline(&simulated).succeeded();
    let text = std::fs::read_to_string(folder.join("made/poses.csv")).expect("poses");
    let (header, rows) = text.split_once('\n').expect("a header");
    // Only what winches read, under names that say nothing.
    let kept: Vec<usize> = header
        .split(',')
        .enumerate()
        .filter(|(_, name)| name.starts_with("rev_"))
        .map(|(k, _)| k)
        .collect();
    let mut log: Vec<String> = vec![
        (0..8)
            .map(|k| format!("ch{k}"))
            .collect::<Vec<_>>()
            .join(","),
    ];
    for row in rows.lines() {
        let cells: Vec<&str> = row.split(',').collect();
        let cells: Vec<&str> = kept.iter().map(|k| cells[*k]).collect();
        log.push(cells.join(","));
    }
    let log = folder.write("log.csv", &log.join("\n"));
    let out = folder.join("data");
    let import = ["import", &log, "--robot", "mini", "-o", &out];
    let recipe = folder.join("proposed.json");
    tautline(&[&import[..], &["--recipe-out", &recipe]].concat()).refused(&[
        "no channel is assigned to a quantity of the robot",
        "found the channels ch0 to ch7 (--channels lists them)",
        "--set \"rev_{i}=CHANNEL [UNIT]\"",
        "edit ",
    ]);
    assert_valid(&folder.json("proposed.json"));
    let set = |text: &str| tautline(&[&import[..], &["--set", text]].concat());
    set("rev_{i}=Ch{i}")
        .refused(&["--set: found no channel \"Ch{i}\", expected one of ch0 to ch7"]);
    set("ref_{i}=ch{i}").refused(&["--set: found the column \"ref_{i}\""]);
    let answer = set("rev_{i}=ch{i} [rev]").succeeded();
    assert!(
        answer.stdout.contains("  rev_{i} is ch{i} in rev"),
        "{}",
        answer.stdout
    );
    let told = "the robot has a laser and force sensors, but there is no channel for them";
    assert!(answer.stderr.contains(told), "{}", answer.stderr);
    let read = std::fs::read_to_string(folder.join("data/poses.csv")).expect("poses");
    assert!(read.starts_with("pose,rev_1,rev_2"), "{read}");
}

#[test]
fn every_phase_can_be_tried_from_nothing() {
    let folder = Folder::new();
    let made = folder.join("made");
    tautline(&[
        "simulate",
        "--robot",
        "mini",
        "--phases",
        "--effect",
        "winch_scale:3:scale=0.01",
        "--out",
        &made,
    ])
    .succeeded();
    let fits = tautline(&["precalibrate", &made, "--json", "-"])
        .succeeded()
        .json();
    let ratio = |cable: usize| {
        let winch = &fits["winches"][cable];
        winch["cable_per_revolution_m"].as_f64().expect("a number")
            / winch["nominal_cable_per_revolution_m"]
                .as_f64()
                .expect("a number")
    };
    assert!(
        (ratio(2) - 1.01).abs() < 2e-4 && (ratio(3) - 1.0).abs() < 2e-4,
        "{} {}",
        ratio(2),
        ratio(3)
    );
    assert!(
        fits["home"].is_object() && fits["elongation"].is_object(),
        "{fits}"
    );
    let figures = tautline(&["accuracy", &folder.join("made/check.csv"), "--json", "-"])
        .succeeded()
        .json();
    assert_eq!(
        figures["poses"]["targets"].as_array().map(Vec::len),
        Some(5)
    );
}

#[test]
fn the_worked_examples_are_as_the_pages_have_them() {
    for (name, content) in your_data::files().expect("files") {
        let kept = std::fs::read_to_string(your_data::folder().join(name)).expect(name);
        assert!(
            kept == content,
            "{name} is out of date: validation your-data"
        );
    }
    for page in your_data::pages() {
        let text = std::fs::read_to_string(&page).expect("the page");
        assert_eq!(
            your_data::with_outputs(&text).expect("outputs"),
            text,
            "validation your-data writes the pages"
        );
    }
}
