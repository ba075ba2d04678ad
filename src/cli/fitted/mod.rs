//! A solved problem in the forms in which it is shown: JSON, model file, report.

mod report;
mod solving;

use tautline_core::estimation::{Analysis, Deficiency, Problem, Solution};
use tautline_core::robot::Robot;

pub use report::print_report;
pub use solving::{refuse_extrapolation, timed};
use tautline_workflow::documents::identification::{Identification, Solved, identified};

/// A solved problem.
pub struct Fitted<'a> {
    problem: Problem<'a>,
    solution: Solution,
    analysis: Analysis,
    open: Vec<Deficiency>,
    seconds: f64,
    /// Where the drawing has the entry points (m).
    drawn_m: Vec<[f64; 3]>,
}

impl Fitted<'_> {
    fn robot(&self) -> &Robot {
        &self.problem.dataset.robot
    }

    /// Machine form.
    pub fn identification(&self) -> Identification {
        let solved = Solved {
            dataset: self.problem.dataset,
            method: self.problem.method,
            solution: &self.solution,
            analysis: &self.analysis,
            open: &self.open,
            held: self.problem.held_effects.len(),
            seconds: self.seconds,
        };
        solved.identification()
    }

    /// The robot with the identified values; standard deviations become those of the solution.
    pub fn model(&self) -> Robot {
        identified(self.robot(), &self.solution)
    }
}
