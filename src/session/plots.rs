//! Arrangement of the plots, as stored in the preferences.

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
    /// The plot area of the window; that of a new installation if absent.
    pub area: Option<PlotArea>,
    /// Names of the plots in separate windows.
    pub detached: Vec<String>,
}

/// An area with plots. Unknown names are ignored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PlotArea {
    /// Plots on tabs in the same place.
    Tabs {
        /// Names of the plots.
        plots: Vec<String>,
        /// The active tab.
        shown: Option<String>,
    },
    /// Areas side by side.
    Row(Vec<PlotShare>),
    /// Areas one above the other.
    Column(Vec<PlotShare>),
}

/// An area among others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlotShare {
    /// Size relative to the others.
    pub share: f64,
    /// The area.
    pub area: PlotArea,
}

impl Plots {
    /// Version 1 had one, two or four plots of the same size.
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
