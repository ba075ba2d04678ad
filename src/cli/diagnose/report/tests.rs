use tautline_core::diagnosis::Verdict;

use super::*;
use tautline_workflow::diagnosis::samples::{dataset, diagnosed};

fn report(verdicts: &[Verdict], explain: bool) -> String {
    let dataset = dataset();
    text(&diagnosed(&dataset, verdicts), explain)
}

/// Asserts that the text has all these parts, in this order.
fn assert_parts(text: &str, parts: &[&str]) {
    let mut rest = text;
    for part in parts {
        let Some((_, after)) = rest.split_once(part) else {
            panic!("no {part:?} at its place in\n{text}");
        };
        rest = after;
    }
}

#[test]
fn clean_data_need_no_finding() {
    let text = report(&[], false);
    let first = text.lines().next();
    assert_eq!(
        first,
        Some("planar: the model explains the readings of 13 poses.")
    );
    assert!(!text.contains("1. "), "{text}");
    assert!(!text.contains("Unexplained"), "{text}");
}

#[test]
fn poses_that_are_not_used_are_counted() {
    let mut of_many = diagnosed(&dataset(), &[]);
    of_many.measured = 10_001;
    let text = text(&of_many, false);
    let first = "planar: the model explains the readings of 13 of 10001 poses.\n";
    assert!(text.starts_with(first), "{text}");
}

#[test]
fn a_named_finding_is_clear() {
    let text = report(&[Verdict::Named], false);
    let parts = [
        "planar: the model does NOT explain the readings of 13 poses. With the cause below it does.\n",
        "Its residuals are 1.60 times the expected noise; with a correct model they would be as large less than once in a million times.\n",
        "With the findings included, the residuals are 1.00 times the expected noise.\n",
        "\n1. Winch scale (cable-3), almost certainly (99.8 %)\n",
        "   Winch 3 pays out too much.\n",
        "   Size: 0.31 ± 0.04 %\n",
        "   Improvement: at 12 poses held out of the fit, residuals are 1.01 instead of 1.62 times the expected noise; the platform is 2.3 mm (1.9 to 2.7) from where the previous model puts it, at most 5.1 mm.\n",
        "   What to do: Measure the drum.\n",
        "\nThe laser's readings have 2.1 times the stated noise (1.8 to 2.5): correct laser.sd_m in robot.json.\n",
        "\nUnexplained: residuals of the length readings of cable-3 are 2.10 times the expected noise and depend on cable length.\n",
        "standard deviation",
    ];
    assert_parts(&text, &parts);
    assert!(!text.contains("chi-square"), "{text}");
}

#[test]
fn what_cannot_be_told_apart_is_said_with_poses_that_could() {
    let text = report(&[Verdict::Named, Verdict::Ambiguous], false);
    let parts = [
        "2. Pulley radius (cable-3), more likely than not (60 %)\n",
        "   These data cannot tell it from: Winch offset (cable-3) (40 %; 3 to 2 against it).\n",
        "   [############........]  60 %  Pulley radius (cable-3)\n",
        "   [########............]  40 %  Winch offset (cable-3)\n",
        "   What decides between them: Measure far from cable-3. ",
        "   Poses that would distinguish them:\n",
        "x mm",
        "1      250  -100     0   0.0   0.0   0.0\n",
    ];
    assert_parts(&text, &parts);
}

#[test]
fn structure_without_a_name_is_not_given_a_size() {
    let text = report(&[Verdict::Unknown], false);
    assert_parts(
        &text,
        &[
            "No cause of the catalogue explains them.",
            "\nWhat remains:\n   Winch 3",
        ],
    );
    assert!(!text.contains("1. "), "{text}");
    assert!(
        !text.contains("Size:") && !text.contains("Improvement"),
        "{text}"
    );
}

#[test]
fn a_probable_cause_without_alternatives_is_no_list() {
    let dataset = dataset();
    let mut diagnosed = diagnosed(&dataset, &[Verdict::Ambiguous]);
    let finding = &mut diagnosed.diagnosis.findings[0];
    finding.alternatives.clear();
    finding.separation = None;
    finding.probability = 0.93;
    let text = text(&diagnosed, false);
    let parts = [
        "1. Probably pulley radius (cable-3), 93 %\n",
        "   7 % for something that is not in the catalogue.\n",
        "   To be sure: ",
    ];
    assert_parts(&text, &parts);
    assert!(
        !text.contains("cannot tell") && !text.contains("[###"),
        "{text}"
    );
}

#[test]
fn the_invisible_is_condensed() {
    let text = report(&[], false);
    let parts = [
        "These poses cannot reveal",
        "   Tilted pulley (cable-1 and cable-2): 5.73 to 11.5 degrees (not detectable on 1 of 3)\n",
        "   Pulley friction (all cables): 0.2\n",
        "   Not detectable at any size: Cable creep",
    ];
    assert_parts(&text, &parts);
    let table = report(&[], true);
    assert_parts(&table, &["Tilted pulley (cable-2)", "tilt_2", "never"]);
}

#[test]
fn the_numbers_are_explained_on_demand() {
    let text = report(&[Verdict::Named], true);
    let parts = [
        "\nPossible, but not established: Build-up of layers on the drum (cable-2), 12 %.\n",
        "Finding 1: chi-square falls by 61.0 for 1 more parameters, p = 1.0e-13 corrected for 300 tests; ranking:",
        "Winch scale (cable-3)",
        "Pulley radius (cable-3)",
        "20.0",
        "held-out poses, rms over sd",
        "Tests of the original model: chi-square 256.0",
        "Tests of the extended model",
        "depends on",
        "cable length",
    ];
    assert_parts(&text, &parts);
}

/// A frame or a unit that is wrong looks like noise of hundreds of newtons.
#[test]
fn noise_beyond_any_sensor_is_no_reason_to_correct_the_description() {
    let dataset = dataset();
    let mut diagnosed = diagnosed(&dataset, &[Verdict::Named]);
    diagnosed.diagnosis.noise[0].ratio = 2016.0;
    let text = text(&diagnosed, false);
    assert!(
        text.contains("times the stated noise (1.8 to 2.5): no sensor is so much worse than its data sheet, so leave laser.sd_m as it is"),
        "{text}"
    );
    assert!(!text.contains("correct laser.sd_m"));
}
