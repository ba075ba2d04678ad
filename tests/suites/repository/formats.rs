//! The robot.json that the page of file formats shows can be used as it is.

use tautline_core::estimation::{Control, Options, Problem, solve};
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_session::parse_robot;

const PAGE: &str = include_str!("../../../docs/FORMATS.md");

#[test]
fn the_robot_of_the_page_is_identified() {
    let (_, after) = PAGE.split_once("```json\n").expect("a robot");
    let (robot, _) = after.split_once("```").expect("its end");
    let robot = parse_robot(robot.as_bytes(), "FORMATS.md").expect("a robot.json");
    assert!(robot.notices.is_empty(), "{:?}", robot.notices);
    let simulated = simulate(&robot.value, &SimulationOptions::new(25, 1)).expect("measurements");
    let problem = Problem::new(&simulated.dataset).expect("a problem");
    let solution =
        solve(&problem, &Options::default(), &mut |_| Control::Continue).expect("a solution");
    assert!(solution.converged());
    assert!(
        solution.p_value().is_some_and(|p| p > 1e-4),
        "{}",
        solution.chi2
    );
}
