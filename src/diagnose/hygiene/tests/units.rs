//! Gains: units, calibrations, and what is none of these.

use super::*;

/// What is measured of a machine whose model drifts away: any gain, and a part that no gain explains. Among eight of them are factors of
/// ten and eighteen, which would be units if all else were right.
#[test]
fn of_a_model_that_drifts_away_no_gain_is_a_unit() {
    let with = |gains: [f64; 8], unlike: f64| {
        let runs: Vec<(Vec<f64>, Vec<f64>)> = (0..8)
            .map(|i| {
                let rate = 0.008 + 0.001 * i as f64;
                let simulated: Vec<f64> = (0..800).map(|k| (rate * f64::from(k)).sin()).collect();
                let other = |k: usize| unlike * (2.7 * rate * k as f64).sin();
                let measured = simulated.iter().enumerate().map(|(k, v)| gains[i] * (v + other(k))).collect();
                (simulated, measured)
            })
            .collect();
        let [simulated, measured] = channel_of(&runs);
        faults_against(&measured, &simulated, &["wheel_speed".into()])
            .into_iter()
            .filter(|f| f.kind == FaultKind::WrongUnit)
            .map(|f| f.runs)
            .collect::<Vec<_>>()
    };
    assert_eq!(with([1.1, 0.45, 0.7, 2.2, 0.3, 1.5, 0.1, 0.055], 0.6), Vec::<Vec<String>>::new());
    // the same factor of ten in one run of a model that is right
    assert_eq!(with([1.02, 0.99, 1.0, 1.01, 0.98, 1.0, 0.1, 1.03], 0.1), [["run-6.csv"]]);
}

/// A force in mN under N, in the runs in which there is one and in all of them; in one that does not move it is noise.
#[test]
fn a_unit_may_be_that_of_all_runs() {
    let mut random = Random::new(3);
    let run = |moves: f64, factor: f64, random: &mut Random| {
        let simulated: Vec<f64> = (0..800).map(|k| moves * (0.02 * f64::from(k)).sin()).collect();
        let measured = simulated.iter().map(|v| factor * (1.1 * v + 0.01 * random.normal())).collect();
        (simulated, measured)
    };
    for factor in [1e3, 1e-3, 3.6] {
        let mut runs: Vec<_> = (0..6).map(|_| run(1.0, factor, &mut random)).collect();
        runs.push(run(0.0, factor, &mut random));
        let [simulated, measured] = channel_of(&runs);
        let found = faults_against(&measured, &simulated, &["wheel_speed".into()]);
        assert_eq!(found.iter().map(|f| f.kind).collect::<Vec<_>>(), [FaultKind::WrongUnit], "{found:?}");
        // of a speed of rotation 3.6 is no ratio of units, but no parameter makes it
        let said = if factor == 3.6 { 3.6 * 1.1 } else { factor };
        assert!((found[0].value / said - 1.0).abs() < 0.01 && found[0].runs.len() == 6, "{found:?}");
    }
}

/// The height of a body that stays where it is but for rounding, on a road that was not flat: it moves as what was measured does.
#[test]
fn rounding_has_no_unit_and_no_clock() {
    let road = |k: u32, i: usize| 3e-3 * ((0.05 + 0.01 * i as f64) * f64::from(k)).sin();
    let runs: Vec<(Vec<f64>, Vec<f64>)> = (0..4)
        .map(|i| {
            let measured: Vec<f64> = (0..800).map(|k| road(k, i)).collect();
            (measured.iter().map(|v| 2e-16 * v).collect(), measured)
        })
        .collect();
    let [simulated, measured] = channel_of(&runs);
    assert_eq!(faults_against(&measured, &simulated, &["wheel_speed".into()]), []);
}

/// A load that is held: in one run it stands in kN under N. A flat tire, or a load near zero, is no unit.
#[test]
fn a_level_tells_a_unit_that_a_gain_cannot() {
    let found = |measured: [f64; 4], simulated: [f64; 4]| {
        let mut random = Random::new(5);
        let runs: Vec<(Vec<f64>, Vec<f64>)> = (0..4)
            .map(|i| {
                let noisy = |_| measured[i] * (1.0 + 0.01 * random.normal());
                (vec![simulated[i]; 800], (0..800).map(noisy).collect())
            })
            .collect();
        let [simulated, measured] = channel_of(&runs);
        let units = faults_against(&measured, &simulated, &["wheel_speed".into()]).into_iter();
        units.filter(|f| f.kind == FaultKind::WrongUnit).map(|f| (f.value, f.runs)).collect::<Vec<_>>()
    };
    let run = || vec!["run-1.csv".to_owned()];
    assert_eq!(found([4200.0, 4.1e6, 4150.0, 4180.0], [4000.0; 4]), [(1e3, run())]);
    assert_eq!(found([4200.0, 4.1, 4150.0, 4180.0], [4000.0; 4]), [(1e-3, run())]);
    for (measured, simulated) in [
        ([4200.0, 500.0, 4150.0, 4180.0], [4000.0; 4]),
        ([4200.0, 1000.0, 4150.0, 4180.0], [4000.0, 1.0, 4000.0, 4000.0]),
        ([4200.0, 4.1e6, 4.1e6, 4180.0], [4000.0; 4]),
    ] {
        assert_eq!(found(measured, simulated), [], "{measured:?}");
    }
}

#[test]
fn noise_about_a_level_has_no_gain() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let mut runs = Vec::new();
        for _ in 0..8 {
            // the wheel hardly changes its speed; what is measured is noise
            let level = random.within(20.0, 100.0);
            let simulated = (0..800).map(|k| level + 0.05 * (0.02 * f64::from(k)).sin()).collect();
            let measured = (0..800).map(|_| level + 0.5 * random.normal()).collect();
            runs.push((simulated, measured));
        }
        let [simulated, measured] = channel_of(&runs);
        assert_eq!(faults_against(&measured, &simulated, &["wheel_speed".into()]), [], "{seed}");
    }
}

#[test]
fn a_gain_that_no_parameter_makes_is_a_calibration() {
    let with = |gain: f64| {
        let mut random = Random::new(5);
        let mut runs = Vec::new();
        for i in 0..5 {
            let rate = 0.03 + 0.01 * f64::from(i);
            let simulated: Vec<f64> = (0..800)
                .map(|k| 10.0 + 3.0 * (rate * f64::from(k)).sin() + (0.27 * rate * f64::from(k)).sin())
                .collect();
            let measured = simulated.iter().map(|v| gain * v + 0.1 * random.normal()).collect();
            runs.push((simulated, measured));
        }
        let [simulated, measured] = channel_of(&runs);
        faults_against(&measured, &simulated, &["wheel_speed".into()])
    };
    // no ratio of units is near
    let found = with(2.7);
    assert_eq!(found.iter().map(|f| f.kind).collect::<Vec<_>>(), [FaultKind::WrongUnit], "{found:?}");
    assert!((found[0].value - 2.7).abs() < 0.01 && found[0].runs.len() == 5, "{found:?}");
    // what a sensor or parameters make is left to effects
    assert_eq!(with(1.4), []);
}
