//! The hidden-effect test on the command line.

use anyhow::{Context, Result, bail, ensure};
use tautline_validation::hidden::{
    Plan, Restriction, Study, clean, coverage, describe, draw_all, drawn_markdown, failures,
    markdown, outside, pairs, run_all, single,
};

const USAGE: &str = "what to hide: hidden single|pairs|clean|outside|all [N] [--draw] [--failures] [--robot NAME] \
                     [--effect ID] [--seed N]";

/// Data sets of the whole test: per effect and robot, per robot, in all, per effect and robot.
const SINGLE: usize = 6;
const PAIRS: usize = 12;
const CLEAN: usize = 900;
const OUTSIDE: usize = 3;

struct Arguments {
    kind: String,
    count: Option<usize>,
    /// Only draw, do not ask the doctor.
    draw: bool,
    failures: bool,
    restriction: Restriction,
}

/// Runs `hidden ...`.
///
/// # Errors
/// If the arguments are not understood.
pub fn command(arguments: &[String]) -> Result<()> {
    let arguments = parse(arguments)?;
    let plans = plans(&arguments)?;
    if arguments.draw {
        println!("{}", drawn_markdown(&draw_all(&plans)));
        return Ok(());
    }
    let study = run_all(&plans);
    println!("{}", markdown(&study));
    if arguments.restriction.seed.is_some() {
        study
            .outcomes
            .iter()
            .for_each(|o| println!("{}", describe(o)));
    }
    if arguments.failures {
        println!("{}\n{}", failures(&study), coverage(&study));
    }
    report_impossible(&study);
    Ok(())
}

/// The tables of the whole test.
///
/// # Errors
/// Never with these arguments.
pub fn tables() -> Result<String> {
    let study = run_all(&plans(&parse(&["all".to_owned()])?)?);
    report_impossible(&study);
    Ok(markdown(&study))
}

fn report_impossible(study: &Study) {
    for (plan, why) in &study.impossible {
        eprintln!("{plan:?}: {why}");
    }
}

fn parse(arguments: &[String]) -> Result<Arguments> {
    let mut parsed = Arguments {
        kind: arguments.first().context(USAGE)?.clone(),
        count: None,
        draw: false,
        failures: false,
        restriction: Restriction::default(),
    };
    let mut rest = arguments[1..].iter();
    while let Some(argument) = rest.next() {
        let mut value = || {
            rest.next()
                .with_context(|| format!("{argument} what? {USAGE}"))
        };
        match argument.as_str() {
            "--draw" => parsed.draw = true,
            "--failures" => parsed.failures = true,
            "--robot" => parsed.restriction.robot = Some(value()?.clone()),
            "--effect" => parsed.restriction.effect = Some(value()?.clone()),
            "--seed" => parsed.restriction.seed = Some(value()?.parse()?),
            number => parsed.count = Some(number.parse().context(USAGE)?),
        }
    }
    Ok(parsed)
}

fn plans(arguments: &Arguments) -> Result<Vec<Plan>> {
    let count = |default| arguments.count.unwrap_or(default);
    let only = &arguments.restriction;
    let plans = match arguments.kind.as_str() {
        "single" => single(count(SINGLE), only),
        "pairs" => pairs(count(PAIRS), only),
        "clean" => clean(count(CLEAN), only),
        "outside" => outside(count(OUTSIDE), only),
        "all" => {
            ensure!(arguments.count.is_none(), "all has its own numbers");
            let mut all = single(SINGLE, only);
            all.extend(pairs(PAIRS, only));
            all.extend(clean(CLEAN, only));
            all.extend(outside(OUTSIDE, only));
            all
        }
        _ => bail!(USAGE),
    };
    ensure!(!plans.is_empty(), "there is no such robot or effect");
    Ok(plans)
}
