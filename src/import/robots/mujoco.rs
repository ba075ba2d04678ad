//! Cable robots in MJCF, the XML of MuJoCo.
//!
//! A cable is a spatial tendon. It ends at a site of the platform, the moving body in which most tendons end, and comes from a fixed
//! site, an eyelet, or over a pulley: a body with a hinge and a cylinder that touches its axis; the anchor of the hinge is the
//! entry point. Before the pulley there is a site on the axis, from which the cable arrives. Lengths are in metres, angles in degrees
//! unless the compiler says otherwise.
//! Source: MuJoCo, XML reference and the chapter on modeling.

use tautline_core::geometry::{Coordinate, Pose, Vec3};
use tautline_core::robot::{Cable, Platform, Robot};
use tautline_files::{ReadError, quoted};

use super::description::{Guide, cable_of, escaped, in_frame, inertia_of, list, simulated};
use super::dialect::{Dialect, ForeignRobot, Setting};
use super::settings::Settings;
use super::xml::{self, Element};

pub(super) static DIALECT: Dialect = Dialect {
    name: "mjcf",
    has_winches: false,
    is_in: |text| xml::has_tag(text, "<mujoco"),
    read,
    new_text,
    bodies: None,
};

/// Largest distance of a pulley's cylinder from touching its axis (m).
const TOUCH_M: f64 = 1e-6;
/// Shortest way of a cable to its pulley in a new model (m): a site at the entry point itself would be inside the cylinder.
const LEAST_RUN_M: f64 = 0.01;

/// A body, site or geom with the number of its body and its pose in the base frame (m).
struct Placed<'x> {
    element: &'x Element,
    body: usize,
    pose: Pose,
}

/// Bodies, sites and geoms of a model.
struct Model<'x> {
    file: &'x str,
    is_degrees: bool,
    bodies: Vec<Placed<'x>>,
    sites_and_geoms: Vec<Placed<'x>>,
}

impl<'x> Model<'x> {
    fn add(&mut self, element: &'x Element, pose: Pose) -> Result<(), ReadError> {
        let body = self.bodies.len();
        self.bodies.push(Placed {
            element,
            body,
            pose,
        });
        for element in &element.children {
            let name = element.name.as_str();
            if !["body", "site", "geom"].contains(&name) {
                continue;
            }
            let local = self.local_pose(element)?;
            let pose = in_frame(&pose, &local);
            match name {
                "body" => self.add(element, pose)?,
                _ => self.sites_and_geoms.push(Placed {
                    element,
                    body,
                    pose,
                }),
            }
        }
        Ok(())
    }

    /// The pose of an element in that of its parent; of a geom between two points, their middle.
    fn local_pose(&self, element: &Element) -> Result<Pose, ReadError> {
        let list = |name: &str, count: usize| element.list(self.file, name, count);
        let middle = list("fromto", 6)?.map(|v| [0, 1, 2].map(|k| (v[k] + v[k + 3]) / 2.0));
        let position = list("pos", 3)?
            .map(|v| [v[0], v[1], v[2]])
            .or(middle)
            .unwrap_or_default();
        if let Some(q) = list("quat", 4)? {
            return Ok(Pose::from_parts(position, [q[0], q[1], q[2], q[3]]));
        }
        let turn = if self.is_degrees {
            1_f64.to_radians()
        } else {
            1.0
        };
        let angles = list("euler", 3)?.map_or([0.0; 3], |v| [v[0], v[1], v[2]].map(|a| turn * a));
        let mut others = ["axisangle", "xyaxes", "zaxis"].into_iter();
        match others.find(|name| element.attribute(name).is_some() && element.name != "geom") {
            Some(other) => {
                let message = format!("found {other}, expected quat or euler");
                Err(element.error(self.file, &message))
            }
            None => Ok(Pose::from_angles(position, angles)),
        }
    }

    /// Whether a body moves relative to its parent: by a joint, or as a mocap body.
    fn moves(&self, body: usize) -> bool {
        let element = self.bodies[body].element;
        let has_joint = ["joint", "freejoint"]
            .iter()
            .any(|name| element.child(name).is_some());
        has_joint || element.attribute("mocap") == Some("true")
    }

    /// The site or geom that an element of a tendon refers to.
    fn referred(&self, part: &Element) -> Result<&Placed<'x>, ReadError> {
        let (tag, name) = (part.name.as_str(), part.attribute(&part.name));
        let is_it =
            |one: &&Placed<'_>| one.element.name == tag && one.element.attribute("name") == name;
        let found = self.sites_and_geoms.iter().find(is_it);
        found.filter(|_| name.is_some()).ok_or_else(|| {
            let name = quoted(name.unwrap_or_default());
            let message = format!("found no {tag} {name}, expected one in a body of this file");
            part.error(self.file, &message)
        })
    }

    /// Numbers of the bodies in which a tendon ends.
    fn ends_of(&self, tendon: &Element) -> Result<Vec<usize>, ReadError> {
        let ends = [tendon.children.first(), tendon.children.last()];
        let ends = ends.into_iter().flatten();
        ends.map(|end| Ok(self.referred(end)?.body)).collect()
    }
}

fn read(file: &str, text: &str) -> Result<ForeignRobot, ReadError> {
    let root = xml::parse(text, file)?;
    let child = |name: &str| root.child(name);
    let setting = |name: &str| child("compiler").and_then(|compiler| compiler.attribute(name));
    if let Some(sequence) = setting("eulerseq").filter(|sequence| *sequence != "xyz") {
        let message = format!("found eulerseq {}, expected xyz", quoted(sequence));
        return Err(root.error(file, &message));
    }
    let mut model = Model {
        file,
        is_degrees: setting("angle") != Some("radian"),
        bodies: Vec::new(),
        sites_and_geoms: Vec::new(),
    };
    let world = child("worldbody");
    let world = world.ok_or_else(|| root.error(file, "found no <worldbody>, expected bodies"))?;
    model.add(world, Pose::identity())?;
    let groups = root.of_kind("tendon");
    let tendons = groups.flat_map(|group| group.of_kind("spatial"));
    let tendons: Vec<&Element> = tendons.collect();
    let platform = platform_body(&model, &root, &tendons)?;
    let mut settings = Settings::new(file, text);
    let (mut cables, mut left_out) = (Vec::new(), Vec::new());
    for tendon in tendons {
        match model
            .ends_of(tendon)?
            .iter()
            .filter(|end| **end == platform)
            .count()
        {
            1 => cables.push(cable(
                &model,
                platform,
                tendon,
                &mut settings,
                cables.len(),
            )?),
            _ => left_out.push(tendon.attribute("name").unwrap_or("a tendon")),
        }
    }
    let others = ["default", "include", "equality", "actuator", "sensor"];
    left_out.extend(others.into_iter().filter(|name| child(name).is_some()));
    let body = &model.bodies[platform];
    let notices = vec![format!(
        "{file}: left out: {}; mass and centre of mass are those of <inertial>, inertia if it is in the axes of the platform",
        left_out.join(", ")
    )];
    let platform = platform_of(file, body.element)?;
    let mut read = simulated(platform, cables, &body.pose, notices, settings)?;
    let gravity = child("option")
        .map(|option| option.list(file, "gravity", 3))
        .transpose()?;
    if let Some(g) = gravity.flatten() {
        read.robot.gravity_m_s2 = [g[0], g[1], g[2]];
    }
    Ok(read)
}

/// Number of the moving body in which most tendons end.
fn platform_body(
    model: &Model<'_>,
    root: &Element,
    tendons: &[&Element],
) -> Result<usize, ReadError> {
    let mut ends = vec![0_usize; model.bodies.len()];
    for tendon in tendons {
        for body in model.ends_of(tendon)? {
            ends[body] += usize::from(model.moves(body));
        }
    }
    let most = (0..ends.len()).max_by_key(|body| ends[*body]);
    most.filter(|body| ends[*body] > 0).ok_or_else(|| {
        let message = "found no moving body in which spatial tendons end, expected a platform";
        root.error(model.file, message)
    })
}

/// The cable of a tendon; the position from which it enters the workspace becomes parameters.
fn cable(
    model: &Model<'_>,
    platform: usize,
    tendon: &Element,
    settings: &mut Settings<'_>,
    index: usize,
) -> Result<Cable, ReadError> {
    let name = tendon
        .attribute("name")
        .map_or_else(|| format!("cable-{}", index + 1), str::to_owned);
    let parts = tendon.children.iter().map(|part| model.referred(part));
    let mut parts: Vec<&Placed<'_>> = parts.collect::<Result<_, _>>()?;
    if parts.first().is_some_and(|first| first.body == platform) {
        parts.reverse();
    }
    let fail = |message: &str| Err(tendon.error(model.file, message));
    let [before @ .., from, end] = &parts[..] else {
        return fail("found fewer than two sites, expected the ends of a cable");
    };
    let (guide, moved, run_m) = match (from.element.name.as_str(), before.last()) {
        ("site", _) if model.moves(from.body) => {
            return fail("found a site on a moving body, expected a fixed one or a pulley");
        }
        ("site", _) => (Guide::eyelet(from.pose.position.into()), *from, 0.0),
        (_, None) => return fail("found a pulley without a site before it"),
        (_, Some(before)) => {
            let guide = pulley(model, from, &before.pose.position)?;
            let run_m = (Vec3::from(guide.entry_point_m) - before.pose.position).norm();
            (guide, &model.bodies[from.body], run_m)
        }
    };
    let rows: [fn(usize) -> Setting; 2] = [Setting::entry, Setting::anchor];
    for (Placed { element, .. }, row) in [moved, end].into_iter().zip(rows) {
        if let (Some(place), Some(at)) = (element.attribute("name"), element.place("pos")) {
            let key = format!("{} {place} pos", element.name);
            settings.point(&key, at, &name, row)?;
        }
    }
    let home = model.bodies[platform].pose;
    let anchor_m = home.orientation.inverse() * (end.pose.position - home.position);
    let length_m = run_m + (end.pose.position - Vec3::from(guide.entry_point_m)).norm();
    let mut cable = cable_of(Some(name), index, guide, anchor_m.into());
    cable.winch.length_to_pulley_m = run_m;
    let stiffness = tendon.number(model.file, "stiffness")?.filter(|k| *k > 0.0);
    cable.cable.axial_stiffness_n = stiffness.map(|k| k * length_m);
    Ok(cable)
}

/// The pulley of a geom on which the cable arrives from a point (m).
fn pulley(model: &Model<'_>, geom: &Placed<'_>, from: &Vec3) -> Result<Guide, ReadError> {
    let body = &model.bodies[geom.body];
    let fail = |message: &str| geom.element.error(model.file, message);
    let hinge = body.element.child("joint");
    let hinge =
        hinge.ok_or_else(|| fail("found no hinge of its body, expected a swivel pulley"))?;
    let vector = |name: &str, default: Vec3| {
        let values = hinge.list(model.file, name, 3)?;
        Ok::<_, ReadError>(values.map_or(default, |v| Vec3::new(v[0], v[1], v[2])))
    };
    let entry = body.pose.transform(&vector("pos", Vec3::zeros())?);
    let axis = (body.pose.orientation * vector("axis", Vec3::z())?).normalize();
    let size = geom.element.attribute("size").unwrap_or_default();
    let radius = size
        .split_whitespace()
        .next()
        .and_then(|first| first.parse().ok());
    let radius_m: f64 = radius.ok_or_else(|| fail("found no size, expected a radius"))?;
    let offset = geom.pose.position - entry;
    let distance_m = (offset - axis * offset.dot(&axis)).norm();
    if (distance_m - radius_m).abs() > TOUCH_M {
        return Err(fail(
            "found a cylinder beside the axis of its hinge, expected one that touches it",
        ));
    }
    let along = if (entry - from).dot(&axis) < 0.0 {
        -axis
    } else {
        axis
    };
    Ok(Guide {
        entry_point_m: entry.into(),
        swivel_axis: along.into(),
        radius_m,
    })
}

/// The freedom of a body with its mass.
fn platform_of(file: &str, body: &Element) -> Result<Platform, ReadError> {
    let mut platform = Platform::spatial(None);
    let joints = body.of_kind("joint");
    let joints = joints.filter(|one| one.attribute("type") != Some("free"));
    let free = joints.map(|joint| {
        let axis = joint.list(file, "axis", 3)?.unwrap_or(vec![0.0, 0.0, 1.0]);
        let along = (0..3).find(|k| axis[*k].abs() == 1.0);
        match (joint.attribute("type"), along) {
            (Some("slide"), Some(k)) => Ok(Coordinate::ALL[k]),
            (None | Some("hinge"), Some(k)) => Ok(Coordinate::ALL[k + 3]),
            _ => Err(joint.error(
                file,
                "expected a slide or hinge along x, y or z, or a free joint",
            )),
        }
    });
    let free: Vec<Coordinate> = free.collect::<Result<_, _>>()?;
    if !free.is_empty() {
        platform.free = free;
    }
    if let Some(inertial) = body.child("inertial") {
        platform.mass_kg = inertial.number(file, "mass")?;
        let center = inertial.list(file, "pos", 3)?;
        platform.center_of_mass_m = center.map_or([0.0; 3], |v| [v[0], v[1], v[2]]);
        let diagonal = inertial.list(file, "diaginertia", 3)?;
        let diagonal = diagonal.map(|d| vec![d[0], d[1], d[2], 0.0, 0.0, 0.0]);
        let inertia = inertial.list(file, "fullinertia", 6)?.or(diagonal);
        let is_turned = ["quat", "euler"]
            .iter()
            .any(|name| inertial.attribute(name).is_some());
        platform.inertia_kg_m2 = inertia
            .filter(|_| !is_turned)
            .and_then(|all| all.try_into().ok());
    }
    Ok(platform)
}

/// A model whose tendons wrap round the pulleys of a robot. Winches are position actuators that hold the unstrained length with the
/// stiffness at home, or motors if the cables are inelastic.
fn new_text(robot: &Robot) -> String {
    let list = |values: &[f64]| list(values, " ");
    let home = robot.home.map_or(Pose::identity(), |home| home.pose());
    let platform = &robot.platform;
    let mass_kg = platform.mass_kg.unwrap_or(1.0);
    let (mut sites, mut fixed, mut tendons, mut winches) = Default::default();
    for (n, cable) in (1..).zip(&robot.cables) {
        add_cable(
            n,
            cable,
            &home,
            [&mut sites, &mut fixed, &mut tendons, &mut winches],
        );
    }
    let (gravity, position) = (list(&robot.gravity_m_s2), list(home.position.as_slice()));
    let (quat, center) = (
        list(&home.orientation_wxyz()),
        list(&platform.center_of_mass_m),
    );
    let inertia = list(&inertia_of(platform, mass_kg));
    let joints = joints(platform);
    format!(
        "<mujoco>\n  <compiler angle=\"radian\"/>\n  <option gravity=\"{gravity}\"/>\n  <worldbody>\n    <body name=\"platform\" pos=\"{position}\" quat=\"{quat}\">\n{joints}      <inertial pos=\"{center}\" mass=\"{mass_kg}\" fullinertia=\"{inertia}\"/>\n{sites}    </body>\n{fixed}  </worldbody>\n  <tendon>\n{tendons}  </tendon>\n  <actuator>\n{winches}  </actuator>\n</mujoco>\n"
    )
}

/// Adds a cable to the sites of the platform, the fixed elements, the tendons and the winches of a model.
fn add_cable(
    n: usize,
    cable: &Cable,
    home: &Pose,
    [sites, fixed, tendons, winches]: [&mut String; 4],
) {
    let list = |values: &[f64]| list(values, " ");
    let (entry, axis) = (
        Vec3::from(cable.pulley.entry_point_m),
        Vec3::from(cable.pulley.swivel_axis),
    );
    let toward = home.transform(&cable.platform_anchor_m.into()) - entry;
    let (radius, place) = (cable.pulley.radius_m, list(entry.as_slice()));
    *sites += &format!(
        "      <site name=\"platform_{n}\" pos=\"{}\"/>\n",
        list(&cable.platform_anchor_m)
    );
    let run_m = cable.winch.length_to_pulley_m.max(LEAST_RUN_M);
    let path = if radius > 0.0 {
        // The pulley faces the platform at home.
        let facing = (toward - axis * toward.dot(&axis)).normalize();
        let (wheel, across) = (facing * radius, axis.cross(&facing) * (0.2 * radius));
        let [low, high] = [wheel - across, wheel + across].map(|end| list(end.as_slice()));
        let (side, turn) = (
            list((wheel + axis * (1.5 * radius)).as_slice()),
            list(axis.as_slice()),
        );
        let drum = list((entry - axis * run_m).as_slice());
        *fixed += &format!(
            "    <body name=\"pulley_{n}\" pos=\"{place}\">\n      <joint name=\"swivel_{n}\" type=\"hinge\" axis=\"{turn}\" damping=\"1e-3\"/>\n      <inertial pos=\"0 0 0\" mass=\"0.01\" diaginertia=\"1e-5 1e-5 1e-5\"/>\n      <geom name=\"wheel_{n}\" type=\"cylinder\" size=\"{radius:.9}\" fromto=\"{low} {high}\" contype=\"0\" conaffinity=\"0\"/>\n      <site name=\"side_{n}\" pos=\"{side}\"/>\n    </body>\n    <site name=\"drum_{n}\" pos=\"{drum}\"/>\n"
        );
        format!("<site site=\"drum_{n}\"/><geom geom=\"wheel_{n}\" sidesite=\"side_{n}\"/>")
    } else {
        *fixed += &format!("    <site name=\"frame_{n}\" pos=\"{place}\"/>\n");
        format!("<site site=\"frame_{n}\"/>")
    };
    let name = escaped(&cable.name);
    *tendons +=
        &format!("    <spatial name=\"{name}\">{path}<site site=\"platform_{n}\"/></spatial>\n");
    let stiffness = cable.cable.axial_stiffness_n;
    *winches += &match stiffness.map(|stiffness_n| stiffness_n / (toward.norm() + run_m)) {
        Some(kp) => format!(
            "    <position name=\"winch_{n}\" tendon=\"{name}\" kp=\"{kp:.3}\" forcelimited=\"true\" forcerange=\"-1e6 0\"/>\n"
        ),
        None => format!("    <motor name=\"winch_{n}\" tendon=\"{name}\" gear=\"-1\"/>\n"),
    };
}

/// Joints of the platform for the coordinates in which it moves.
fn joints(platform: &Platform) -> String {
    if platform.free.len() == Coordinate::ALL.len() {
        return "      <freejoint/>\n".to_owned();
    }
    let joint = |coordinate: &Coordinate| {
        let k = coordinate.index();
        let kind = if k < 3 { "slide" } else { "hinge" };
        let axis = ["1 0 0", "0 1 0", "0 0 1"][k % 3];
        format!("      <joint type=\"{kind}\" axis=\"{axis}\"/>\n")
    };
    platform.free.iter().map(joint).collect()
}
