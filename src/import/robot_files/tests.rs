use tautline_core::geometry::Coordinate;

use super::*;

fn read(name: &str, text: &str) -> Result<Loaded<Robot>, ReadError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("written");
    read_robot_description(&[path])
}

fn robot(name: &str, text: &str) -> (Robot, String) {
    let read = read(name, text).expect("a robot");
    (read.value, read.notices.join("\n"))
}

#[test]
fn a_sheet_in_english_is_a_spatial_robot_with_its_winches() {
    let text = "Cable,Pulley x [mm],Pulley y [mm],Pulley z [mm],Platform x [mm],Platform y [mm],Platform z [mm],Pulley radius [mm],Drum diameter [mm],Gear ratio\n\
                front,1000,2000,3000,10,20,30,25,160,4\nback,-1000,-2000,-500,-10,-20,-30,25,160,4\n";
    let (robot, notices) = robot("hall.csv", text);
    assert_eq!(robot.name, "hall");
    assert_eq!(robot.platform.free, Coordinate::ALL);
    let [front, back] = &robot.cables[..] else {
        panic!("two cables")
    };
    assert_eq!((front.name.as_str(), back.name.as_str()), ("front", "back"));
    assert_eq!(front.pulley.entry_point_m, [1.0, 2.0, 3.0]);
    assert_eq!(back.platform_anchor_m, [-0.01, -0.02, -0.03]);
    assert_eq!(
        (front.pulley.radius_m, front.winch.gear_ratio),
        (0.025, 4.0)
    );
    assert_eq!(front.winch.drum_diameter_m, 0.16);
    let home = robot.home.expect("a home");
    assert_eq!(home.position_m, [0.0, 0.0, 1.25]);
    assert!(home.position_sd_m > 0.2, "{home:?}");
    assert!(
        notices.contains("about the middle of the frame"),
        "{notices}"
    );
}

#[test]
fn a_german_sheet_without_a_third_coordinate_is_planar() {
    let text = "Seil;Rolle x / mm;Rolle y / mm;Plattform x / mm;Plattform y / mm\n\
                1;0,0;0,0;-50,5;-40\n2;3000;0;50,5;-40\n3;3000;2000;50,5;40\n4;0;2000;-50,5;40\n";
    let (robot, _) = robot("wand.csv", text);
    let free = [Coordinate::X, Coordinate::Y, Coordinate::Rz];
    assert_eq!(robot.platform.free, free);
    assert_eq!(robot.cables[0].platform_anchor_m, [-0.0505, -0.04, 0.0]);
    assert_eq!(robot.cables[2].pulley.entry_point_m, [3.0, 2.0, 0.0]);
    assert_eq!(robot.cables[2].pulley.entry_point_sd_m.each()[2], Some(0.0));
    assert_eq!(robot.home.expect("a home").position_m, [1.5, 1.0, 0.0]);
}

#[test]
fn pulleys_alone_move_a_point_and_large_numbers_are_millimetres() {
    let (robot, notices) = robot(
        "p.csv",
        "pulley,x,y,z\na,0,0,5000\nb,9000,0,5000\nc,0,7000,5000\n",
    );
    let free = [Coordinate::X, Coordinate::Y, Coordinate::Z];
    assert_eq!(robot.platform.free, free);
    assert_eq!(robot.cables[1].pulley.entry_point_m, [9.0, 0.0, 5.0]);
    assert!(notices.contains("columns without a unit are taken as millimetres"));
}

#[test]
fn a_radius_is_half_a_diameter_in_whatever_unit() {
    for [unit, heading] in [["", ""], [" [mm]", " [mm]"], [" [cm]", " [mm]"]] {
        let value = if unit == " [cm]" { 8 } else { 80 };
        let text = format!(
            "cable,x{heading},y{heading},z{heading},Drum radius{unit},Pulley diameter{unit}\n\
             1,0,0,5000,{value},{value}\n2,9000,0,5000,{value},{value}\n"
        );
        let cable = &robot("p.csv", &text).0.cables[0];
        let found = (cable.winch.drum_diameter_m, cable.pulley.radius_m);
        assert_eq!(found, (0.16, 0.04), "{unit}");
    }
}

/// Readings that look like places.
#[test]
fn accelerations_points_frames_and_poses_are_no_places() {
    for text in [
        "pose,rev_1,rev_2,base_x,base_y,base_z\n1,5,6,1,2,3\n2,6,7,2,3,4\n",
        "t,a_x,a_y,a_z\n0,1,2,3\n1,2,3,4\n2,3,4,5\n",
        "Name,X,Y,Z\nP1,1,2,3\nP2,2,3,4\nP3,3,4,5\n",
        "Frame,X,Y,Z\n1,1,2,3\n2,2,3,4\n3,3,4,5\n",
        "cable,x,y,z\n1,1,2,3\n1,2,3,4\n2,3,4,5\n",
    ] {
        assert!(read("x.csv", text).is_err(), "{text}");
    }
}
