//! Sums over the sessions, from which the normal equations of any set of changes follow.

use nalgebra::{DMatrix, DVector};

use super::state::{SessionInformation, State};

/// Time dependence of a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Course {
    /// A jump after the session with this index.
    JumpAfter(usize),
    /// A steady drift.
    Drift,
}

/// A change of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Change {
    pub part: usize,
    pub course: Course,
}

/// Suffix sums over sessions of information and moments, weighted by powers of time.
pub(super) struct Timeline {
    /// Times of the sessions (days), relative to their mean.
    pub times: Vec<f64>,
    /// `sum_(j >= k) t_j^p L_j` for each session `k` and the powers 0 and 1: rows of the whole state, columns of the numbers that
    /// may change.
    information: [Vec<DMatrix<f64>>; 2],
    /// `sum_j t_j^2 L_j` of the numbers that may change.
    of_squares: DMatrix<f64>,
    /// `sum_(j >= k) t_j^p L_j x_j` of the numbers that may change.
    moments: [Vec<DVector<f64>>; 2],
    /// `sum_j L_j` and `sum_j L_j x_j` of the whole state.
    pub whole: SessionInformation,
}

impl Timeline {
    pub fn new(state: &State, days: &[f64], sessions: &[SessionInformation]) -> Self {
        let mean = days.iter().sum::<f64>() / days.len() as f64;
        let times: Vec<f64> = days.iter().map(|day| day - mean).collect();
        let count = state.changeable();
        let mut whole = SessionInformation {
            information: DMatrix::zeros(state.len(), state.len()),
            moment: DVector::zeros(state.len()),
        };
        let mut of_squares = DMatrix::zeros(count, count);
        let mut information = [Vec::new(), Vec::new()];
        let mut moments = [Vec::new(), Vec::new()];
        let mut sums = [
            (DMatrix::zeros(state.len(), count), DVector::zeros(count)),
            (DMatrix::zeros(state.len(), count), DVector::zeros(count)),
        ];
        for (session, time) in sessions.iter().zip(&times).rev() {
            whole.information += &session.information;
            whole.moment += &session.moment;
            let columns = session.information.columns(0, count);
            let moment = session.moment.rows(0, count);
            of_squares += columns.rows(0, count) * (time * time);
            for (power, (sum, of_moment)) in sums.iter_mut().enumerate() {
                let weight = if power == 0 { 1.0 } else { *time };
                *sum += columns * weight;
                *of_moment += moment * weight;
                information[power].push(sum.clone());
                moments[power].push(of_moment.clone());
            }
        }
        for all in &mut information {
            all.reverse();
        }
        for all in &mut moments {
            all.reverse();
        }
        Self {
            times,
            information,
            of_squares,
            moments,
            whole,
        }
    }

    /// Power of the time and first session of a change.
    fn weights(course: Course) -> (usize, usize) {
        match course {
            Course::JumpAfter(session) => (0, session + 1),
            Course::Drift => (1, 0),
        }
    }

    /// Value of a change's function of time in a session.
    pub fn factor(&self, course: Course, session: usize) -> f64 {
        match course {
            Course::JumpAfter(after) => f64::from(u8::from(session > after)),
            Course::Drift => self.times[session],
        }
    }

    /// Information between the whole state and a change of the given numbers (state x numbers).
    pub fn with_state(&self, course: Course, numbers: &[usize]) -> DMatrix<f64> {
        let (power, from) = Self::weights(course);
        self.information[power][from].select_columns(numbers)
    }

    /// Information between two changes, with rows and columns for the numbers of each.
    pub fn between(
        &self,
        (one, rows): (Course, &[usize]),
        (other, columns): (Course, &[usize]),
    ) -> DMatrix<f64> {
        let ((p, from), (q, until)) = (Self::weights(one), Self::weights(other));
        let all = match p + q {
            2 => &self.of_squares,
            power => &self.information[power][from.max(until)],
        };
        all.select_columns(columns).select_rows(rows)
    }

    /// Moment of a change of the given numbers.
    pub fn moment(&self, course: Course, numbers: &[usize]) -> DVector<f64> {
        let (power, from) = Self::weights(course);
        self.moments[power][from].select_rows(numbers)
    }
}
