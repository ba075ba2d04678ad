//! Running the chunks of a study on threads of this process, one file per chunk; existing chunks are kept.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use tautline_core::estimation::Control;

use crate::calibration::Simulator;
use crate::cell::Cell;
use crate::chunk::{ChunkNumber, Origin, Rows, read_chunk, write_chunk};
use crate::plan::{PLAN, StudyPlan};
use crate::{StudyError, VERSION, create_folder};

/// Number of calibrations between two checks for cancellation.
const BETWEEN_LOOKS: u64 = 16;

/// Interval between two calls of the observer.
const BETWEEN_QUESTIONS: Duration = Duration::from_millis(20);

/// State shared with the worker threads.
#[derive(Debug, Default)]
struct Shared {
    /// Number of calibrations done.
    done: AtomicU64,
    /// Set to stop early: unfinished chunks are lost.
    cancelled: AtomicBool,
}

/// Summary of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Summary {
    /// Number of chunks computed.
    pub done: u64,
    /// Number of chunks that already existed.
    pub found: u64,
}

/// Runs chunks of a study on several threads. The observer is called on the calling thread with the number of
/// finished calibrations; unfinished chunks are lost when it cancels.
///
/// # Errors
/// If a part does not belong to the study, an existing chunk has another origin, a chunk cannot be written, or it was
/// cancelled.
pub fn run(
    plan: &StudyPlan,
    folder: &Path,
    parts: &[ChunkNumber],
    threads: usize,
    observer: &mut dyn FnMut(u64) -> Control,
) -> Result<Summary, StudyError> {
    let shared = Shared::default();
    std::thread::scope(|scope| {
        let running = scope.spawn(|| work(plan, folder, parts, threads, &shared));
        while !running.is_finished() {
            if observer(shared.done.load(Ordering::Relaxed)) == Control::Cancel {
                shared.cancelled.store(true, Ordering::Relaxed);
            }
            std::thread::sleep(BETWEEN_QUESTIONS);
        }
        running
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

fn work(
    plan: &StudyPlan,
    folder: &Path,
    parts: &[ChunkNumber],
    threads: usize,
    shared: &Shared,
) -> Result<Summary, StudyError> {
    let all = plan.calibrations();
    if let Some(part) = parts.iter().find(|part| part.of > all.max(1)) {
        return Err(StudyError::Input(format!(
            "found a division into {} chunks, expected at most {all}, the number of calibrations of the study",
            part.of
        )));
    }
    let fingerprint = &plan.fingerprint();
    let next = AtomicU64::new(0);
    let summary = Mutex::new(Summary::default());
    let failure: Mutex<Option<StudyError>> = Mutex::new(None);
    let work_on_rest = || {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed) as usize;
            let Some(part) = parts.get(index) else { return };
            let is_over = shared.cancelled.load(Ordering::Relaxed) || lock(&failure).is_some();
            if is_over {
                return;
            }
            match chunk((plan, fingerprint), folder, *part, shared) {
                Ok(true) => lock(&summary).done += 1,
                Ok(false) => lock(&summary).found += 1,
                Err(error) => {
                    lock(&failure).get_or_insert(error);
                    return;
                }
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads.clamp(1, parts.len().max(1)) {
            scope.spawn(work_on_rest);
        }
    });
    if let Some(error) = lock(&failure).take() {
        return Err(error);
    }
    if shared.cancelled.load(Ordering::Relaxed) {
        return Err(StudyError::Cancelled);
    }
    let summary = *lock(&summary);
    Ok(summary)
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    // A panicked thread leaves a consistent value, because counts and errors are set in one step.
    mutex
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Runs one chunk, unless it exists; returns whether it was computed.
fn chunk(
    (plan, fingerprint): (&StudyPlan, &str),
    folder: &Path,
    part: ChunkNumber,
    shared: &Shared,
) -> Result<bool, StudyError> {
    let path = folder.join(part.file_name());
    let [from, to] = part.range(plan.calibrations());
    if path.exists() {
        let (origin, _) = read_chunk(&path)?;
        belongs(&origin, (plan, fingerprint), part)
            .map_err(|message| StudyError::Input(format!("{}: {message}", path.display())))?;
        shared.done.fetch_add(to - from, Ordering::Relaxed);
        return Ok(false);
    }
    let simulated = plan.simulated();
    let each = plan.study.simulation.calibrations;
    let mut rows = Rows::default();
    let mut index = from;
    while index < to {
        let place = simulated[(index / each) as usize];
        let cell = plan.cell(place)?;
        let end = to.min((index / each + 1) * each);
        calibrate(plan, (place, &cell), [index, end], shared, &mut rows)?;
        index = end;
    }
    create_folder(folder)?;
    let origin = Origin::of((plan, fingerprint), part, &rows);
    write_chunk(folder, &origin, &rows)?;
    Ok(true)
}

/// Calibrations of one cell within a range of numbers of the study.
fn calibrate(
    plan: &StudyPlan,
    (place, cell): (usize, &Cell),
    [from, to]: [u64; 2],
    shared: &Shared,
    rows: &mut Rows,
) -> Result<(), StudyError> {
    let method = plan.cells[place].combination.method.of_solver();
    let simulator = Simulator::new(&plan.study, cell, method)
        .map_err(|error| StudyError::Input(format!("{PLAN}: cell {place}: {error}")))?;
    for index in from..to {
        if index % BETWEEN_LOOKS == 0 && shared.cancelled.load(Ordering::Relaxed) {
            return Err(StudyError::Cancelled);
        }
        let within = index % plan.study.simulation.calibrations;
        rows.push(place, &simulator.calibrate(index, within));
        shared.done.fetch_add(1, Ordering::Relaxed);
    }
    Ok(())
}

/// Checks that a chunk has this number in this study, and was computed by this version of the program.
pub(crate) fn belongs(
    origin: &Origin,
    (plan, fingerprint): (&StudyPlan, &str),
    part: ChunkNumber,
) -> Result<(), String> {
    let expect = |what: &str, found: &str, expected: &str| match found == expected {
        true => Ok(()),
        false => Err(format!(
            "found a chunk of {what} {found}, expected {expected}"
        )),
    };
    expect("the program version", &origin.version, VERSION)?;
    expect("the study", &origin.study, fingerprint)?;
    expect(
        "the seed",
        &origin.seed.to_string(),
        &plan.study.seed.to_string(),
    )?;
    let name = |part: ChunkNumber| format!("{} of {}", part.number, part.of);
    expect("number", &name(origin.part), &name(part))?;
    let range = |[from, to]: [u64; 2]| format!("{from} to {to}");
    expect(
        "calibrations",
        &range(origin.range),
        &range(part.range(plan.calibrations())),
    )
}
