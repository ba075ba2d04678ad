//! Pose shown by the panel: the selected one, otherwise the home pose.

use tautline_core::geometry::Pose;

use crate::screens::bench_panel::Bench;

/// Pose with its tensions.
pub struct PanelPose {
    /// Name, such as "home".
    pub name: String,
    pub pose: Pose,
    /// Tensions (N), if measured at all cables.
    pub tensions_n: Option<Vec<f64>>,
}

/// Selected pose as identified, otherwise as commanded; the home pose if none is selected or its position is unknown.
pub fn shown(bench: &Bench<'_>) -> Option<PanelPose> {
    let measurements = &bench.session().measurements;
    let row = |label: i64| measurements.labels.iter().position(|l| *l == label);
    if let Some(label) = bench.selection.pose
        && let Some(row) = row(label)
        && let Some(pose) =
            identified(bench, label).or_else(|| measurements.commanded.get(row).copied().flatten())
    {
        return Some(PanelPose {
            name: format!("pose {label}"),
            pose,
            tensions_n: tensions(bench, row),
        });
    }
    let home = bench.robot().home.as_ref()?;
    Some(PanelPose {
        name: "home".to_owned(),
        pose: home.pose(),
        tensions_n: measurements.home_row().and_then(|row| tensions(bench, row)),
    })
}

fn identified(bench: &Bench<'_>, label: i64) -> Option<Pose> {
    let fit = bench.open.fit()?;
    let labels = &fit.dataset.measurements.labels;
    let poses = fit.solution.poses.iter();
    let found = poses.filter(|(row, _)| labels.get(*row) == Some(&label));
    found.map(|(_, pose)| *pose).next()
}

fn tensions(bench: &Bench<'_>, row: usize) -> Option<Vec<f64>> {
    let force = &bench.session().measurements.force_n;
    let cables = bench.robot().cables.iter().enumerate();
    let tensions = cables.map(|(k, cable)| {
        let reading = force.get(row, k);
        let tension = cable.force_sensor.as_ref()?.tension_n(reading);
        tension.is_finite().then_some(tension)
    });
    tensions.collect()
}
