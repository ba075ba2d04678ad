//! Whole reports of a small robot.

use hayro_syntax::Pdf;
use hayro_syntax::object::{Dict, Object};
use quick_xml::Reader;
use quick_xml::events::Event;
use tautline_core::diagnosis::Verdict;
use tautline_core::effect::EffectSetting;
use tautline_core::estimation::{Control, Method};
use tautline_link::parameters::parameters_of;
use tautline_session::{
    Adjustment, CheckKind, CheckPose, CheckRow, LogEntry, Outcome, Phase, Session, Stage,
    Timestamp, ValueChange, Verification,
};

use super::document::{Block, Document};
use super::*;
use crate::diagnosis::Diagnosed;
use crate::diagnosis::samples::{dataset, diagnosed};
use crate::identification::{Identification, IdentificationRequest, identify, identify_session};
use crate::results::record;

/// A name that would be a program if it were taken as markup.
const HOSTILE: &str = "<script>alert(1)</script> & \"cable\" \u{1b}[2J\u{202e}";

struct Sample {
    choice: ReportChoice,
    session: Session,
    fit: Identification,
    diagnosis: Diagnosed,
}

fn time(minutes: i64) -> Timestamp {
    Timestamp::from_unix_seconds(1_532_336_700 + 60 * minutes)
}

fn row(cycle: i64, off_m: f64) -> CheckRow {
    let pose = |x: f64| CheckPose {
        position_m: [x, 0.0, 1.0],
        orientation_wxyz: None,
    };
    CheckRow {
        kind: CheckKind::Pose,
        target: "P1".to_owned(),
        cycle,
        sample: 0,
        time_s: None,
        commanded: pose(0.0),
        attained: pose(off_m),
    }
}

fn verification(stage: Stage, off_m: f64) -> Verification {
    Verification {
        time: time(30),
        title: "ISO cube".to_owned(),
        stage,
        rows: vec![row(1, off_m), row(2, off_m)],
        accepted: None,
    }
}

/// A session with everything that a report can have.
fn sample(verdicts: &[Verdict]) -> Sample {
    let mut data = dataset();
    data.robot.cables[0].name = HOSTILE.to_owned();
    let request = IdentificationRequest::new(data.clone(), Method::Joint, &[]);
    let request = request.expect("a request");
    let fit = identify(&request, &mut |_| Control::Continue).expect("a fit");
    let mut session = Session::new("Trial", data.robot.clone(), time(0));
    session.measurements = data.measurements.clone();
    session.exclude(5).expect("a measured pose");
    session.record(LogEntry {
        time: time(1),
        phase: Phase::Poses,
        text: format!("Measured with {HOSTILE}."),
    });
    session.add_verification(verification(Stage::Before, 0.012));
    session.add_verification(verification(Stage::After, 0.0006));
    session.add_adjustment(Adjustment {
        time: time(20),
        operator: "Ann".to_owned(),
        controller: "simulated".to_owned(),
        changes: vec![ValueChange {
            name: "cable-2.entry_point.x_m".to_owned(),
            unit: "m".to_owned(),
            before: 1.0,
            after: 1.0123,
        }],
        outcome: Outcome::Written,
        read_back: Vec::new(),
        restores: false,
    });
    Sample {
        choice: ReportChoice::default(),
        diagnosis: diagnosed(&data, verdicts),
        session,
        fit,
    }
}

impl Sample {
    fn input(&self) -> ReportInput<'_> {
        ReportInput {
            session: &self.session,
            fit: Some(&self.fit),
            diagnosis: Some(&self.diagnosis),
            outdated: false,
            diagnosis_outdated: false,
            picture: None,
            next_calibration: None,
            monte_carlo: None,
            choice: &self.choice,
            now: time(60),
        }
    }

    fn html(&self) -> String {
        let bytes = render_report(&self.input(), ReportFormat::Html).expect("HTML");
        String::from_utf8(bytes).expect("text")
    }
}

/// A picture of 4 x 3 pixels.
fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::new(4, 3)
        .write_to(&mut bytes, image::ImageFormat::Png)
        .expect("a picture");
    bytes.into_inner()
}

/// Every element is closed by its own end tag; gives names and attributes of all.
fn elements(html: &str) -> Vec<(String, String)> {
    const VOID: [&str; 2] = ["meta", "img"];
    let mut reader = Reader::from_str(html);
    let config = reader.config_mut();
    config.check_end_names = false;
    config.allow_unmatched_ends = true;
    let (mut open, mut all) = (Vec::new(), Vec::new());
    loop {
        match reader.read_event().expect("well-formed") {
            Event::Start(tag) => {
                let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
                all.push((name.clone(), String::from_utf8_lossy(&tag).into_owned()));
                if !VOID.contains(&name.as_str()) {
                    open.push(name);
                }
            }
            Event::Empty(tag) => {
                let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
                all.push((name, String::from_utf8_lossy(&tag).into_owned()));
            }
            Event::End(tag) => {
                let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
                assert_eq!(open.pop(), Some(name));
            }
            Event::Eof => break,
            _ => {}
        }
    }
    assert!(open.is_empty(), "{open:?}");
    all
}

fn assert_tables_are_whole(document: &Document) {
    let blocks = document.sections.iter().flat_map(|s| &s.blocks);
    let mut tables = 0;
    for block in blocks {
        if let Block::Table(table) = block {
            tables += 1;
            for row in &table.rows {
                assert_eq!(row.len(), table.columns.len(), "{}", table.caption);
            }
        }
    }
    assert!(tables >= 8, "only {tables} tables");
}

#[test]
fn html_is_well_formed_and_needs_nothing_else() {
    let sample = sample(&[Verdict::Named, Verdict::Ambiguous, Verdict::Unknown]);
    let png = png();
    let input = ReportInput {
        picture: Some(&png),
        next_calibration: None,
        monte_carlo: None,
        ..sample.input()
    };
    assert_tables_are_whole(&content::document(&input));
    let html = render_report(&input, ReportFormat::Html).expect("HTML");
    let html = String::from_utf8(html).expect("text");
    let elements = elements(&html);
    assert!(elements.iter().any(|(name, _)| name == "svg"));
    for (name, tag) in &elements {
        assert!(!["script", "link", "iframe", "object"].contains(&name.as_str()));
        let is_local = !tag.contains("src=") || tag.contains("src=\"data:image/png;base64,");
        assert!(is_local && !tag.contains("href"), "{tag}");
    }
    // Should something have come in with the content after all, a browser loads and runs nothing.
    let policy = "http-equiv=\"Content-Security-Policy\" content=\"default-src 'none';";
    assert!(html.contains(policy), "{html}");
    assert!(!html.contains("http:") && !html.contains("https:") && !html.contains("url("));
}

#[test]
fn names_of_files_are_text_in_html() {
    let html = sample(&[Verdict::Named]).html();
    assert!(!html.contains("<script"));
    assert!(html.contains(
        "&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;cable&quot; \\u{1b}[2J\\u{202e}"
    ));
    assert!(!html.contains(crate::wording::is_obeyed));
}

#[test]
fn the_words_say_how_sure_they_are() {
    let html = sample(&[Verdict::Named, Verdict::Ambiguous, Verdict::Unknown]).html();
    for part in [
        "does NOT explain the readings",
        "1. Winch scale (cable-3), almost certainly (99.8 %)",
        "0.31 ± 0.04 %",
        "0.23 to 0.39 %",
        "2. Pulley radius (cable-3), more likely than not (60 %)",
        "Causes that these data cannot separate",
        "3 to 2",
        "Possible, but not established: Build-up of layers on the drum (cable-2), 12 %.",
        "Measure far from cable-3.",
        "What remains: unexplained error in the length readings of cable-3",
        "no effect in the catalogue explains",
        "12 mm before the adjustment, 0.6 mm after it, 95 % better",
        "all values were written and read back",
        "pose 5",
        "10.3390/s18072392",
        "tautline-session-1",
        "+12.300",
    ] {
        assert!(html.contains(part), "no {part:?}");
    }
    let clean = sample(&[]).html();
    assert!(clean.contains("the model explains the readings of 13 poses"));
    assert!(clean.contains("No cause was found."));
}

/// Titles of the outline.
fn outline(pdf: &Pdf) -> Vec<String> {
    let root: Dict<'_> = pdf.xref().get(pdf.xref().root_id()).expect("the catalogue");
    let outlines: Dict<'_> = root.get("Outlines").expect("an outline");
    let mut titles = Vec::new();
    let mut next: Option<Dict<'_>> = outlines.get("First");
    while let Some(item) = next {
        let Some(Object::String(title)) = item.get::<Object<'_>>("Title") else {
            panic!("a heading without a title");
        };
        titles.push(String::from_utf8_lossy(title.as_bytes()).into_owned());
        next = item.get("Next");
    }
    titles
}

#[test]
fn pdf_has_the_same_headings() {
    let sample = sample(&[Verdict::Named, Verdict::Ambiguous]);
    let png = png();
    let input = ReportInput {
        picture: Some(&png),
        next_calibration: None,
        monte_carlo: None,
        ..sample.input()
    };
    let bytes = render_report(&input, ReportFormat::Pdf).expect("PDF");
    let pdf = Pdf::new(bytes).expect("a PDF that can be read");
    assert!(pdf.pages().len() >= 3);
    for page in pdf.pages().iter() {
        let (width, height) = page.base_dimensions();
        assert!((width - 595.28).abs() < 0.1 && (height - 841.89).abs() < 0.1);
        assert!(
            page.resources().fonts.keys().count() > 0,
            "text, not pictures of it"
        );
    }
    let headings = content::document(&input).sections;
    let headings: Vec<String> = headings.into_iter().map(|s| s.title).collect();
    assert_eq!(outline(&pdf), headings);
}

#[test]
fn nothing_leaves_the_page() {
    let sample = sample(&[Verdict::Ambiguous; 3]);
    let document = content::document(&sample.input());
    pdf::assert_on_pages(&document);
}

#[test]
fn a_report_is_the_same_every_time() {
    let sample = sample(&[Verdict::Named]);
    for format in [ReportFormat::Html, ReportFormat::Pdf] {
        let once = || render_report(&sample.input(), format).expect("a report");
        assert_eq!(once(), once());
    }
}

#[test]
fn parts_can_be_left_out_and_the_head_is_ones_own() {
    let mut sample = sample(&[]);
    let whole = sample.html();
    assert!(whole.contains("Calibration report: Trial"));
    assert!(whole.contains("2 entry point x") && !whole.contains("entry_point"));
    sample.choice = ReportChoice {
        without: [Part::Adjustments, Part::Log].into(),
        title: "Acceptance <test>".to_owned(),
        header: "Form 7".to_owned(),
        operator: "B. Smith".to_owned(),
        company: "Cables & Co".to_owned(),
        tolerance_m: None,
    };
    let html = sample.html();
    for text in [
        "Acceptance &lt;test&gt;",
        "Form 7",
        "Operator: B. Smith",
        "Company: Cables &amp; Co",
    ] {
        assert!(html.contains(text), "{text}");
    }
    assert!(html.contains("<h2>Uncertainty</h2>"));
    for heading in ["Adjustments of the controller", "Log of the session"] {
        let heading = format!("<h2>{heading}</h2>");
        assert!(whole.contains(&heading) && !html.contains(&heading));
    }
    assert!(html.contains("About this report"));
    assert!(render_report(&sample.input(), ReportFormat::Pdf).is_ok());
    sample.choice.without = Part::ALL.into();
    assert!(content::document(&sample.input()).sections.is_empty());
}

/// The sample's model explains its data, so its pulleys are judged.
#[test]
fn a_tolerance_is_judged_with_the_uncertainty_on_the_safe_side() {
    let mut sample = sample(&[]);
    assert!(!sample.html().contains("JCGM 106"));
    for (tolerance_m, verdict) in [
        (10.0, "are within the tolerance of 10000 mm"),
        (1e-9, "utside the tolerance of 0.000001 mm"),
    ] {
        sample.choice.tolerance_m = Some(tolerance_m);
        let html = sample.html();
        assert!(html.contains(verdict), "{verdict}");
        assert!(html.contains("JCGM 106") && html.contains("Signatures"));
        assert!(html.contains("Decision rule: guarded acceptance and guarded rejection"));
    }
    sample.choice.tolerance_m = Some(10.0);
    assert!(sample.html().contains("more than 99.9 %"), "conformance");
    // Nothing is judged by uncertainties that do not hold.
    sample.fit.solution.chi2 *= 1e3;
    let html = sample.html();
    assert!(html.contains("No pulley is judged"));
    assert!(!html.contains("JCGM 106"));
}

#[test]
fn none_is_within_where_all_are_outside() {
    let mut sample = sample(&[]);
    for place in &mut sample.fit.solution.globals.entry_points {
        place[0] += 1.0;
    }
    sample.choice.tolerance_m = Some(3e-3);
    let html = sample.html();
    let pulleys = sample.fit.dataset.robot.cable_count();
    assert!(html.contains(&format!(
        "All {pulleys} pulleys are outside the tolerance of 3 mm."
    )));
    assert!(!html.contains("The others are within it"));
}

#[test]
fn the_report_of_a_simulated_robot_says_so_on_every_page_and_at_the_signatures() {
    const MARK: &str = "SIMULATED DATA";
    let mut sample = sample(&[Verdict::Named]);
    sample.session.measurements.truth = Default::default();
    let of_machine = content::document(&sample.input());
    assert!(!sample.html().contains(MARK));
    assert!(
        pdf::page_texts(&of_machine)
            .iter()
            .flatten()
            .all(|text| !text.contains(MARK))
    );
    sample.session.has_simulated_readings = true;
    let html = sample.html();
    assert!(html.contains(&format!("<p class=\"marking\">{MARK}</p>")));
    let (_, signatures) = html.split_once("<h2>Signatures</h2>").expect("signatures");
    assert!(signatures.contains(&format!("{MARK}: these readings are of a simulated robot")));
    let pages = pdf::page_texts(&content::document(&sample.input()));
    assert!(pages.len() >= 3);
    assert!(
        pages
            .iter()
            .all(|page| page.iter().any(|text| text == MARK))
    );
}

#[test]
fn the_plots_of_residuals_show_all_points() {
    let points = [(1, 0.5), (2, -250.0)];
    let drawing = plots::residuals("cable-1", &points, "");
    let all = drawing.shapes.iter();
    let discs: Vec<f64> = all
        .filter_map(|shape| match shape {
            crate::plot::drawing::Shape::Disc { at, .. } => Some(at[1]),
            _ => None,
        })
        .collect();
    // The far one is far below the other, and on the plot.
    assert!(discs.len() == 2 && discs[1] > discs[0] + 30.0, "{discs:?}");
    assert!(discs.iter().all(|y| *y < drawing.size[1]));
    assert!(
        drawing.svg().contains("\u{2212}200"),
        "the axis has its values"
    );
}

/// Two fits of the same data: nothing differs.
#[test]
fn a_comparison_has_a_report() {
    let sample = sample(&[]);
    let fits = [&sample.fit, &sample.fit];
    let comparison = crate::comparison::compare_identifications(fits, 0.05).expect("compared");
    let input = ComparisonInput {
        names: ["Before <b>", "After"],
        fits,
        is_simulated: true,
        comparison: &comparison,
        choice: &sample.choice,
        now: time(60),
    };
    let html = render_comparison(&input, ReportFormat::Html).expect("HTML");
    let html = String::from_utf8(html).expect("text");
    elements(&html);
    for text in [
        "Comparison: Before &lt;b&gt; and After",
        "No pulley has moved",
        "Compared by: name, date, signature",
        "From above",
        "SIMULATED DATA: these readings are of a simulated robot",
    ] {
        assert!(html.contains(text), "{text}");
    }
    pdf::assert_on_pages(&content::comparison::document(&input));
    assert!(render_comparison(&input, ReportFormat::Pdf).is_ok());
}

/// The text of the leading sentences of the first section.
fn leads(input: &ReportInput<'_>) -> Vec<String> {
    let result = content::document(input).sections.swap_remove(0);
    let lead = |block: Block| match block {
        Block::Lead(text) => Some(text),
        _ => None,
    };
    result.blocks.into_iter().filter_map(lead).collect()
}

/// A diagnosis found a winch scale, which was then added to the model and identified; its values were written, and the
/// robot was verified and accepted.
fn sample_with_a_fault_added() -> Sample {
    let mut sample = sample(&[Verdict::Named]);
    let document = sample.diagnosis.document();
    let found = record(&sample.session, "Diagnosis", &document, time(5));
    sample.session.add_result(found);
    let scale = EffectSetting {
        effect: "winch_scale".to_owned(),
        targets: vec!["cable-3".to_owned()],
        parameters: [("scale".to_owned(), 0.0)].into(),
    };
    sample.session.settings.identification.effects = vec![scale];
    sample.fit = identify_session(&sample.session, &mut |_| Control::Continue).expect("a fit");
    let values = parameters_of(&sample.fit.model).into_iter();
    sample.session.add_adjustment(Adjustment {
        time: time(40),
        operator: "Ada".to_owned(),
        controller: "simulated".to_owned(),
        changes: values
            .map(|parameter| ValueChange {
                unit: parameter.unit.to_owned(),
                before: 0.0,
                after: parameter.value,
                name: parameter.name,
            })
            .collect(),
        outcome: Outcome::Written,
        read_back: Vec::new(),
        restores: false,
    });
    sample
}

#[test]
fn the_report_leads_with_the_model_that_was_written() {
    let mut sample = sample_with_a_fault_added();
    let earlier = |sample: &Sample| {
        let input = ReportInput {
            diagnosis_outdated: true,
            ..sample.input()
        };
        let html = render_report(&input, ReportFormat::Html).expect("HTML");
        (leads(&input), String::from_utf8(html).expect("text"))
    };
    let (lead, html) = earlier(&sample);
    assert_eq!(
        lead,
        ["planar: the model explains the readings of 12 poses."]
    );
    for text in [
        "Winch scale (cable-3): ",
        "Found by the diagnosis of ",
        "almost certainly (99.8 %)",
        "was not diagnosed after the last change",
        "These values were written to the controller by Ada on ",
        "measured before the values were last written",
    ] {
        assert!(html.contains(text), "no {text:?}");
    }
    assert!(!html.contains("accepted") && !html.contains("which the model does not have"));
    sample.session.add_verification(Verification {
        time: time(50),
        ..verification(Stage::After, 0.0006)
    });
    sample.session.accept("Ben", time(55));
    let (_, html) = earlier(&sample);
    assert!(html.contains("The robot was accepted by Ben on "));
    assert!(!html.contains("measured before the values were last written"));
    // Other values end the acceptance.
    sample.session.exclude(7).expect("a measured pose");
    sample.fit = identify_session(&sample.session, &mut |_| Control::Continue).expect("a fit");
    let (_, html) = earlier(&sample);
    assert!(
        html.contains("The controller holds other values than these") && !html.contains("accepted")
    );
}

#[test]
fn a_report_without_a_fault_leads_with_the_diagnosis_and_an_outdated_one_says_so_first() {
    let mut sample = sample(&[]);
    let input = sample.input();
    assert_eq!(
        leads(&input),
        ["planar: the model explains the readings of 13 poses."]
    );
    let outdated = ReportInput {
        outdated: true,
        diagnosis_outdated: true,
        ..input
    };
    let lead = leads(&outdated);
    assert!(lead[0].starts_with("The data or the model changed after this identification"));
    assert_eq!(lead.len(), 2);
    sample.diagnosis = diagnosed(&sample.fit.dataset, &[Verdict::Named]);
    let outdated = ReportInput {
        diagnosis_outdated: true,
        ..sample.input()
    };
    let html = render_report(&outdated, ReportFormat::Html).expect("HTML");
    let html = String::from_utf8_lossy(&html).into_owned();
    assert!(html.contains("It found the following, which the model does not have"));
}

/// A session that is opened again has no results in memory, but knows that it was diagnosed.
#[test]
fn a_report_after_opening_again_has_what_was_found_before() {
    let mut sample = sample(&[]);
    let (fit, diagnosis) = completed(&sample.session, (None, None));
    assert!(fit.is_some() && diagnosis.is_none(), "nobody has asked");
    let document = sample.diagnosis.document();
    let record = record(&sample.session, "Diagnosis", &document, time(5));
    sample.session.add_result(record);
    let (fit, diagnosis) = completed(&sample.session, (None, None));
    let (fit, diagnosis) = (fit.expect("a fit"), diagnosis.expect("a diagnosis"));
    let input = ReportInput {
        fit: Some(&fit),
        diagnosis: Some(&diagnosis),
        ..sample.input()
    };
    let bytes = render_report(&input, ReportFormat::Html).expect("HTML");
    let html = String::from_utf8(bytes).expect("text");
    assert!(html.contains("Model diagnosis") && !html.contains("was not diagnosed"));
    // Of other data nothing was asked.
    sample.session.exclude(7).expect("a measured pose");
    assert!(completed(&sample.session, (None, None)).1.is_none());
}

#[test]
fn a_session_without_measurements_has_a_report() {
    let robot = dataset().robot;
    let session = Session::new("Empty", robot, time(0));
    let input = ReportInput {
        session: &session,
        fit: None,
        diagnosis: None,
        outdated: false,
        diagnosis_outdated: false,
        picture: None,
        next_calibration: None,
        monte_carlo: None,
        choice: &ReportChoice::default(),
        now: time(1),
    };
    let html = render_report(&input, ReportFormat::Html).expect("HTML");
    assert!(String::from_utf8_lossy(&html).contains("No pose has been measured yet"));
    assert!(render_report(&input, ReportFormat::Pdf).is_ok());
}

#[test]
fn the_name_of_the_file_says_the_format() {
    let folder = tempfile::tempdir().expect("a folder");
    let sample = sample(&[]);
    for (name, start) in [("a.HTML", "<!DOCTYPE html>"), ("a.pdf", "%PDF-")] {
        let path = folder.path().join(name);
        write_report(&path, &sample.input()).expect("a report");
        let bytes = std::fs::read(&path).expect("a file");
        assert!(bytes.starts_with(start.as_bytes()));
    }
    let error = write_report(&folder.path().join("a.doc"), &sample.input()).expect_err("no format");
    assert!(
        error
            .to_string()
            .ends_with("expected a name that ends with .html, .pdf or .xml"),
        "{error}"
    );
}
