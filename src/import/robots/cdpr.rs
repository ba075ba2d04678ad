//! Cable robots in the yaml from which `gen_cdpr.py` of oKermorgant/cdpr generates models of Gazebo.
//!
//! `points` has for each cable a point of the frame and one of the platform (m); `platform` has its pose, with angles about the fixed
//! axes x, y, z (rad), mass and inertia. The rest is for the generated model.
//! Source: oKermorgant/cdpr, `gen_cdpr.py` and `cdpr.cpp`.

use tautline_core::robot::{Platform, Robot};
use tautline_files::ReadError;

use super::description::{Guide, cable_of, filled, list, pose_of, simulated};
use super::dialect::{Dialect, ForeignRobot, M, Setting};
use super::settings::Settings;

pub(super) static DIALECT: Dialect = Dialect {
    name: "cdpr",
    has_winches: false,
    is_in: |text| Settings::of_yaml("", text).has("points.0.frame."),
    read,
    new_text,
    bodies: None,
};

const NEW: [&str; 3] = [
    "cable: {mass: 0.001, radius: 0.005}\nframe:\n  color: Grey\n  lower: [{lower}]\n  radius: 0.02\n  type: box\n  upper: [{upper}]\njoints:\n  actuated: {damping: 1, effort: 10000, min: 50, velocity: 10}\n  passive: {damping: 0.01, effort: 1000, velocity: 10}\nplatform:\n  color: Blue\n  inertia: [{ixx}, {iyy}, {izz}, {ixy}, {ixz}, {iyz}]\n  mass: {mass}\n  position:\n    rpy: [{turn}]\n    xyz: [{place}]\n  size: [0.2, 0.2, 0.2]\n  type: box\n  visual: box\npoints:\n",
    "- frame: [{entry}]\n  platform: [{anchor}]\n",
    "sim_cables: true\n",
];

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let mut settings = Settings::of_yaml(file, text);
    let mut cables = Vec::new();
    while settings.has(&format!("points.{}.", cables.len())) {
        let number = cables.len() + 1;
        let (name, key) = (format!("cable-{number}"), format!("points.{}", number - 1));
        let entry = settings.numbers(&format!("{key}.frame"), &name, Setting::entry)?;
        let anchor = settings.numbers(&format!("{key}.platform"), &name, Setting::anchor)?;
        cables.push(cable_of(None, number, Guide::eyelet(entry), anchor));
    }
    let kept = |_| Setting::kept("", M, 0.0);
    let place = settings.numbers("platform.position.xyz", "", kept)?;
    let turn = settings.numbers("platform.position.rpy", "", kept)?;
    let inertia: [f64; 6] = settings.numbers("platform.inertia", "", kept)?;
    let mass_kg = settings.get(&Setting::kept("platform.mass", M, 0.0), (0, ""))?;
    let mut platform = Platform::spatial(Some(mass_kg).filter(|mass| *mass > 0.0));
    platform.inertia_kg_m2 = Some(inertia).filter(|inertia| inertia[0] > 0.0);
    simulated(
        platform,
        cables,
        &pose_of(place, turn),
        Vec::new(),
        settings,
    )
}

/// The frame encloses all points: its diagonal is the greatest length of a cable.
fn new_text(robot: &Robot) -> String {
    let ends = |pick: fn(f64, f64) -> f64| {
        let points = robot.cables.iter().map(|cable| cable.pulley.entry_point_m);
        let corner = points.reduce(|a, b| [0, 1, 2].map(|k| pick(a[k], b[k])));
        list(&corner.unwrap_or_default(), ", ")
    };
    let text = filled(NEW, ", ", robot);
    text.replace("{lower}", &ends(f64::min))
        .replace("{upper}", &ends(f64::max))
}
