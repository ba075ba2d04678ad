//! Models of WireX: `.wcrfx`.
//!
//! `<models><robot motionpattern><geometry><chain>`: each chain has a `<base x y z a11 .. a33 radius>` and a
//! `<platform x y z>`. A pulley touches its swivel axis, the third column of the rotation `a`, at the base point, and the
//! cable arrives there along the axis: entry point and swivel axis as ours. A chain without a rotation swivels about z, one
//! without a radius has 0.1 m. Lengths are in metres.
//! Source: A. Pott, WireX (WireLib: `CRobotData::getXmlNode`, `CKinematics::fncPulley`), XML versions 0.31 and 0.32.

use Coordinate::{Rz, X, Y, Z};
use tautline_core::geometry::{Coordinate, Vec3};
use tautline_core::robot::{Platform, Robot};
use tautline_files::{ReadError, quoted};
use tautline_session::Loaded;

use super::description::{Description, Guide, cable_of, filled, robot_of};
use super::dialect::{Dialect, ForeignRobot, Setting};
use super::settings::Settings;
use super::xml::{self, Element};

pub(super) static DIALECT: Dialect = Dialect {
    name: "wirex",
    has_winches: false,
    is_in: |text| xml::has_tag(text, "<models"),
    read,
    new_text,
    bodies: None,
};

const NEW: [&str; 3] = [
    "<models version=\"0.32\">\n  <robot motionpattern=\"{pattern}\">\n    <geometry>\n",
    "      <chain id=\"{number}\">\n        <base x=\"{entry.x}\" y=\"{entry.y}\" z=\"{entry.z}\" a11=\"{across.x}\" a21=\"{across.y}\" a31=\"{across.z}\" a12=\"{beside.x}\" a22=\"{beside.y}\" a32=\"{beside.z}\" a13=\"{swivel.x}\" a23=\"{swivel.y}\" a33=\"{swivel.z}\" radius=\"{radius}\" />\n        <platform x=\"{anchor.x}\" y=\"{anchor.y}\" z=\"{anchor.z}\" a11=\"1\" a21=\"0\" a31=\"0\" a12=\"0\" a22=\"1\" a32=\"0\" a13=\"0\" a23=\"0\" a33=\"1\" />\n      </chain>\n",
    "    </geometry>\n    <platform name=\"{robot}\" mass=\"{mass}\">\n      <centerofgravity x=\"{center.x}\" y=\"{center.y}\" z=\"{center.z}\" />\n    </platform>\n  </robot>\n</models>\n",
];

/// Motion patterns with the coordinates of the platform. A platform that moves in any other way gets the first one in a new text.
const PATTERNS: [(&str, &[Coordinate]); 5] = [
    ("3R3T", &Coordinate::ALL),
    ("1R2T", &[X, Y, Rz]),
    ("3T", &[X, Y, Z]),
    ("2T", &[X, Y]),
    ("1T", &[X]),
];

/// Default pulley radius of WireX (m).
const RADIUS_M: f64 = 0.1;

/// Default platform of WireX: mass (kg), centre of mass (m).
const DEFAULT_PLATFORM: (f64, [f64; 3]) = (25.0, [0.0, 1.0, 0.2]);

/// Maximum deviation of the length of a swivel axis from 1, due to rounding to four digits.
const AXIS_TOLERANCE: f64 = 1e-3;

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let models = xml::parse(text, file)?;
    let read = robot(file, &models)?;
    let mut settings = Settings::new(file, text);
    let geometry = models.child("robot").and_then(|one| one.child("geometry"));
    let chains = geometry.into_iter().flat_map(|one| one.of_kind("chain"));
    for (chain, cable) in chains.zip(&read.value.cables) {
        let rows: [fn(usize) -> Setting; 2] = [Setting::entry, Setting::anchor];
        for (end, row) in ["base", "platform"].into_iter().zip(rows) {
            let key = format!("{} {end}", cable.name);
            for (axis, name) in ["x", "y", "z"].iter().enumerate() {
                let at = chain.child(end).and_then(|end| end.place(name));
                let value = at.and_then(|at| text.get(at)).unwrap_or_default();
                settings.push(format!("{key}.{axis}"), value);
            }
            settings.numbers::<3>(&key, &cable.name, row)?;
        }
    }
    Ok(ForeignRobot::new(read, settings.parameters))
}

fn new_text(robot: &Robot) -> String {
    let free = robot.platform.freedom();
    let is_it = |(_, all): &&(&str, &[Coordinate])| *all == free.coordinates();
    let (pattern, _) = PATTERNS.iter().find(is_it).unwrap_or(&PATTERNS[0]);
    filled(NEW, " ", robot).replace("{pattern}", pattern)
}

fn robot(file: &str, models: &Element) -> Result<Loaded<Robot>, ReadError> {
    let mut notices = Vec::new();
    let robots: Vec<&Element> = models.of_kind("robot").collect();
    let [model, others @ ..] = &robots[..] else {
        return Err(models.error(file, "found no <robot>, expected a robot of WireX"));
    };
    if let Some(other) = others.first() {
        notices.push(format!(
            "{file}, line {}: describes {} robots; the first is used",
            other.line,
            robots.len()
        ));
    }
    let geometry = model
        .child("geometry")
        .ok_or_else(|| model.error(file, "found no <geometry>, expected the cables"))?;
    let platform = platform(file, model, &mut notices)?;
    let (mut cables, mut radii) = (Vec::new(), Vec::new());
    for chain in geometry.of_kind("chain") {
        let end = |name: &str| {
            chain
                .child(name)
                .ok_or_else(|| chain.error(file, &format!("found no <{name}>, expected a point")))
        };
        let (base, anchor) = (end("base")?, end("platform")?);
        let guide = Guide {
            entry_point_m: point(file, base)?,
            swivel_axis: swivel_axis(file, base, &mut notices)?,
            radius_m: base.number(file, "radius")?.unwrap_or_else(|| {
                notices.push(format!(
                    "{file}, line {}: states no radius; {RADIUS_M} m is used, the default of WireX",
                    base.line
                ));
                RADIUS_M
            }),
        };
        radii.push(guide.radius_m);
        cables.push(cable_of(
            None,
            cables.len() + 1,
            guide,
            point(file, anchor)?,
        ));
    }
    if radii.iter().any(|radius| *radius > 0.0) {
        notices.push(format!(
            "{file}: does not state whether WireX models pulleys; they are modelled with the radius in the file: set radius_m to 0 in robot.json if the cables leave from fixed points"
        ));
    }
    let description = Description {
        platform,
        cables,
        home: None,
        limits: None,
        has_winches: false,
    };
    robot_of(file, description, notices)
}

fn point(file: &str, element: &Element) -> Result<[f64; 3], ReadError> {
    let point = element.vector(file, ["x", "y", "z"])?;
    point.ok_or_else(|| element.error(file, "found no x, y, z, expected a point"))
}

/// The third column of the rotation of the pulley.
fn swivel_axis(
    file: &str,
    base: &Element,
    notices: &mut Vec<String>,
) -> Result<[f64; 3], ReadError> {
    let Some(axis) = base.vector(file, ["a13", "a23", "a33"])? else {
        notices.push(format!(
            "{file}, line {}: states no rotation; the pulley is assumed to swivel about z",
            base.line
        ));
        return Ok([0.0, 0.0, 1.0]);
    };
    let axis = Vec3::from(axis);
    let norm = axis.norm();
    if (norm - 1.0).abs() > AXIS_TOLERANCE {
        let message =
            format!("found a13, a23, a33 of length {norm:.4}, expected a column of a rotation");
        return Err(base.error(file, &message));
    }
    Ok((axis / norm).into())
}

fn platform(file: &str, model: &Element, notices: &mut Vec<String>) -> Result<Platform, ReadError> {
    let pattern = model.attribute("motionpattern").unwrap_or(PATTERNS[0].0);
    let known = PATTERNS.iter().find(|(name, _)| *name == pattern);
    let (_, free) = known.ok_or_else(|| {
        let found = format!("found the motion pattern {}", quoted(pattern));
        model.error(file, &format!("{found}, expected 1T, 2T, 3T, 1R2T or 3R3T"))
    })?;
    let element = model.child("platform");
    let mass_kg = element
        .map(|element| element.number(file, "mass"))
        .transpose()?
        .flatten();
    let center_of_mass_m = element
        .and_then(|element| element.child("centerofgravity"))
        .map(|place| point(file, place))
        .transpose()?;
    let untold =
        (mass_kg, center_of_mass_m) == (Some(DEFAULT_PLATFORM.0), Some(DEFAULT_PLATFORM.1));
    if untold {
        notices.push(format!(
            "{file}: the platform of 25 kg is the default of WireX and is left out"
        ));
    } else if let Some(inertia) = element.and_then(|element| element.child("inertiatensor")) {
        notices.push(format!(
            "{file}, line {}: inertia left out: the file does not state about which point",
            inertia.line
        ));
    }
    Ok(Platform {
        free: free.to_vec(),
        mass_kg: mass_kg.filter(|mass| !untold && *mass > 0.0),
        center_of_mass_m: center_of_mass_m.filter(|_| !untold).unwrap_or_default(),
        inertia_kg_m2: None,
        wrench_sd: None,
    })
}
