//! `tautline replay`.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Result;
use tautline_core::robot::Robot;
use tautline_session::{read_poses, read_table_file};
use tautline_workflow::diagnosis::TIME_LIMIT_S;
use tautline_workflow::identification::identified;
use tautline_workflow::plot::draw::drawing;
use tautline_workflow::replay::{Replay, ReplayDocument, ReplayedReading};
use tautline_workflow::report::PLOT;

use crate::diagnose::{diagnose_with_progress, model_to_diagnose};
use crate::examples::examples;
use crate::output::{JsonOutput, say, write_file};
use crate::replace::OutputFile;
use crate::{BadInput, input, standard_input, table};

/// Size of the picture (pt), and the scale of its texts.
const SIZE: [f64; 2] = [560.0, 240.0];
const SCALE: f64 = 0.9;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("How far a simulator is from the machine, and why", "tautline replay mini --simulated simulated.csv"),
    ("With a model that was identified from other readings", "tautline replay bad --simulated simulated.csv --model model.json"),
]))]
pub struct Arguments {
    /// Session file or dataset folder; - is a session on standard input
    #[arg(value_name = "SESSION|DATASET")]
    subject: PathBuf,
    /// Readings that your simulator predicts at the poses of the dataset, in the columns of poses.csv: pose, x_m .. qz where the simulator
    /// has the platform, length_1_m .., force_1_n .., laser_m ..
    #[arg(long, value_name = "FILE")]
    simulated: PathBuf,
    /// Identified model; without it, the readings are diagnosed and identified with the causes found; - is standard input
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Draw the errors of simulator and model over the poses (SVG), for the reading that the simulator predicts worst
    #[arg(long, value_name = "FILE")]
    picture: Option<OutputFile>,
    #[command(flatten)]
    json: JsonOutput<ReplayDocument>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let session = input::session(&arguments.subject)?;
    let place = arguments.subject.display();
    let simulated = read_table_file(&arguments.simulated, |reader, file| {
        read_poses(reader, file, &session.robot)
    })?;
    let simulated = input::noticed(simulated);
    let failed = |error: &dyn std::fmt::Display| BadInput::new(format!("{place}: {error}"));
    let (dataset, model) = match &arguments.model {
        Some(path) => {
            let model: Robot = input::noticed(standard_input::versioned(path)?);
            (session.dataset(), model)
        }
        None => {
            let dataset = model_to_diagnose(&session).map_err(|error| failed(&error))?;
            let alpha = session.settings.diagnosis.alpha;
            let diagnosed = diagnose_with_progress(Arc::new(dataset), (alpha, TIME_LIMIT_S));
            let diagnosed = diagnosed.map_err(|error| failed(&error))?;
            let solution = &diagnosed.diagnosis.extended_solution;
            let model = identified(diagnosed.robot(), solution);
            // Without the mistakes in the table that the diagnosis undid.
            let mut dataset = (*diagnosed.dataset).clone();
            dataset.robot = session.robot;
            (dataset, model)
        }
    };
    let replay = Replay::new(&dataset, &model, &simulated)
        .map_err(|error| BadInput::new(format!("{}: {error}", arguments.simulated.display())))?;
    if let Some(path) = &arguments.picture {
        let label = "Errors of the simulator and of the identified model over the poses";
        let picture = drawing(label, &replay.figure(replay.worst()), SIZE, SCALE, &PLOT);
        write_file(path, picture.svg_file().as_bytes())?;
    }
    let document = replay.document();
    arguments.json.deliver(&document, || print(&document))
}

fn print(document: &ReplayDocument) {
    say!(
        "{}: {} poses, errors as root mean square",
        document.robot,
        document.poses
    );
    let mut rows = table::numbers(&ReplayedReading::HEADINGS);
    for reading in &document.readings {
        table::push(&mut rows, &reading.cells());
    }
    say!("{rows}");
    for reading in document
        .readings
        .iter()
        .filter(|reading| !reading.causes.is_empty())
    {
        say!("{}", ReplayedReading::explained(reading));
    }
    for text in document.sentences() {
        say!("{text}");
    }
}
