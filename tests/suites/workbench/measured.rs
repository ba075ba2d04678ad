//! Simulated robots for the tests: a dataset folder, opened.

use std::path::PathBuf;

use egui_kittest::Harness;
use tautline_core::effect::{BoundEffect, EffectSetting, Hypothesis};
use tautline_core::measurement::Dataset;
use tautline_core::robot::presets::{self, Preset};
use tautline_core::simulation::{
    Recording, SimulationOptions, TensionRange, TrueGeometry, record, simulate,
};
use tautline_session::{PhaseData, write_dataset};
pub use tautline_validation::support::harness::{give, press};
use tautline_validation::tables::formulas::UNNAMED;
use tautline_workbench::model::OpenSession;
use tautline_workbench::model::command::FileCommand;
use tautline_workbench::shell::App;
use tautline_workflow::templates::Template;

use crate::support::workbench;

/// An effect with its cable, empty for one of the whole robot, and parameters.
type Hidden<'a> = (&'a str, &'a str, &'a [(&'a str, f64)]);

/// A robot of sixteen cables: MINI with a second cable beside each of its own.
fn sixteen() -> Preset {
    let mut preset = presets::find("mini").expect("a preset");
    let robot = &mut preset.robot;
    for index in 0..robot.cables.len() {
        let mut cable = robot.cables[index].clone();
        cable.name = format!("cable-{}", index + 9);
        cable.pulley.entry_point_m[2] *= 0.6;
        cable.platform_anchor_m[2] *= 0.5;
        robot.cables.push(cable);
    }
    preset.measured_entry_points_m = None;
    preset
}

/// A dataset of MINI in a folder that lives as long as this.
pub struct Measured {
    folder: tempfile::TempDir,
}

impl Measured {
    /// `poses` poses with hidden effects, each with its cable and parameters.
    pub fn mini(poses: usize, effects: &[Hidden<'_>]) -> Self {
        Self::of(presets::find("mini").expect("a preset"), poses, effects)
    }

    /// 40 poses of MINI with an error of cable-3 that no effect of the catalogue has.
    pub fn unnamed() -> Self {
        let robot = presets::find("mini").expect("a preset").robot;
        let mut truth = robot.clone();
        let hypothesis = Hypothesis::parse(UNNAMED).expect("a hypothesis");
        truth.add_hypothesis(&hypothesis).expect("known");
        truth.effects.push(EffectSetting {
            effect: "oval_groove".into(),
            targets: vec!["cable-3".into()],
            parameters: [("size".to_owned(), 0.02)].into(),
        });
        let options = SimulationOptions {
            geometry: TrueGeometry::Nominal,
            ..SimulationOptions::new(40, 4)
        };
        let measurements = simulate(&truth, &options)
            .expect("a run")
            .dataset
            .measurements;
        Self::written(&Dataset {
            robot,
            measurements,
        })
    }

    /// So many poses of a robot that a camera tracks and that has neither laser nor force sensors.
    pub fn tracked(poses: usize) -> Self {
        let template = Template::Hangprinter;
        let robot = template.robot(template.usual_size_m());
        let options = SimulationOptions {
            tension: Some(TensionRange::of(&robot)),
            ..SimulationOptions::new(poses, 2)
        };
        Self::written(&simulate(&robot, &options).expect("measurements").dataset)
    }

    /// A planar robot in motion for so long (s), with twenty samples a second.
    pub fn in_motion(duration_s: f64) -> Self {
        let robot = presets::find("planar").expect("a preset").robot;
        let recording = Recording {
            duration_s,
            rate_hz: 20.0,
            correlation_s: 0.0,
        };
        let run = record(&robot, &SimulationOptions::new(0, 5), &recording).expect("recorded");
        Self::written(&run.dataset)
    }

    /// `poses` poses of a robot of 4, 8 or 16 cables.
    pub fn with_cables(cables: usize, poses: usize) -> Self {
        let preset = match cables {
            4 => presets::find("planar").expect("a preset"),
            16 => sixteen(),
            _ => return Self::mini(poses, &[]),
        };
        assert_eq!(preset.robot.cable_count(), cables);
        Self::of(preset, poses, &[])
    }

    fn of(preset: Preset, poses: usize, effects: &[Hidden<'_>]) -> Self {
        let setting = |(effect, cable, values): &Hidden<'_>| EffectSetting {
            effect: (*effect).to_owned(),
            targets: [*cable]
                .iter()
                .filter(|c| !c.is_empty())
                .map(|c| (*c).to_owned())
                .collect(),
            parameters: values.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect(),
        };
        let effects: Vec<_> = effects.iter().map(setting).collect();
        for effect in &effects {
            BoundEffect::from_setting(effect, &preset.robot).expect("an effect");
        }
        let geometry = preset.measured_entry_points_m.clone();
        let options = SimulationOptions {
            geometry: geometry.map_or(TrueGeometry::Drawn, TrueGeometry::EntryPoints),
            effects,
            workspace: Some(preset.workspace),
            tension: Some(preset.tension),
            ..SimulationOptions::new(poses, 1)
        };
        let simulated = simulate(&preset.robot, &options).expect("measurements");
        Self::written(&simulated.dataset)
    }

    fn written(dataset: &Dataset) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        write_dataset(&folder.path().join("mini"), dataset, &PhaseData::default())
            .expect("written");
        Self { folder }
    }

    /// A file or folder next to the dataset.
    pub fn beside(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A workbench that has opened it.
    pub fn opened(&self) -> Harness<'static, App> {
        let mut harness = workbench();
        give(&mut harness, FileCommand::Open(self.beside("mini")));
        harness
    }
}

/// The open session with its results.
pub fn document<'h>(harness: &'h Harness<'_, App>) -> &'h OpenSession {
    harness
        .state()
        .state
        .model
        .open
        .as_ref()
        .expect("a session")
}
