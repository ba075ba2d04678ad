//! Models of CASPR: `..._cables.xml` and `..._bodies.xml`.
//!
//! `<bodies_system>` holds `<links>`, which was the root of older files; each `<link_rigid>` is a body with the joint by which
//! it moves. A robot of ours is one platform on the base. `q_initial` is its home, `q_min` and `q_max` are its workspace.
//! A cable runs from link 0, the base, to link 1, the platform. At the base it leaves an `attachment`, a point, or a
//! `base_rotating_pulley`: `fixed_location` is the point that stays when the pulley swivels, our entry point,
//! `cable_entry_vector` the direction in which the cable reaches it, our swivel axis. A text in this dialect is the file of the
//! cables, as a calibration does not change the bodies.
//! Source: Lau et al., CASPR, 2016, and its classes `JointBase`, `BodyModelRigid`, `CableModelBase`,
//! `BaseRotatingPulleyAttachment`.

mod cable;
mod joint;

use nalgebra::Matrix3;
use tautline_core::geometry::Vec3;
use tautline_core::robot::{Limits, Platform, Robot};
use tautline_files::{ReadError, quoted};
use tautline_session::Loaded;

use super::description::{
    Description, POSITION_SD_M, ROTATION_SD_RAD, filled, home_at, know_normal_to_plane, robot_of,
};
use super::dialect::{Dialect, ForeignRobot};
use super::settings::Settings;
use super::xml::{self, Element};
use joint::Joint;

pub(super) static DIALECT: Dialect = Dialect {
    name: "caspr",
    has_winches: false,
    is_in: |text| xml::has_tag(text, "<cables"),
    read,
    new_text: cable::new_text,
    bodies: Some(|robot| joint::with_joint(&filled([BODIES, "", ""], " ", robot), robot)),
};

/// A new file of the bodies.
const BODIES: &str = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<bodies_system>\n  <links display_range=\"{range}\" view_angle=\"-37 32\">\n    <link_rigid num=\"1\" name=\"{robot}\">\n      <joint type=\"{joint}\" q_initial=\"{q}\"/>\n      <physical>\n        <mass>{mass}</mass>\n        <com_location>{center}</com_location>\n        <end_location>0 0 0</end_location>\n        <inertia ref=\"com\"><Ixx>{ixx}</Ixx><Iyy>{iyy}</Iyy><Izz>{izz}</Izz><Ixy>{ixy}</Ixy><Ixz>{ixz}</Ixz><Iyz>{iyz}</Iyz></inertia>\n      </physical>\n      <parent><num>0</num><location>{origin}</location></parent>\n    </link_rigid>\n  </links>\n</bodies_system>\n";

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let root = xml::parse(text, file)?;
    let read = robot(file, &root, None)?;
    let mut settings = Settings::new(file, text);
    let set = cable::cable_set(file, &root, &mut Vec::new())?;
    cable::add_points(set, &read.value.cables, &mut settings)?;
    Ok(ForeignRobot::new(read, settings.parameters))
}

pub(super) fn robot(
    file: &str,
    cables: &Element,
    bodies: Option<(&str, &Element)>,
) -> Result<Loaded<Robot>, ReadError> {
    let mut notices = Vec::new();
    let body = match bodies {
        Some((file, root)) => body(file, root, &mut notices)?,
        None => {
            notices.push(format!("{file}: without the file of the bodies the platform is assumed to have six degrees of freedom and no mass"));
            Body::unknown()
        }
    };
    let set = cable::cable_set(file, cables, &mut notices)?;
    let mut cables = cable::cables(file, set, &body.platform, &mut notices)?;
    know_normal_to_plane(&body.platform, &mut cables);
    let limits = Limits {
        workspace: body.joint.as_ref().and_then(Joint::workspace),
        tension: cable::tension_limits(file, set, &mut notices)?,
    };
    let home = body.joint.as_ref().and_then(Joint::home);
    let home = home.map(|home| home_at(&home.pose()));
    if home.is_some() {
        notices.push(format!(
            "{}: q_initial is the home pose, at which encoders read 0; it is assumed to be known to {} mm and {} mrad",
            bodies.map_or(file, |(file, _)| file),
            1e3 * POSITION_SD_M,
            1e3 * ROTATION_SD_RAD
        ));
    }
    let description = Description {
        platform: body.platform,
        cables,
        home,
        limits: (limits != Limits::default()).then_some(limits),
        has_winches: false,
    };
    robot_of(file, description, notices)
}

/// A platform, and the joint by which it moves, if described.
struct Body {
    platform: Platform,
    joint: Option<Joint>,
}

impl Body {
    fn unknown() -> Self {
        Self {
            platform: Platform::spatial(None),
            joint: None,
        }
    }
}

fn body(file: &str, root: &Element, notices: &mut Vec<String>) -> Result<Body, ReadError> {
    let links = match root.name.as_str() {
        "links" => root,
        _ => root
            .child("links")
            .ok_or_else(|| root.error(file, "found no <links>, expected the bodies"))?,
    };
    let bodies: Vec<&Element> = links.of_kind("link_rigid").collect();
    let link = match bodies[..] {
        [link] => link,
        [] => return Err(links.error(file, "found no <link_rigid>, expected the platform")),
        _ => {
            let names = bodies
                .iter()
                .map(|body| quoted(body.attribute("name").unwrap_or_default()));
            let message = format!(
                "found the bodies {}, expected one platform: robots of several bodies cannot be calibrated here",
                names.collect::<Vec<_>>().join(", ")
            );
            return Err(links.error(file, &message));
        }
    };
    let origin_m = link
        .child("parent")
        .and_then(|parent| parent.child("location"))
        .map(|place| place.numbers::<3>(file))
        .transpose()?
        .unwrap_or_default();
    let joint = link
        .child("joint")
        .ok_or_else(|| link.error(file, "found no joint, expected the joint of the platform"))?;
    let joint = Joint::of(file, joint, origin_m)?;
    let physical = link.child("physical");
    let of = |name: &str| physical.and_then(|physical| physical.child(name));
    let mass = of("mass").map(|mass| mass.numbers::<1>(file)).transpose()?;
    let mass_kg = mass.map(|[mass]| mass).filter(|mass| *mass > 0.0);
    let center_of_mass_m = of("com_location")
        .map(|place| place.numbers::<3>(file))
        .transpose()?
        .unwrap_or_default();
    let inertia_kg_m2 = match (of("inertia"), mass_kg) {
        (Some(element), Some(mass_kg)) => {
            inertia(file, element, mass_kg, center_of_mass_m, notices)?
        }
        _ => None,
    };
    Ok(Body {
        platform: Platform {
            free: joint.free(),
            mass_kg,
            center_of_mass_m,
            inertia_kg_m2,
            wrench_sd: None,
        },
        joint: Some(joint),
    })
}

/// Inertia about the centre of mass, `None` for that of a point or a plane figure. With `ref="joint"` the file states that about
/// the joint, which is the origin of the platform.
fn inertia(
    file: &str,
    element: &Element,
    mass_kg: f64,
    center_of_mass_m: [f64; 3],
    notices: &mut Vec<String>,
) -> Result<Option<[f64; 6]>, ReadError> {
    let mut values = [0.0; 6];
    for (value, name) in values
        .iter_mut()
        .zip(["Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"])
    {
        let stated = element.child(name).map(|stated| stated.numbers::<1>(file));
        *value = stated.transpose()?.map_or(0.0, |[value]| value);
    }
    let [xx, yy, zz, xy, xz, yz] = values;
    let mut matrix = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    if element.attribute("ref") == Some("joint") {
        let arm = Vec3::from(center_of_mass_m);
        matrix -= (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * mass_kg;
    }
    if matrix.cholesky().is_some() {
        let [xx, yy, zz] = [0, 1, 2].map(|k| matrix[(k, k)]);
        return Ok(Some([
            xx,
            yy,
            zz,
            matrix[(0, 1)],
            matrix[(0, 2)],
            matrix[(1, 2)],
        ]));
    }
    if values != [0.0; 6] {
        notices.push(format!(
            "{file}, line {}: the inertia is not that of a body: left out",
            element.line
        ));
    }
    Ok(None)
}
