//! Hides an effect in simulated data and lets the model doctor find it.
//!
//! `cargo run --release -p tautline-core --example hide_effect`

use std::error::Error;

use tautline_core::diagnosis::{DiagnosisOptions, diagnose};
use tautline_core::effect::EffectSetting;
use tautline_core::estimation::Control;
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, simulate};

fn main() -> Result<(), Box<dyn Error>> {
    let mini = presets::find("mini").ok_or("there is no such preset")?;

    // The drum of the third winch is larger than drawn: 0.4 % more cable per revolution.
    let hidden = EffectSetting {
        effect: "winch_scale".to_owned(),
        targets: vec!["cable-3".to_owned()],
        parameters: [("scale".to_owned(), 0.004)].into(),
    };
    let run = simulate(
        &mini.robot,
        &SimulationOptions {
            effects: vec![hidden],
            workspace: Some(mini.workspace),
            tension: Some(mini.tension),
            ..SimulationOptions::new(40, 1)
        },
    )?;

    // The dataset holds the robot as described and the readings; the effect is only in `run.truth`.
    let options = DiagnosisOptions::default();
    let diagnosis = diagnose(&run.dataset, &options, &mut |_| Control::Continue)?;
    for (model, adequacy) in [
        ("as described", &diagnosis.base),
        ("extended", &diagnosis.extended),
    ] {
        let test = adequacy.global;
        println!(
            "model {model}: chi-square {:.0} for {:.0} degrees of freedom",
            test.chi2, test.degrees_of_freedom
        );
    }
    for finding in &diagnosis.findings {
        println!("{}", finding.sentence);
        for parameter in &finding.parameters {
            let sd = parameter.sd.unwrap_or(f64::NAN);
            println!("  {} = {:.5} ± {sd:.5}", parameter.name, parameter.value);
        }
    }
    Ok(())
}
