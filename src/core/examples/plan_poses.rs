//! Plans the poses of a calibration run and compares them with poses drawn at random.
//!
//! `cargo run --release -p tautline-core --example plan_poses`

use std::error::Error;

use tautline_core::estimation::Control;
use tautline_core::planning::{PlanOptions, plan};
use tautline_core::robot::presets;

fn main() -> Result<(), Box<dyn Error>> {
    let hall = presets::find("hall").ok_or("there is no such preset")?;
    let options = PlanOptions {
        candidates: 1000,
        workspace: Some(hall.workspace),
        tension: Some(hall.tension),
        ..PlanOptions::new(20, 1)
    };
    let plan = plan(&hall.robot, &options, &mut |_| Control::Continue)?;

    println!("pose      x       y       z (m)");
    for planned in plan.poses.iter().take(5) {
        let [x, y, z]: [f64; 3] = planned.pose.position.into();
        println!("{:4} {x:7.3} {y:7.3} {z:7.3}", planned.label);
    }
    println!(
        "... {} poses, {:.0} m of travel\n",
        plan.poses.len(),
        plan.order.travel_m
    );

    // Standard deviations are known before any measurement.
    println!("poses  sd of entry points (mm)");
    for count in [5, 10, 15, 20] {
        let sd_m = plan.after(count).criteria.mean_m.unwrap_or(f64::NAN);
        println!("{count:5}  {:.2}", sd_m * 1e3);
    }
    let random_m = plan.random.criteria.mean_m.unwrap_or(f64::NAN);
    println!("   20  {:.2} at random poses", random_m * 1e3);
    Ok(())
}
