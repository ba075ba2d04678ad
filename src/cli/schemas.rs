//! `tautline schemas`.

use std::path::Path;

use anyhow::{Context, Result};

use super::certificate::CertificateDocument;
use super::measure::MeasuringDocument;
use super::output::write_json;
use crate::examples::examples;
use crate::output::confirm;
use crate::replace::{OutputFile, permit};
use tautline_import::{ImportDocument, Recipe};
use tautline_study::{StudyFile, StudyPlan, StudyResult};
use tautline_workflow::accuracy::{Accuracy, VerificationDocument};
use tautline_workflow::adjusting::AdjustmentDocument;
use tautline_workflow::audit::AuditDocument;
use tautline_workflow::comparison::ComparisonDocument;
use tautline_workflow::diagnosis::DiagnosisDocument;
use tautline_workflow::effects::EffectsDocument;
use tautline_workflow::formulas::FormulasDocument;
use tautline_workflow::health::HealthDocument;
use tautline_workflow::history::HistoryDocument;
use tautline_workflow::identification::IdentificationDocument;
use tautline_workflow::planning::PlanDocument;
use tautline_workflow::precalibration::{HomeDocument, Precalibration};
use tautline_workflow::readiness::ReadinessDocument;
use tautline_workflow::replay::ReplayDocument;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("The schemas of all formats", "tautline schemas -o schemas"),
]))]
pub struct Arguments {
    /// Folder to write to
    #[arg(short, long, value_name = "DIR")]
    out: OutputFile,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let out: &Path = &arguments.out;
    let mut schemas = tautline_session::schemas();
    schemas.push(tautline_session::versioned_schema::<Recipe>());
    schemas.push(tautline_session::versioned_schema::<ImportDocument>());
    schemas.push(tautline_session::versioned_schema::<IdentificationDocument>());
    schemas.push(tautline_session::versioned_schema::<DiagnosisDocument>());
    schemas.push(tautline_session::versioned_schema::<Accuracy>());
    schemas.push(tautline_session::versioned_schema::<Precalibration>());
    schemas.push(tautline_session::versioned_schema::<PlanDocument>());
    schemas.push(tautline_session::versioned_schema::<ReadinessDocument>());
    schemas.push(tautline_session::versioned_schema::<HealthDocument>());
    schemas.push(tautline_session::versioned_schema::<FormulasDocument>());
    schemas.push(tautline_session::versioned_schema::<ReplayDocument>());
    schemas.push(tautline_session::versioned_schema::<ComparisonDocument>());
    schemas.push(tautline_session::versioned_schema::<HistoryDocument>());
    schemas.push(tautline_session::versioned_schema::<EffectsDocument>());
    schemas.push(tautline_session::versioned_schema::<MeasuringDocument>());
    schemas.push(tautline_session::versioned_schema::<AdjustmentDocument>());
    schemas.push(tautline_session::versioned_schema::<VerificationDocument>());
    schemas.push(tautline_session::versioned_schema::<HomeDocument>());
    schemas.push(tautline_session::versioned_schema::<AuditDocument>());
    schemas.push(tautline_session::versioned_schema::<CertificateDocument>());
    schemas.push(tautline_session::versioned_schema::<StudyFile>());
    schemas.push(tautline_session::versioned_schema::<StudyPlan>());
    schemas.push(tautline_session::versioned_schema::<StudyResult>());
    let schemas = schemas.into_iter();
    let files: Vec<_> = schemas
        .map(|schema| (out.join(schema.file_name), schema.schema))
        .collect();
    files.iter().try_for_each(|(path, _)| permit(path, &[]))?;
    std::fs::create_dir_all(out).with_context(|| format!("{} cannot be created", out.display()))?;
    for (path, schema) in &files {
        write_json(path, schema)?;
        confirm!("{}", path.display());
    }
    Ok(())
}
