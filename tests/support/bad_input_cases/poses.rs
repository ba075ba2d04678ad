//! Mistakes in poses.csv.

use super::Mistake::{Cell, Drop, File, Folder, LongLine, NoFile, PosesText, Remove, Set};
use super::{BadInput, case};

pub(super) fn cases() -> Vec<BadInput> {
    let mut cases = files();
    cases.extend(header());
    cases.extend(cells());
    cases.extend(rows());
    cases.extend(units());
    cases
}

fn files() -> Vec<BadInput> {
    vec![
        case(
            "no poses.csv",
            NoFile("poses.csv"),
            &["poses.csv: not found"],
        ),
        case(
            "poses.csv a folder",
            Folder("poses.csv"),
            &["poses.csv", "is a folder"],
        ),
        case(
            "empty poses.csv",
            File("poses.csv", b""),
            &["poses.csv: found no line"],
        ),
        case(
            "only comments",
            File("poses.csv", b"# one\n# two\n"),
            &["poses.csv: found no line"],
        ),
        case(
            "header only",
            PosesText(|text| text.lines().take(2).collect::<Vec<_>>().join("\n")),
            &["poses.csv, line 2: found a header row only"],
        ),
        case(
            "100 MB line",
            LongLine,
            &["poses.csv, line 6", "more than 1 MB"],
        ),
        case(
            "not UTF-8",
            File("poses.csv", b"pose,rev_\xe4\n0,1\n"),
            &["poses.csv, line 1", "byte 0xe4", "UTF-8"],
        ),
        case(
            "a cell not UTF-8",
            File(
                "poses.csv",
                b"pose,rev_1,rev_2,rev_3,rev_4,note\n0,0,0,0,0,\xe4\n",
            ),
            &["poses.csv, line 2", "byte 0xe4", "UTF-8"],
        ),
        case(
            "UTF-16",
            File("poses.csv", b"\xff\xfep\0o\0s\0e\0"),
            &["line 1", "UTF-16"],
        ),
        case(
            "a quotation that never ends",
            PosesText(|text| text.replacen("\n1,", "\n\"1,", 1)),
            &["poses.csv, line 4", "never closed"],
        ),
    ]
}

fn header() -> Vec<BadInput> {
    vec![
        case(
            "no labels",
            Drop("pose"),
            &["poses.csv, line 2, column \"pose\": missing"],
        ),
        case(
            "missing column",
            Drop("rev_3"),
            &["poses.csv, line 2, column \"rev_3\": missing", "4 cables"],
        ),
        case(
            "missing force column",
            Drop("force_4_n"),
            &["line 2, column \"force_4_n\": missing"],
        ),
        case(
            "missing quaternion column",
            Drop("qy"),
            &["line 2, column \"qy\": missing"],
        ),
        case(
            "wrong count of cables",
            PosesText(|text| text.replacen("laser_m", "rev_5", 1)),
            &["poses.csv, line 2, column \"rev_5\": found cable 5, expected 1 to 4"],
        ),
        case(
            "cables counted from zero",
            PosesText(|text| text.replacen("laser_m", "rev_0", 1)),
            &["line 2, column \"rev_0\": found cable 0"],
        ),
        case(
            "repeated column",
            PosesText(|text| text.replacen("laser_m", "rev_2", 1)),
            &["poses.csv, line 2, column \"rev_2\"", "again"],
        ),
        case(
            "column without a name",
            PosesText(|text| text.replacen("laser_m", "", 1)),
            &["poses.csv, line 2", "no name"],
        ),
        case(
            "lengths beside revolutions",
            PosesText(|text| text.replace("force_", "length_").replace("_n,", "_m,")),
            &["line 2, column \"length_1_m\": found beside rev_1"],
        ),
        case(
            "neither lengths nor revolutions",
            PosesText(|text| text.replace("rev_", "turns_")),
            &["line 2, column \"rev_1\": missing", "length_1_m"],
        ),
        case(
            "revolutions without home",
            Set("/home", "null"),
            &["\"rev_1\"", "no home"],
        ),
        case(
            "revolutions without home key",
            Remove("/home"),
            &["\"rev_1\"", "no home"],
        ),
    ]
}

fn cells() -> Vec<BadInput> {
    vec![
        case(
            "text in a number",
            Cell(5, "rev_3", "abc"),
            &["poses.csv, line 5, column \"rev_3\": found \"abc\", expected a number"],
        ),
        case(
            "NaN",
            Cell(4, "laser_m", "NaN"),
            &["line 4, column \"laser_m\": found \"NaN\""],
        ),
        case(
            "infinite",
            Cell(4, "rev_1", "-inf"),
            &["line 4, column \"rev_1\": found \"-inf\""],
        ),
        case(
            "too large for a number",
            Cell(4, "rev_1", "1e999"),
            &["\"rev_1\"", "1.8e308"],
        ),
        case(
            "a unit in the cell",
            Cell(4, "laser_m", "0.4 m"),
            &["\"laser_m\": found \"0.4 m\""],
        ),
        case(
            "quoted decimal comma",
            PosesText(|t| t.replacen("0.375", "\"0,375\"", 1)),
            &[
                "line 4, column \"laser_m\": found \"0,375\"",
                "decimal point",
            ],
        ),
        case(
            "decimal comma",
            PosesText(|t| t.replacen("0.375", "0,375", 1)),
            &[
                "poses.csv, line 4: found 21 cells, expected 20",
                "decimal commas",
            ],
        ),
        case(
            "thousands separator",
            PosesText(|t| {
                let text = t.replace(',', ";").replace('.', ",");
                text.replacen("0,375", "1.000,375", 1)
            }),
            &[
                "line 4, column \"laser_m\": found \"1.000,375\"",
                "thousands",
            ],
        ),
        case(
            "a row cut short",
            PosesText(|t| t.replacen(",0.375", "", 1)),
            &["line 4: found 19 cells, expected 20"],
        ),
        case(
            "label a text",
            Cell(4, "pose", "one"),
            &["line 4, column \"pose\": found \"one\""],
        ),
        case(
            "label not whole",
            Cell(4, "pose", "1.5"),
            &["\"pose\": found \"1.5\""],
        ),
        case(
            "label missing",
            Cell(4, "pose", ""),
            &["\"pose\": found an empty cell"],
        ),
        case(
            "control characters",
            Cell(4, "rev_1", "a\u{1b}[31m\u{7}"),
            &["\\u{1b}"],
        ),
    ]
}

fn rows() -> Vec<BadInput> {
    vec![
        case(
            "duplicate pose",
            Cell(5, "pose", "1"),
            &[
                "poses.csv, line 5, column \"pose\": found 1 again",
                "(line 4)",
            ],
        ),
        case(
            "home row missing",
            Cell(3, "pose", "7"),
            &["poses.csv", "no row with pose 0", "home"],
        ),
        case(
            "part of a pose",
            Cell(4, "y_m", ""),
            &["line 4, column \"y_m\": found an empty cell"],
        ),
        case(
            "part of a quaternion",
            Cell(4, "qz", ""),
            &["line 4, column \"qz\": found an empty"],
        ),
        case(
            "quaternion of norm 2",
            Cell(4, "qw", "2"),
            &["line 4, column \"qw\"", "norm 2"],
        ),
        case(
            "zero quaternion",
            Cell(4, "qw", "0"),
            &["line 4, column \"qw\"", "norm 0"],
        ),
        case(
            "zero sd",
            Cell(5, "meas_sd_x_m", "0"),
            &["line 5, column \"meas_sd_x_m\": found 0"],
        ),
        case(
            "negative sd",
            Cell(5, "meas_sd_x_m", "-1"),
            &["\"meas_sd_x_m\": found -1"],
        ),
        case(
            "pose inside a pulley",
            PosesText(|text| text.replacen("1,0.05,0,-0.07", "1,-0.42,-0.333,0.4", 1)),
            &[
                "poses.csv, line 4, column \"x_m\"",
                "anchor of cable-1 is inside its pulley",
            ],
        ),
    ]
}

fn units() -> Vec<BadInput> {
    vec![
        case(
            "measured in millimetres",
            Cell(5, "meas_x_m", "105.2"),
            &[
                "poses.csv, line 5, column \"meas_x_m\": found 105.2 m",
                "millimetres",
            ],
        ),
        case(
            "commanded in millimetres",
            Cell(4, "z_m", "-100"),
            &["\"z_m\"", "millimetres"],
        ),
        case(
            "laser in millimetres",
            Cell(4, "laser_m", "375"),
            &["\"laser_m\"", "millimetres"],
        ),
        case(
            "laser negative",
            Cell(4, "laser_m", "-0.4"),
            &["\"laser_m\": found -0.4"],
        ),
        case(
            "degrees for revolutions",
            Cell(5, "rev_2", "360"),
            &["line 5, column \"rev_2\": found 360 revolutions", "degrees"],
        ),
        case(
            "lengths in millimetres",
            File(
                "poses.csv",
                b"pose,length_1_m,length_2_m,length_3_m,length_4_m\n0,1,1,900,1\n",
            ),
            &[
                "poses.csv, line 2, column \"length_3_m\": found 900 m",
                "millimetres",
            ],
        ),
        case(
            "a length of zero",
            File(
                "poses.csv",
                b"pose,length_1_m,length_2_m,length_3_m,length_4_m\n0,1,1,1,0\n",
            ),
            &["poses.csv, line 2, column \"length_4_m\": found 0"],
        ),
        case(
            "degrees for radians",
            PosesText(|text| text.replace("force_", "swivel_").replace("_n,", "_rad,")),
            &["line 3, column \"swivel_1_rad\": found 40 rad", "degrees"],
        ),
        case(
            "kelvin",
            PosesText(|text| {
                text.replacen("laser_m", "temperature_c", 1)
                    .replacen("0.375", "293", 1)
            }),
            &["line 4, column \"temperature_c\": found 293"],
        ),
    ]
}
