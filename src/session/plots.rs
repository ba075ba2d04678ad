//! How the plots are arranged, as preferences keep it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use tautline_core::robot::FieldError;

use crate::error::{below, fail};
use crate::json::Migration;

/// Arrangement of the plots.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Plots {
    /// The area of the plots in the window; that of a new installation if it is not given.
    pub area: Option<PlotArea>,
    /// Names of the plots that have windows of their own.
    pub detached: Vec<String>,
}

/// An area with plots. Names that are not known are ignored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PlotArea {
    /// Plots in the same place, each with a tab.
    Tabs {
        /// Their names.
        plots: Vec<String>,
        /// The one that is seen.
        shown: Option<String>,
    },
    /// Areas beside each other.
    Row(Vec<PlotShare>),
    /// Areas above each other.
    Column(Vec<PlotShare>),
}

/// An area among others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlotShare {
    /// Its size relative to the others.
    pub share: f64,
    /// The area.
    pub area: PlotArea,
}

impl Plots {
    /// Version 1 knew one, two or four plots of the same size.
    pub(crate) const MIGRATION: Migration = Migration {
        from: 1,
        apply: |preferences: &mut Map<String, Value>| {
            preferences.remove("plots");
            Ok(())
        },
    };

    pub(crate) fn check(&self) -> Result<(), FieldError> {
        self.area.as_ref().map_or(Ok(()), |area| {
            area.check().map_err(|error| below("/area", error))
        })
    }
}

impl PlotArea {
    fn check(&self) -> Result<(), FieldError> {
        let (key, shares) = match self {
            Self::Tabs { .. } => return Ok(()),
            Self::Row(shares) => ("row", shares),
            Self::Column(shares) => ("column", shares),
        };
        for (k, PlotShare { share, area }) in shares.iter().enumerate() {
            if !(share.is_finite() && *share > 0.0) {
                let message = format!("found {share}, expected a number above 0");
                return fail(format!("/{key}/{k}/share"), message);
            }
            let inside = format!("/{key}/{k}/area");
            area.check().map_err(|error| below(&inside, error))?;
        }
        Ok(())
    }
}
