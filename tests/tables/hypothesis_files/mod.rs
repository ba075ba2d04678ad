//! Forms that no effect of the catalogue has, hidden in simulated readings: what the patterns of `formulas` and hypothesis files
//! beside the data find of them, and whether files that have nothing to do with the readings change anything.

mod file;
mod forms;
mod outcome;
mod table;

use anyhow::{Context, Result};
use rand::RngExt;
use tautline_core::diagnosis::{Cause, Verdict, is_confused, is_seen, log_odds};
use tautline_core::effect::{Effect, EffectRequest, EffectSetting, Hypothesis, MAX_HYPOTHESES};
use tautline_core::estimation::{Control, Problem};
use tautline_core::measurement::Dataset;
use tautline_core::robot::{PartTolerances, Robot};
use tautline_core::simulation::Simulated;
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::formulas::{PATTERN, Reading, find_formulas, formulas, unexplained};

use self::forms::{Form, OnRobot, Origin, forms, ten_files};
use super::formulas::place_of;
use super::hidden::{
    Circumstances, Claim, Conditions, Found, Hidden, NEGLIGIBLE, OUTSIDE_SIZES, Plan, Setup,
    Wanted, draw, held_out_ratio, judge, log_uniform, on_each_target, robot, single_effects,
    size_for,
};
use super::simulated::{asked, random_sign, solved, stream, timed};
use super::study::Study;
pub use outcome::{Case, Crowd, Machine, Outcome, Tried};
use table::markdown;

/// Seed of the first data set.
pub const FIRST_SEED: u64 = 47_000;
/// Robots, in turn: together they have every kind of reading.
const ROBOTS: [&str; 6] = [
    "hall",
    "suspended",
    "planar",
    "mini-inclined",
    "mini-tracked",
    "mini-swivels",
];
/// Data sets in which ten files are irrelevant.
const CROWDS: usize = 200;
/// Stream of the random numbers drawn here; others of the same seed use 0 to 5.
const STREAM: u64 = 21;

/// All data sets from a first seed on. Each of the six rounds has every form on another robot and a sixth of the data sets with
/// irrelevant files, so that an interrupted study is a table with wider intervals.
#[must_use]
pub fn cases(first_seed: u64) -> Vec<Case> {
    let forms: Vec<Form> = forms().collect();
    let mut cases = Vec::new();
    let mut crowds = 0..CROWDS;
    for round in 0..ROBOTS.len() {
        let of = |k: usize, form: Option<&Form>| Case {
            robot: ROBOTS[(round + k) % ROBOTS.len()].to_owned(),
            form: form.map(|form| form.id.to_owned()),
            machine: Machine::ALL[(round + k / ROBOTS.len() * usize::from(form.is_none())) % 2],
            seed: 0,
        };
        cases.extend(forms.iter().enumerate().map(|(k, form)| of(k, Some(form))));
        let crowds = crowds.by_ref().take(CROWDS.div_ceil(ROBOTS.len()));
        cases.extend(crowds.map(|k| of(k, None)));
    }
    for (case, seed) in cases.iter_mut().zip(first_seed..) {
        case.seed = seed;
    }
    cases
}

/// The first data sets of all from a seed on.
#[derive(Debug)]
pub struct HypothesisFiles {
    /// Largest number of data sets.
    pub first: usize,
    /// Seed of the first one.
    pub first_seed: u64,
}

impl Study for HypothesisFiles {
    type Case = Case;
    type Outcome = Outcome;

    fn cases(&self) -> Result<Vec<Case>> {
        let mut cases = cases(self.first_seed);
        cases.truncate(self.first);
        Ok(cases)
    }

    /// There is no outcome if the robot has nothing that the form changes. What cannot be simulated is told on standard error.
    fn run(&self, case: &Case) -> Result<Option<Outcome>> {
        Ok(run(case).unwrap_or_else(|error| {
            eprintln!("{case:?}: {error:#}");
            None
        }))
    }

    fn table(&self, outcomes: &[(Case, Outcome)]) -> Result<String> {
        let (some, all) = (self.cases()?.len(), cases(self.first_seed).len());
        Ok(format!(
            "The first {some} of {all} data sets.\n\n{}",
            markdown(outcomes)
        ))
    }
}

fn run(case: &Case) -> Result<Option<Outcome>> {
    let Some(id) = &case.form else {
        return crowd(case).map(|crowd| Some(Outcome::Crowd(crowd)));
    };
    let form = forms().find(|form| form.id == *id);
    let form = form.context("no such form")?;
    Ok(tried(case, &form)?.map(Outcome::Tried))
}

/// The robot of a case with exact parts.
fn setup(case: &Case) -> Result<Setup> {
    Ok(Setup {
        robot: robot(&case.robot).with_context(|| format!("no robot {}", case.robot))?,
        seed: case.seed,
        conditions: Conditions::default(),
    })
}

/// The readings of a machine with something hidden. Its description knows no hypothesis.
fn measured(case: &Case, exact: &Setup, hidden: &Hidden) -> Result<(Setup, Simulated, Dataset)> {
    let mut setup = exact.clone();
    if case.machine == Machine::WellKept {
        setup.robot.preset.robot.tolerances = Some(PartTolerances::typical());
    }
    let run = setup.measured(hidden)?;
    let mut dataset = run.dataset.clone();
    dataset.robot.hypotheses.clear();
    Ok((setup, run, dataset))
}

fn with_files(dataset: &Dataset, files: &[Hypothesis]) -> Result<Dataset> {
    let mut dataset = dataset.clone();
    for file in files {
        dataset.robot.add_hypothesis(file)?;
    }
    Ok(dataset)
}

/// What is named for sure.
fn names(diagnosed: &Diagnosed) -> Vec<String> {
    let claims = Claim::of(&diagnosed.diagnosis.findings);
    let named = claims
        .iter()
        .filter(|claim| claim.verdict == Verdict::Named);
    named.map(Claim::describe).collect()
}

/// A form hidden in one data set.
fn tried(case: &Case, form: &Form) -> Result<Option<Tried>> {
    let mut exact = setup(case)?;
    let Some(on) = form.on(&exact)? else {
        return Ok(None);
    };
    on.prepare(&mut exact)?;
    let mut rng = stream(case.seed, STREAM);
    let sign = random_sign(&mut rng);
    let phase = rng.random_range(0.0..std::f64::consts::TAU);
    let hidden = |size: f64| on.hidden(sign * size, phase);
    let at = |size: f64| -> Result<f64> {
        let data = exact.without_noise(&hidden(size))?;
        let plain = without_hypotheses(&data);
        Ok(solved(&Problem::new(&plain)?)?.chi2)
    };
    let first = at(on.unit)?;
    if first < NEGLIGIBLE {
        return Ok(None);
    }
    let target = log_uniform(OUTSIDE_SIZES, &mut rng);
    let size = size_for(target, (on.unit, first), at).context("no size is visible")?;
    let hidden = hidden(size);
    let clean = without_hypotheses(&exact.without_noise(&hidden)?);
    let (setup, run, dataset) = measured(case, &exact, &hidden)?;

    let mut tried = Tried {
        noncentrality: at(size)?,
        ..without_file(form, &on, (&setup, &run), (&clean, &dataset))?
    };
    if form.origin() != Origin::Grammar {
        beside(case, form, &on, (&clean, &dataset), &mut tried)?;
    }
    Ok(Some(tried))
}

/// What is found without a file.
fn without_file(
    form: &Form,
    on: &OnRobot,
    (setup, run): (&Setup, &Simulated),
    (clean, dataset): (&Dataset, &Dataset),
) -> Result<Tried> {
    let before = asked(dataset.clone())?;
    let mut tried = Tried {
        named: names(&before),
        is_unexplained: !unexplained(&before).is_empty(),
        ..Tried::default()
    };
    if tried.is_unexplained {
        patterns(&before, on, (setup, run), form, &mut tried)?;
    }
    if let Some(formula) = &on.in_grammar {
        let (reading, _) = form.in_grammar(&run.truth).context("in the grammar")?;
        tried.form_is_separated = Some(form_is_separated(clean, on, (reading, &formula.id))?);
    }
    Ok(tried)
}

fn without_hypotheses(data: &Dataset) -> Dataset {
    let mut data = data.clone();
    data.robot.hypotheses.clear();
    data
}

/// What `formulas` lists.
fn patterns(
    before: &Diagnosed,
    on: &OnRobot,
    (setup, run): (&Setup, &Simulated),
    form: &Form,
    tried: &mut Tried,
) -> Result<()> {
    let Some(found) = find_formulas(before, &mut |_| Control::Continue)? else {
        return Ok(());
    };
    let patterns = found.patterns();
    tried.patterns = patterns.len();
    let targets: Vec<String> = on.cable.iter().cloned().collect();
    let known = on.in_grammar.as_ref();
    tried.place = known.and_then(|formula| place_of(&patterns, &formula.id, &targets));
    let gain = patterns.iter().find_map(|pattern| pattern.gain.as_ref());
    tried.gain = gain.and_then(|gain| gain.holdout_before.zip(gain.holdout_after));
    let is_cause = |name: &String| !name.starts_with(PATTERN);
    tried.named_beside_patterns = names(&found.after).into_iter().filter(is_cause).collect();
    if form.origin() == Origin::Grammar && !patterns.is_empty() {
        let robot = &found.after.dataset.robot;
        let extended = found.after.diagnosis.extended_solution.globals.model(robot);
        tried.held_out_ratio = held_out_ratio(setup, run, extended)?;
    }
    Ok(())
}

/// Files beside the data: the right one, and one of another form.
fn beside(
    case: &Case,
    form: &Form,
    on: &OnRobot,
    (clean, dataset): (&Dataset, &Dataset),
    tried: &mut Tried,
) -> Result<()> {
    match (on.hypothesis()?, &on.file) {
        (Some(own), _) => {
            let dataset = with_files(dataset, std::slice::from_ref(&own))?;
            let found = asked(dataset.clone())?;
            let truth = on.setting(own.id(), Default::default());
            let claims = Claim::of(&found.diagnosis.findings);
            tried.found = judge(std::slice::from_ref(&truth), &claims, &dataset.robot)
                .first()
                .map(|(found, _)| *found);
            let clean = with_files(clean, std::slice::from_ref(&own))?;
            let rivals = single_effects(&clean.robot);
            tried.file_is_separated = Some(is_separated(&clean, &truth, own.effect(), rivals)?);
        }
        (None, Err(reason)) => tried.not_a_file = Some((*reason).to_owned()),
        (None, Ok(_)) => {}
    }
    let Some(wrong) = other_file(case, form)? else {
        return Ok(());
    };
    let found = asked(with_files(dataset, std::slice::from_ref(&wrong))?)?;
    let is_wrong = |name: &String| name.split(':').next() == Some(wrong.id());
    tried.wrong_file_is_named = Some(names(&found).iter().any(is_wrong));
    Ok(())
}

/// The file of the next form that can be written for the robot.
fn other_file(case: &Case, form: &Form) -> Result<Option<Hypothesis>> {
    let all: Vec<Form> = forms()
        .filter(|one| one.origin() != Origin::Grammar)
        .collect();
    let own = all.iter().position(|one| one.id == form.id).unwrap_or(0);
    let others = (1..all.len()).map(|k| &all[(own + k) % all.len()]);
    for other in others {
        if let Some(on) = other.on(&setup(case)?)?
            && let Some(file) = on.hypothesis()?
        {
            return Ok(Some(file));
        }
    }
    Ok(None)
}

/// Whether readings without noise show an effect and rule out every other permanent effect, and the same one elsewhere.
fn is_separated(
    clean: &Dataset,
    truth: &EffectSetting,
    effect: &Effect,
    mut rivals: Vec<EffectRequest>,
) -> Result<bool> {
    let here =
        |request: &EffectRequest| request.effect == truth.effect && request.cables == truth.targets;
    rivals.extend(on_each_target(effect, &clean.robot));
    // The same effect on all cables includes the one on a cable.
    rivals.retain(|request| request.effect != truth.effect || !request.cables.is_empty());
    rivals.retain(|request| !here(request));
    let own = EffectRequest {
        effect: truth.effect.clone(),
        cables: truth.targets.clone(),
        values: Vec::new(),
    };
    let causes = std::iter::once(&own).chain(&rivals);
    let causes = causes.filter_map(|request| cause(request, &clean.robot));
    let odds = log_odds(clean, &causes.collect::<Vec<_>>())?;
    let present = odds[0];
    Ok(is_seen(present) && odds[1..].iter().all(|other| !is_confused(present, *other)))
}

fn cause(request: &EffectRequest, robot: &Robot) -> Option<Cause> {
    let instances = request.bind(robot).ok()?;
    (instances.len() == 1).then_some(Cause { instances })
}

/// Whether readings without noise rule out every other form of the grammar and every effect of the catalogue.
fn form_is_separated(
    clean: &Dataset,
    on: &OnRobot,
    (reading, id): (Reading, &str),
) -> Result<bool> {
    let solution = solved(&Problem::new(clean)?)?;
    let (own, others): (Vec<_>, Vec<_>) = formulas(reading, clean, &solution)
        .into_iter()
        .partition(|formula| formula.id == id);
    let Some(own) = own.first() else {
        return Ok(false);
    };
    let own = Hypothesis::parse(&own.text)?;
    let truth = on.setting(id, Default::default());
    for some in others.chunks(MAX_HYPOTHESES - 1) {
        let mut files = vec![own.clone()];
        for formula in some {
            files.push(Hypothesis::parse(&formula.text)?);
        }
        let clean = with_files(clean, &files)?;
        let mut rivals = single_effects(&clean.robot);
        for file in &files[1..] {
            let on_one = on_each_target(file.effect(), &clean.robot).into_iter();
            rivals.extend(
                on_one.filter(|request| request.cables.is_empty() == truth.targets.is_empty()),
            );
        }
        if !is_separated(&clean, &truth, own.effect(), rivals)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// As many causes of the catalogue as chance has it, diagnosed without files and with ten irrelevant ones.
fn crowd(case: &Case) -> Result<Crowd> {
    let exact = setup(case)?;
    let plan = Plan {
        robot: exact.robot.name,
        seed: case.seed,
        wanted: Wanted::ByChance,
        circumstances: Circumstances::AsStated,
    };
    let drawn = draw(&plan)?.context("nothing drawn")?;
    let (_, _, dataset) = measured(case, &exact, &drawn.hidden)?;
    let files = ten_files();
    let files = files.iter().map(|text| Hypothesis::parse(text));
    let crowded = with_files(&dataset, &files.collect::<Result<Vec<_>, _>>()?)?;
    let robot = crowded.robot.clone();
    let [(without, without_s), (with, with_s)] =
        [dataset, crowded].map(|dataset| timed(|| asked(dataset)));
    let found = [without?, with?];
    let answers = found.each_ref().map(answer);
    let mut named = found.iter().flat_map(names);
    Ok(Crowd {
        is_same: answers[0] == answers[1],
        answers: answers.map(|answer| answer.join("; ")),
        is_file_named: named.any(|name| is_of(&name, &robot)),
        seconds: [without_s, with_s],
    })
}

fn is_of(name: &str, robot: &Robot) -> bool {
    let id = name.split(':').next();
    robot
        .hypothesis_effects()
        .any(|effect| Some(effect.id()) == id)
}

/// Verdicts in words: a name with its cables, and for lists and unknown errors that there is one.
fn answer(diagnosed: &Diagnosed) -> Vec<String> {
    let claims = Claim::of(&diagnosed.diagnosis.findings);
    let mut said: Vec<String> = claims
        .iter()
        .map(|claim| match claim.verdict {
            Verdict::Named => claim.describe(),
            Verdict::Ambiguous => "a list".to_owned(),
            Verdict::Unknown => "unknown".to_owned(),
        })
        .collect();
    said.sort_unstable();
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_on_every_robot_and_both_kinds_of_machines_have_as_many_sets() {
        let cases = cases(7);
        let of = |is: &dyn Fn(&Case) -> bool| cases.iter().filter(|case| is(case)).count();
        assert_eq!(of(&|case| case.form.is_none()), CROWDS);
        let exact = of(&|case| case.machine == Machine::Exact);
        assert!(exact.abs_diff(cases.len() - exact) <= ROBOTS.len());
        for form in forms() {
            for robot in ROBOTS {
                let is = |case: &Case| case.form.as_deref() == Some(form.id) && case.robot == robot;
                assert_eq!(of(&is), 1, "{} on {robot}", form.id);
            }
        }
        assert!(cases.iter().zip(7..).all(|(case, seed)| case.seed == seed));
    }

    /// With this seed; with others the doctor misses a pattern of this size in one of about ten data sets.
    #[test]
    fn a_form_is_found_by_its_file_or_as_a_pattern() {
        let on_planar = |form: Option<&str>| Case {
            robot: "planar".to_owned(),
            form: form.map(str::to_owned),
            machine: Machine::Exact,
            seed: 910_038,
        };
        let Some(Outcome::Tried(wave)) = run(&on_planar(Some("laser_hum"))).unwrap() else {
            panic!("the robot has a laser");
        };
        assert_eq!(
            (wave.found, wave.file_is_separated),
            (Some(Found::Named), Some(true))
        );
        assert_eq!(wave.wrong_file_is_named, Some(false));
        assert_eq!((wave.form_is_separated, wave.place), (None, None));
        let Some(Outcome::Tried(pattern)) = run(&on_planar(Some("in_grammar_7"))).unwrap() else {
            panic!("the robot has force sensors");
        };
        assert_eq!(
            (pattern.place, pattern.form_is_separated),
            (Some(0), Some(true))
        );
        assert!(
            pattern
                .held_out_ratio
                .is_some_and(|ratio| (ratio - 1.0).abs() < 0.05)
        );
        let Some(Outcome::Crowd(crowd)) = run(&on_planar(None)).unwrap() else {
            panic!("ten files");
        };
        assert!(crowd.is_same && !crowd.is_file_named);
        assert_eq!(run(&on_planar(Some("refraction"))).unwrap(), None);
    }
}
