//! Ctrl-C and the request of the system to end, while values are written.

use std::process::Child;

use rustix::process::{Pid, Signal, kill_process};
use tautline_session::Outcome;
use tautline_validation::support::ads::Plant;
use tautline_validation::support::ads::unruly::{Action, RequestKind};
use tautline_validation::support::program::Folder;

use super::{RELEASE, controller, heard, held, last_outcome, measured, start, wait_until};

fn send(child: &Child, signal: Signal) {
    let pid = Pid::from_raw(child.id() as i32).expect("a process");
    kill_process(pid, signal).expect("it runs");
}

#[test]
fn values_are_finished_before_the_program_ends() {
    for signal in [Signal::INT, Signal::TERM] {
        let plant = Plant::unruly();
        let folder = Folder::new();
        let file = measured(&folder, "s.json");
        let controller = controller(&plant);
        let old = held(&plant);
        // Late enough for the signals, in time for the answer.
        plant.server.fault(RequestKind::Write, 1, Action::Late(600));
        let before = plant.server.values();
        let mut child = start(&["adjust", &file, "--controller", &controller, "--arm"]);
        wait_until(&mut child, || plant.server.values() >= before + 9);
        // Nor does an impatient operator end it.
        send(&child, signal);
        send(&child, signal);
        let answer = heard(child, |_, _| ()).succeeded();
        assert!(
            answer
                .stdout
                .contains("The command was interrupted. 31 values written and read back."),
            "{}",
            answer.stdout
        );
        assert_ne!(held(&plant), old);
        assert_eq!(last_outcome(&file), Outcome::Written);
    }
}

#[test]
fn two_interrupts_end_a_run_after_the_release_is_withdrawn() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = folder.join("run.json");
    let controller = controller(&plant);
    let robot = ["--robot", "mini", "--poses", "12", "--timeout", "20"];
    let measure = ["measure", &file, "--controller", &controller, "--arm"];
    let mut child = start(&[&measure[..], &robot].concat());
    wait_until(&mut child, || {
        plant.server.numbers("GVL_Tautline.moving") == [1.0]
    });
    // The second one comes while the program waits for an answer.
    plant.server.fault(RequestKind::Read, 1, Action::Late(400));
    send(&child, Signal::INT);
    std::thread::sleep(std::time::Duration::from_millis(100));
    send(&child, Signal::INT);
    heard(child, |_, _| ());
    assert_eq!(plant.server.numbers(RELEASE), [0.0]);
}

#[test]
fn nobody_waits_for_a_line_that_stays_down() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = measured(&folder, "s.json");
    let controller = controller(&plant);
    plant
        .server
        .fault(RequestKind::Write, 1, Action::DownAfterValues(3));
    let mut child = start(&["adjust", &file, "--controller", &controller, "--arm"]);
    wait_until(&mut child, || plant.server.count(RequestKind::Write) > 0);
    send(&child, Signal::TERM);
    let answer = heard(child, |_, _| ());
    assert_eq!(answer.code, Some(1), "{}", answer.stderr);
    for part in [
        "The command was interrupted.",
        "not known",
        "Do not move the robot",
    ] {
        assert!(answer.stderr.contains(part), "{}", answer.stderr);
    }
    assert!(matches!(last_outcome(&file), Outcome::Unsettled(_)));
}
