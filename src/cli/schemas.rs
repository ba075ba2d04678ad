//! `tautline schemas`.

use std::path::Path;

use anyhow::{Context, Result};

use super::adjust::AdjustmentDocument;
use super::compare::ComparisonDocument;
use super::home::HomeDocument;
use super::measure::MeasuringDocument;
use super::output::write_json;
use super::precalibrate::Precalibration;
use super::verify::VerificationDocument;
use crate::output::say;
use tautline_import::{ImportDocument, Recipe};
use tautline_study::{StudyFile, StudyPlan, StudyResult};
use tautline_workflow::accuracy::Accuracy;
use tautline_workflow::audit::AuditDocument;
use tautline_workflow::documents::diagnosis::DiagnosisDocument;
use tautline_workflow::documents::plan::PlanDocument;
use tautline_workflow::identification::IdentificationDocument;
use tautline_workflow::readiness::ReadinessDocument;

pub fn run(out: &Path) -> Result<()> {
    std::fs::create_dir_all(out).with_context(|| format!("{} cannot be created", out.display()))?;
    let mut schemas = tautline_session::schemas();
    schemas.push(tautline_session::versioned_schema::<Recipe>());
    schemas.push(tautline_session::versioned_schema::<ImportDocument>());
    schemas.push(tautline_session::versioned_schema::<IdentificationDocument>());
    schemas.push(tautline_session::versioned_schema::<DiagnosisDocument>());
    schemas.push(tautline_session::versioned_schema::<Accuracy>());
    schemas.push(tautline_session::versioned_schema::<Precalibration>());
    schemas.push(tautline_session::versioned_schema::<PlanDocument>());
    schemas.push(tautline_session::versioned_schema::<ReadinessDocument>());
    schemas.push(tautline_session::versioned_schema::<ComparisonDocument>());
    schemas.push(tautline_session::versioned_schema::<MeasuringDocument>());
    schemas.push(tautline_session::versioned_schema::<AdjustmentDocument>());
    schemas.push(tautline_session::versioned_schema::<VerificationDocument>());
    schemas.push(tautline_session::versioned_schema::<HomeDocument>());
    schemas.push(tautline_session::versioned_schema::<AuditDocument>());
    schemas.push(tautline_session::versioned_schema::<StudyFile>());
    schemas.push(tautline_session::versioned_schema::<StudyPlan>());
    schemas.push(tautline_session::versioned_schema::<StudyResult>());
    for schema in schemas {
        let path = out.join(&schema.file_name);
        write_json(&path, &schema.schema)?;
        say!("{}", path.display());
    }
    Ok(())
}
