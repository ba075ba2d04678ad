//! Geometry of the camera.

use super::*;

fn corners() -> Vec<Vec3> {
    let signs = [-1.0, 1.0];
    let mut corners = Vec::new();
    for x in signs {
        for y in signs {
            corners.extend(signs.map(|z| Vec3::new(2.0 * x, y, 0.5 * z + 1.0)));
        }
    }
    corners
}

fn camera(view: StandardView) -> Camera {
    Camera::new(Directions::identity(), view, &corners(), 1.6)
}

#[test]
fn everything_fits_and_fills_the_picture() {
    for view in StandardView::ALL {
        for aspect in [0.5, 1.6] {
            let camera = Camera::new(Directions::identity(), view, &corners(), aspect);
            let mut extent = 0.0_f64;
            for corner in corners() {
                let seen = camera.project(&corner, aspect).unwrap();
                extent = extent.max((seen.u - 0.5).abs()).max((seen.v - 0.5).abs());
            }
            assert!(extent <= 0.44 + 1e-9, "{view:?} {aspect}: {extent}");
            assert!(extent > 0.4, "{view:?} {aspect}: {extent}");
        }
    }
}

#[test]
fn a_line_of_sight_meets_the_point_it_was_made_from() {
    let mut camera = camera(StandardView::Isometric);
    camera.orbit(120.0, -30.0, None);
    for point in corners() {
        let seen = camera.project(&point, 1.6).unwrap();
        let ray = camera.ray(seen.u, seen.v, 1.6);
        let off = (point - ray.origin).cross(&ray.direction).norm();
        assert!(off < 1e-12, "{off}");
    }
}

#[test]
fn the_card_sees_what_the_pointer_sees() {
    for view in StandardView::ALL {
        let camera = camera(view);
        let viewport = three_d::Viewport::new_at_origo(1600, 1000);
        let card = camera.on_card(&Vec3::new(0.0, 0.0, 1.0), 3.0, viewport);
        for point in corners() {
            let [x, y, z] = point.map(|v| v as f32).into();
            let c = card.projection() * card.view() * three_d::vec4(x, y, z, 1.0);
            let seen = camera.project(&point, 1.6).unwrap();
            // Single precision of the graphics card: a thousandth of a pixel.
            assert!((f64::from(c.x / c.w) - (2.0 * seen.u - 1.0)).abs() < 1e-6);
            assert!((f64::from(c.y / c.w) - (1.0 - 2.0 * seen.v)).abs() < 1e-6);
            assert!((-1.0..=1.0).contains(&(c.z / c.w)), "{view:?}");
        }
    }
}

#[test]
fn zoom_keeps_what_is_under_the_pointer() {
    let at = (0.8, 0.3);
    for view in StandardView::ALL {
        for depth in [0.6, 1.0, 1.7] {
            let mut camera = camera(view);
            let ray = camera.ray(at.0, at.1, 1.6);
            let forward = camera.axes()[2];
            let middle = (camera.target - ray.origin).dot(&forward);
            let point = ray.origin + ray.direction * (depth * middle / ray.direction.dot(&forward));
            camera.zoom(3.0, at, 1.6, Some(point));
            let seen = camera.project(&point, 1.6).unwrap();
            let off = (seen.u - at.0).hypot(seen.v - at.1);
            assert!(off < 1e-12, "{view:?} {depth}: {off}");
        }
    }
}

#[test]
fn zoom_comes_close_to_what_is_seen_and_never_reaches_it() {
    let mut camera = camera(StandardView::Isometric);
    let (at, forward) = ((0.4, 0.6), camera.axes()[2]);
    let ray = camera.ray(at.0, at.1, 1.6);
    let point = ray.origin + ray.direction * 2.0;
    let mut before = 2.0;
    for step in 0..200 {
        camera.zoom(1.4, at, 1.6, Some(point));
        let away = (point - camera.eye()).norm();
        assert!(away <= before + 1e-12, "step {step}");
        before = away;
    }
    let everything = 4.0_f64;
    assert!(before > 0.0 && before < 0.01 * everything, "{before}");
    assert!((point - camera.eye()).dot(&forward) > 0.0, "it is in front");
}

#[test]
fn what_was_picked_stays_under_the_pointer_in_an_orbit() {
    let mut camera = camera(StandardView::Isometric);
    let pivot = corners()[6];
    let before = camera.project(&pivot, 1.6).unwrap();
    camera.orbit(160.0, -50.0, Some(pivot));
    let after = camera.project(&pivot, 1.6).unwrap();
    let off = (before.u - after.u).hypot(before.v - after.v);
    assert!(
        off < 1e-12 && (before.depth_m - after.depth_m).abs() < 1e-12,
        "{off}"
    );
    assert!((camera.eye() - camera.target).norm() > 0.0);
}

#[test]
fn views_along_an_axis_have_one_scale_and_an_orbit_brings_the_depth_back() {
    for view in StandardView::ALL {
        let mut camera = camera(view);
        let forward = camera.axes()[2];
        let off = |camera: &Camera| {
            let [near, far] = [-0.5, 0.5].map(|depth| {
                let point = camera.target + camera.axes()[0] * 0.3 + camera.axes()[2] * depth;
                camera.project(&point, 1.6).unwrap().u
            });
            (near - far).abs()
        };
        assert_eq!(
            off(&camera) < 1e-12,
            view != StandardView::Isometric,
            "{view:?}"
        );
        camera.orbit(10.0, -10.0, None);
        assert!(off(&camera) > 1e-3);
        assert!(camera.axes()[2].dot(&forward) < 1.0 - 1e-6);
    }
}

#[test]
fn the_eye_looks_along_a_direction() {
    for direction in [
        Vec3::new(0.3, 0.8, -0.5),
        Vec3::new(-0.9, -0.1, 0.2),
        Vec3::new(0.0, -2.0, 0.0),
    ] {
        let mut camera = camera(StandardView::Side);
        camera.look_along(&direction);
        let off = (camera.axes()[2] - direction.normalize()).norm();
        assert!(off < 1e-12, "{direction}: {off}");
    }
}

#[test]
fn a_flight_begins_here_ends_there_and_takes_the_shorter_way() {
    let from = camera(StandardView::Isometric);
    let mut to = from;
    to.orbit(700.0, 20.0, None);
    to.frame(&corners()[..2], 1.6);
    let flight = Flight::new(from, to, 5.0);
    assert_eq!(flight.at(5.0), (from, false));
    assert_eq!(flight.at(6.0), (to, true));
    // 700 points are 5.6 rad to the left: 0.68 rad to the right are shorter.
    let (middle, _) = flight.at(5.2);
    let turned = middle.axes()[0].angle(&from.axes()[0]);
    assert!((0.2..0.5).contains(&turned), "{turned}");
    assert!(middle.distance_m < from.distance_m && middle.distance_m > to.distance_m);
}

#[test]
fn pan_moves_the_middle_with_the_pointer() {
    let mut camera = camera(StandardView::Top);
    let middle = camera.target;
    camera.pan(0.25, 0.1);
    let seen = camera.project(&middle, 1.6).unwrap();
    assert!((seen.u - 0.5 - 0.25 / 1.6).abs() < 1e-12);
    assert!((seen.v - 0.6).abs() < 1e-12);
}

#[test]
fn standard_views_look_along_the_axes_and_up_is_against_gravity() {
    let base = directions(Vec3::new(0.0, 0.0, -9.8));
    assert_eq!(base, Directions::identity());
    assert_eq!(camera(StandardView::Front).axes()[2], Vec3::y());
    let top = camera(StandardView::Top).axes();
    assert!((top[2] + Vec3::z()).norm() < 1e-15 && (top[1] - Vec3::y()).norm() < 1e-15);
    let side = camera(StandardView::Side).axes();
    assert!((side[0] - Vec3::y()).norm() < 1e-15 && (side[2] + Vec3::x()).norm() < 1e-15);
    for axis in 0..3 {
        let frame = directions(Vec3::ith(axis, -9.8));
        assert_eq!(frame.column(2), Vec3::ith(axis, 1.0));
        assert!((frame.determinant() - 1.0).abs() < 1e-15);
    }
    let planar = directions(Vec3::new(0.0, -9.8, 0.0));
    assert_eq!(planar.column(0), Vec3::x());
    assert_eq!(planar.column(1), -Vec3::z());
}
