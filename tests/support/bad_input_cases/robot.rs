//! Mistakes in robot.json.

use super::Mistake::{File, Folder, NoDataset, NoFile, PlainFile, Remove, RobotText, Set};
use super::{BadInput, case};

pub(super) fn cases() -> Vec<BadInput> {
    let mut cases = files_and_syntax();
    cases.extend(versions());
    cases.extend(types());
    cases.extend(values());
    cases.extend(directions_and_materials());
    cases.extend(layout());
    cases.extend(home_platform_and_effects());
    cases.extend(tolerances());
    cases
}

fn files_and_syntax() -> Vec<BadInput> {
    vec![
        case(
            "no folder",
            NoDataset,
            &["not found, expected a", "dataset folder"],
        ),
        case(
            "a file as dataset",
            PlainFile,
            &["is a file, expected a dataset folder"],
        ),
        case(
            "no robot.json",
            NoFile("robot.json"),
            &["robot.json: not found"],
        ),
        case(
            "robot.json a folder",
            Folder("robot.json"),
            &["robot.json: is a folder"],
        ),
        case(
            "empty robot.json",
            File("robot.json", b""),
            &["robot.json: found an empty file"],
        ),
        case(
            "truncated JSON",
            RobotText(|text| text[..text.len() / 2].into()),
            &["robot.json, line ", "column ", "cut off"],
        ),
        case(
            "a comma too many",
            File("robot.json", b"{\"name\": \"x\",\n \"cables\": [,]}"),
            &["robot.json, line 2, column 13", "not valid JSON"],
        ),
        case(
            "robot.json a list",
            File("robot.json", b"[1]"),
            &["found an array of 1", "object"],
        ),
        case(
            "robot.json not UTF-8",
            File("robot.json", b"{\n\"name\": \"\xff\"}"),
            &["robot.json, line 2", "byte 0xff", "UTF-8"],
        ),
        case(
            "a repeated key",
            RobotText(|text| text.replacen("\"name\"", "\"name\": \"x\", \"name\"", 1)),
            &["robot.json, line 2, column ", "the key \"name\" again"],
        ),
        case(
            "a number that is none",
            RobotText(|text| text.replacen("0.018", "NaN", 1)),
            &["robot.json, line ", "not valid JSON"],
        ),
        case(
            "a number out of range",
            RobotText(|text| text.replacen("0.018", "1e999", 1)),
            &["robot.json, line ", "out of range"],
        ),
        case(
            "endless nesting",
            RobotText(|_| "[".repeat(100_000)),
            &["robot.json, line 1", "recursion limit"],
        ),
    ]
}

fn versions() -> Vec<BadInput> {
    vec![
        case(
            "wrong format",
            Set("/format", "\"tautline-session\""),
            &["robot.json, /format: found \"tautline-session\", expected \"tautline-robot\""],
        ),
        case(
            "no format",
            Remove("/format"),
            &["robot.json, /format: not given"],
        ),
        case(
            "newer version",
            Set("/version", "2"),
            &["robot.json, /version: found version 2 of \"tautline-robot\", which is newer"],
        ),
        case(
            "version zero",
            Set("/version", "0"),
            &["/version: found 0, expected"],
        ),
        case(
            "version a text",
            Set("/version", "\"1\""),
            &["/version: found \"1\""],
        ),
    ]
}

fn types() -> Vec<BadInput> {
    vec![
        case(
            "a text for a number",
            Set("/cables/1/pulley/radius_m", "\"abc\""),
            &["robot.json, /cables/1/pulley/radius_m: found \"abc\", expected a number"],
        ),
        case(
            "two coordinates",
            Set("/cables/1/pulley/entry_point_m", "[1, 2]"),
            &[
                "/cables/1/pulley/entry_point_m",
                "found an array of 2, expected an array of 3",
            ],
        ),
        case(
            "null for a number",
            Set("/cables/0/winch/drum_diameter_m", "null"),
            &["/cables/0/winch/drum_diameter_m: found null, expected a number"],
        ),
        case(
            "no anchor",
            Remove("/cables/2/platform_anchor_m"),
            &["robot.json, /cables/2: has no key \"platform_anchor_m\""],
        ),
        case(
            "an unknown coordinate",
            Set("/platform/free/0", "\"q\""),
            &["/platform/free/0: found \"q\", expected one of \"x\""],
        ),
        case(
            "sd a text",
            Set("/cables/0/pulley/entry_point_sd_m", "\"8 mm\""),
            &["/cables/0/pulley/entry_point_sd_m: found \"8 mm\", expected a number or three"],
        ),
        case(
            "cables an object",
            Set("/cables", "{}"),
            &["/cables: found an object"],
        ),
    ]
}

fn values() -> Vec<BadInput> {
    vec![
        case(
            "no cables",
            Set("/cables", "[]"),
            &["/cables: found 0 cables"],
        ),
        case(
            "empty name",
            Set("/name", "\" \""),
            &["/name: found an empty text"],
        ),
        case(
            "repeated name",
            Set("/cables/2/name", "\"cable-1\""),
            &["/cables/2/name", "\"cable-1\"", "again"],
        ),
        case(
            "zero drum",
            Set("/cables/0/winch/drum_diameter_m", "0"),
            &["robot.json, /cables/0/winch/drum_diameter_m: found 0, expected a number greater"],
        ),
        case(
            "negative pitch",
            Set("/cables/0/winch/drum_pitch_m", "-0.002"),
            &["/cables/0/winch/drum_pitch_m: found -0.002"],
        ),
        case(
            "negative gear ratio",
            Set("/cables/3/winch/gear_ratio", "-1"),
            &["/cables/3/winch/gear_ratio: found -1"],
        ),
        case(
            "negative sd",
            Set("/cables/3/winch/length_sd_m", "-1e-5"),
            &["/cables/3/winch/length_sd_m: found -0.00001"],
        ),
        case(
            "one of three sds negative",
            Set("/cables/1/pulley/entry_point_sd_m", "[0,0,-1]"),
            &["/cables/1/pulley/entry_point_sd_m: found -1"],
        ),
        case(
            "laser sd zero",
            Set("/laser/sd_m", "0"),
            &["/laser/sd_m: found 0"],
        ),
        case(
            "home sd negative",
            Set("/home/position_sd_m", "-1"),
            &["/home/position_sd_m"],
        ),
        case(
            "negative radius",
            Set("/cables/0/pulley/radius_m", "-0.01"),
            &["/cables/0/pulley/radius_m: found -0.01"],
        ),
        case(
            "radius in millimetres",
            Set("/cables/0/pulley/radius_m", "18"),
            &["/cables/0/pulley/radius_m: found 18 m", "millimetres"],
        ),
        case(
            "drum in millimetres",
            Set("/cables/0/winch/drum_diameter_m", "40"),
            &["/cables/0/winch/drum_diameter_m", "millimetres"],
        ),
    ]
}

fn directions_and_materials() -> Vec<BadInput> {
    vec![
        case(
            "non-unit axis",
            Set("/cables/2/pulley/swivel_axis", "[0, 0, -1.1]"),
            &[
                "robot.json, /cables/2/pulley/swivel_axis: found the norm 1.1, expected a unit vector",
            ],
        ),
        case(
            "swivel zero along the axis",
            Set("/cables/2/pulley/swivel_zero", "[0, 0, 1]"),
            &["/cables/2/pulley/swivel_zero", "parallel to swivel_axis"],
        ),
        case(
            "laser direction zero",
            Set("/laser/direction", "[0, 0, 0]"),
            &["/laser/direction: found the norm 0"],
        ),
        case(
            "quaternion of norm 2",
            Set("/home/orientation_wxyz", "[2, 0, 0, 0]"),
            &["/home/orientation_wxyz: found the norm 2"],
        ),
        case(
            "quaternion zero",
            Set("/home/orientation_wxyz", "[0, 0, 0, 0]"),
            &["/home/orientation_wxyz: found the norm 0"],
        ),
        case(
            "nothing is free",
            Set("/platform/free", "[]"),
            &["/platform/free: found no"],
        ),
        case(
            "free twice",
            Set("/platform/free", "[\"x\", \"y\", \"x\"]"),
            &["/platform/free/2: found translation along x again"],
        ),
        case(
            "mass zero",
            Set("/platform/mass_kg", "0"),
            &["/platform/mass_kg: found 0"],
        ),
        case(
            "stiffness zero",
            Set("/cables/0/cable/axial_stiffness_n", "0"),
            &["/cables/0/cable/axial_stiffness_n: found 0"],
        ),
        case(
            "gain zero",
            Set("/cables/0/force_sensor/tension_gain", "0"),
            &["/cables/0/force_sensor/tension_gain: found 0"],
        ),
        case(
            "gravity in mm/s^2",
            Set("/gravity_m_s2", "[0, 0, -9806.65]"),
            &["/gravity_m_s2"],
        ),
        case(
            "too few coefficients",
            Set(
                "/cables/0/cable/elongation_surface",
                r#"{"degree": 2, "length_center_m": 1, "length_scale_m": 1, "tension_center_n": 1,
                "tension_scale_n": 1, "coefficients": [1, 2, 3, 4, 5], "residual_sd_m": 0}"#,
            ),
            &["elongation_surface: degree 2 has 6 coefficients, 5 are given"],
        ),
        case(
            "surface of degree 9",
            Set(
                "/cables/0/cable/elongation_surface",
                r#"{"degree": 9, "length_center_m": 1, "length_scale_m": 1, "tension_center_n": 1,
                "tension_scale_n": 1, "coefficients": [], "residual_sd_m": 0}"#,
            ),
            &["elongation_surface: the degree is 9"],
        ),
    ]
}

fn layout() -> Vec<BadInput> {
    vec![
        case(
            "two pulleys in one place",
            Set("/cables/2/pulley/entry_point_m", "[-0.5, -0.378, 0.45]"),
            &[
                "robot.json, /cables/2/pulley/entry_point_m",
                "cable-1",
                "two pulleys in one place",
            ],
        ),
        case(
            "pulleys 20 mm apart",
            Set("/cables/2/pulley/entry_point_m", "[-0.49, -0.361, 0.45]"),
            &[
                "/cables/2/pulley/entry_point_m: found 19.7 mm",
                "two pulleys in one place",
            ],
        ),
        case(
            "entry points in millimetres",
            Set("/cables/2/pulley/entry_point_m", "[500, 378, 450]"),
            &["/pulley/entry_point_m", "millimetres"],
        ),
        case(
            "anchor in millimetres",
            Set("/cables/1/platform_anchor_m", "[60, -45, 50]"),
            &["/cables/1/platform_anchor_m", "fits into the frame"],
        ),
        case(
            "home in millimetres",
            Set("/home/position_m", "[0, 0, 100]"),
            &["/home/position_m", "millimetres"],
        ),
        case(
            "anchor inside a pulley",
            Set("/cables/1/platform_anchor_m", "[0.52, -0.378, 0.445]"),
            &[
                "/cables/1/platform_anchor_m: found that the platform anchor of cable-2 is inside its pulley",
            ],
        ),
        case(
            "anchor on the swivel axis",
            Set("/cables/1/platform_anchor_m", "[0.5, -0.378, 0.05]"),
            &[
                "/cables/1/platform_anchor_m",
                "on the swivel axis of its pulley",
            ],
        ),
    ]
}

const HOME_PLATFORM_WITH_FIVE: &str = r#"{"base_from_reference":
    {"position_m": [0, 0, 0], "orientation_wxyz": [1, 0, 0, 0]}, "planes": [],
    "sensors": [{"origin_m": [0, 0, 0], "direction": [0, 0, 1], "plane": 0, "sd_m": 1e-4}]}"#;

fn tolerances() -> Vec<BadInput> {
    vec![
        case(
            "tolerances of another word",
            Set("/tolerances", r#""usual""#),
            &["robot.json, /tolerances: found \"usual\", expected \"typical\" or an object"],
        ),
        case(
            "tolerance of a misspelt effect",
            Set("/tolerances", r#"{"winch_scales": 2e-4}"#),
            &[
                "robot.json, /tolerances/winch_scales: found no effect of this name",
                "such as \"winch_scale\"",
            ],
        ),
        case(
            "tolerance of an event",
            Set("/tolerances", r#"{"cable_slip": 1e-3}"#),
            &["/tolerances/cable_slip: found an effect that sound parts do not have"],
        ),
        case(
            "negative tolerance",
            Set("/tolerances", r#"{"winch_scale": -2e-4}"#),
            &["/tolerances/winch_scale: found -0.0002, expected 0 or a greater number"],
        ),
        case(
            "tolerance a text",
            Set("/tolerances", r#"{"winch_scale": "0.02 %"}"#),
            &["/tolerances"],
        ),
        case(
            "tolerance of a cable that is not there",
            Set("/tolerances", r#"{"winch_scale": {"cable-9": 2e-4}}"#),
            &[
                "/tolerances/winch_scale: found \"cable-9\", expected the name of a cable or \"default\"",
            ],
        ),
        case(
            "tolerance of the platform by cable",
            Set("/tolerances", r#"{"payload_mass": {"cable-1": 0.01}}"#),
            &["/tolerances/payload_mass: found an object, expected one number"],
        ),
        case(
            "negative factor of the tolerances",
            Set("/tolerances", r#"{"factor": -1, "winch_scale": 2e-4}"#),
            &["/tolerances/factor: found -1, expected 0 or a greater number"],
        ),
        case(
            "deviation of a part that is not there",
            Set(
                "/deviations",
                r#"[{"effect": "winch_scale", "targets": ["cable-9"]}]"#,
            ),
            &["/deviations/0/targets/0: found \"cable-9\", expected the name of a cable"],
        ),
    ]
}

fn home_platform_and_effects() -> Vec<BadInput> {
    vec![
        case(
            "one home sensor",
            Set("/home_platform", HOME_PLATFORM_WITH_FIVE),
            &["/home_platform/sensors: found 1, expected 6"],
        ),
        case(
            "unknown effect target",
            Set(
                "/effects",
                r#"[{"effect": "winch_scale", "targets": ["cable-9"]}]"#,
            ),
            &["robot.json, /effects/0/targets/0: found \"cable-9\", expected the name of a cable"],
        ),
        case(
            "repeated effect target",
            Set(
                "/effects",
                r#"[{"effect": "cable_swap", "targets": ["cable-1", "cable-1"]}]"#,
            ),
            &["/effects/0/targets/1", "again"],
        ),
        case(
            "unknown effect",
            Set("/effects", r#"[{"effect": "winch_scales"}]"#),
            &["robot.json, /effects/0: unknown effect \"winch_scales\""],
        ),
        case(
            "unknown effect parameter",
            Set(
                "/effects",
                r#"[{"effect": "winch_scale", "parameters": {"factor": 0.01}}]"#,
            ),
            &["/effects/0: effect \"winch_scale\" has no parameter \"factor\"; it has scale"],
        ),
        case(
            "effect parameter a text",
            Set(
                "/effects",
                r#"[{"effect": "winch_scale", "parameters": {"scale": "1 %"}}]"#,
            ),
            &["/effects/0/parameters/scale: found \"1 %\", expected a number"],
        ),
    ]
}
