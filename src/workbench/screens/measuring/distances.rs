//! Distances between measured poses, with a tape or on a board with marks.

use egui::{DragValue, Ui};
use tautline_session::{PhaseData, PoseDistance};

use crate::model::Model;
use crate::model::command::Outbox;
use crate::screens::bench_panel::Bench;
use crate::widgets::{Numbers, RowField, Rows, RowsEdit, UiExt};
use tautline_workflow::wording::units::mm;

const FIELDS: [RowField; 3] = [
    RowField::new("From pose", "", 0).accepting(is_label, "the number of a pose"),
    RowField::new("To pose", "", 0).accepting(is_label, "the number of a pose"),
    RowField::millimetres("Distance", 1).accepting(
        |value| value > 0.0 && value <= 1e3,
        "more than 0 and at most 1 km",
    ),
];

/// Input of further distances.
#[derive(Debug)]
pub struct DistancesInput {
    rows: String,
    /// Standard deviation of those to be added (mm).
    sd_mm: f64,
}

impl Default for DistancesInput {
    fn default() -> Self {
        Self {
            rows: String::new(),
            sd_mm: 1.0,
        }
    }
}

fn is_label(value: f64) -> bool {
    value >= 0.0 && value.fract() == 0.0 && value <= 1e9
}

/// Draws the distances and the fields for more, once there are poses to measure between.
pub fn show(ui: &mut Ui, model: &Model, input: &mut DistancesInput, outbox: &mut Outbox) {
    let Some(open) = model
        .open
        .as_ref()
        .filter(|open| open.session().measurements.len() > 1)
    else {
        return;
    };
    let mut bench = Bench {
        open,
        calibration: open.calibration(),
        selection: model.selection,
        outbox,
    };
    ui.section("Distances between poses");
    ui.muted("The distance between the centres of the platform at two poses, with a tape or on a board with marks, tells the \
         size of the machine. Type distances here, or drop a distances.csv.");
    ui.horizontal(|ui| {
        ui.muted("Standard deviation of the tape");
        let field = DragValue::new(&mut input.sd_mm)
            .range(0.01..=1000.0)
            .speed(0.05);
        ui.add(field.suffix(" mm"));
    });
    let distances = &open.session().phases.distances;
    let numbers: Vec<Numbers> = distances.iter().map(numbers).collect();
    let sds: Vec<String> = distances.iter().map(|one| mm(one.sd_m, 2)).collect();
    let editor = Rows {
        noun: "Distance",
        fields: &FIELDS,
        rows: &numbers,
        remarks: ("±", "mm"),
        remark: &sds,
    };
    let sd_m = input.sd_mm * 1e-3;
    let labels = &open.session().measurements.labels;
    let lost = distances
        .iter()
        .flat_map(|one| one.poses)
        .find(|label| !labels.contains(label));
    if let Some(label) = lost {
        ui.doubtful(&format!(
            "Pose {label} is not measured: its distances have no effect."
        ));
    }
    bench.edit_rows(ui, &editor, &mut input.rows, |phases, edit| {
        change(phases, edit, sd_m);
    });
}

fn numbers(one: &PoseDistance) -> Numbers {
    let [from, to] = one.poses.map(|label| Some(label as f64));
    [from, to, Some(one.distance_m)]
}

fn change(phases: &mut PhaseData, edit: RowsEdit, sd_m: f64) {
    let known = match edit {
        RowsEdit::Set(row, ..) => phases.distances.get(row).copied(),
        _ => None,
    };
    let distance = |[from, to, distance]: Numbers| {
        let poses = [from? as i64, to? as i64];
        (poses[0] != poses[1]).then_some(PoseDistance {
            poses,
            distance_m: distance?,
            sd_m: known.map_or(sd_m, |one| one.sd_m),
            point_m: known.map_or([0.0; 3], |one| one.point_m),
        })
    };
    edit.apply(&mut phases.distances, |_| true, numbers, distance);
}
