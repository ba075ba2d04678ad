//! A few kills at random moments over OPC UA; `validation -- kills` makes more.

use tautline_validation::support::ads::Protocol;
use tautline_validation::tables::kills::study;

/// Runs of each kind that are killed.
const RUNS: usize = 2;

fn killed_runs_lose_nothing_and_are_settled(protocol: Protocol) {
    let kills = study(protocol, RUNS, 48_000).expect("runs that are not killed");
    assert_eq!(kills.faults, [""; 0]);
    println!(
        "{} measuring runs were killed amid the poses; adjustments amid the writing: {:?}; of {} pairs both, one, none wrote: {:?}",
        kills.amid_poses, kills.amid_values, kills.pairs, kills.written
    );
}

super::over_all! {
    killed_runs_lose_nothing_and_are_settled,
}
