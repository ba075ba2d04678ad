//! Measured elongation: used within its range, reported beyond.

use super::*;
use crate::cable::ElongationSurface;

/// The elongation of MINI's cable, `length * tension / stiffness`, as a surface of degree 2.
fn surface(highest_tension_n: f64) -> ElongationSurface {
    let (length, tension) = (1.4, 0.5 * highest_tension_n);
    let stiffness = 4e4;
    ElongationSurface {
        degree: 2,
        length_center_m: length,
        length_scale_m: 1.2,
        tension_center_n: tension,
        tension_scale_n: tension,
        coefficients: vec![
            length * tension / stiffness,
            1.2 * tension / stiffness,
            length * tension / stiffness,
            0.0,
            1.2 * tension / stiffness,
            0.0,
        ],
        residual_sd_m: 1e-6,
    }
}

fn with_surface(dataset: &Dataset, cables: &[usize], highest_tension_n: f64) -> Dataset {
    let mut dataset = dataset.clone();
    for index in cables {
        dataset.robot.cables[*index].cable.elongation_surface = Some(surface(highest_tension_n));
    }
    dataset
}

#[test]
fn a_linear_surface_does_what_the_stiffness_does() {
    let run = run_of("mini", 20, 61);
    let all: Vec<usize> = (0..8).collect();
    let stiff = identified(&run.dataset, Method::Joint);
    let measured = identified(&with_surface(&run.dataset, &all, 200.0), Method::Joint);
    assert_eq!(measured.outside_surface, []);
    // They differ by the square of the strain, 1e-6 of some metres: a few micrometres.
    assert!(difference_in_sd(&stiff, &measured) < 0.05);
}

#[test]
fn tensions_outside_the_measured_range_are_reported() {
    let run = run_of("mini", 20, 62);
    let data = &run.dataset.measurements;
    let tension = |row: usize, cable: usize| {
        let sensor = run.dataset.robot.cables[cable].force_sensor.unwrap();
        sensor.tension_n(data.force_n.get(row, cable))
    };
    // Cables 3 and 6 have a surface whose range ends between their tensions.
    let mut tensions: Vec<f64> = (0..data.len()).map(|row| tension(row, 2)).collect();
    tensions.sort_by(f64::total_cmp);
    let highest = 0.5 * (tensions[17] + tensions[18]);
    let dataset = with_surface(&run.dataset, &[2, 5], highest);
    for method in [Method::Joint, Method::Simple] {
        let solution = identified(&dataset, method);
        let mut expected = Vec::new();
        for row in 0..data.len() {
            let high = |cable: &usize| tension(row, *cable) > highest;
            expected.extend([2, 5].into_iter().filter(high).map(|cable| (row, cable)));
        }
        let found: Vec<_> = solution
            .outside_surface
            .iter()
            .map(|o| (o.row, o.cable))
            .collect();
        assert!(found.iter().filter(|(_, cable)| *cable == 2).count() == 3);
        assert_eq!(found, expected);
        assert!(
            solution
                .outside_surface
                .iter()
                .all(|o| o.range.quantity == "tension")
        );
    }
}

#[test]
fn lengths_outside_the_measured_range_are_reported() {
    let run = run_of("mini", 20, 63);
    let mut dataset = with_surface(&run.dataset, &[4], 300.0);
    let surface = dataset.robot.cables[4].cable.elongation_surface.as_mut();
    surface.unwrap().length_scale_m = 1e-3;
    let solution = solved(&Problem::new(&dataset).unwrap());
    assert!(solution.outside_surface.len() > 10);
    let length = |o: &OutsideSurface| o.cable == 4 && o.range.quantity == "cable length";
    assert!(solution.outside_surface.iter().all(length));
}
