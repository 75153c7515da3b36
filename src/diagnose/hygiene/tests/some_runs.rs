//! Offsets and delays that only some runs have.

use super::*;

/// Six runs of three sines, one of a single sine, and six of a wheel at rest, `still` its simulated motion, with noise; some come late
/// by samples, some are off.
fn moving_and_at_rest(still: f64, late: &[(usize, i32)], off: &[(usize, f64)]) -> Vec<Fault> {
    let mut random = Random::new(21);
    let runs: Vec<(Vec<f64>, Vec<f64>)> = (0..13)
        .map(|i| {
            let rate = 0.02 + 0.003 * f64::from(i);
            let course = |k: i32| {
                let phase = rate * f64::from(k);
                match i {
                    0..6 => 3.0 * phase.sin() + 2.0 * (2.7 * phase).sin() + (6.1 * phase).sin(),
                    6 => 3.0 * phase.sin(),
                    _ => still * (0.7 * phase).sin(),
                }
            };
            let number = |list: &[(usize, i32)]| list.iter().find(|l| l.0 == i as usize).map_or(0, |l| l.1);
            let by = off.iter().find(|o| o.0 == i as usize).map_or(0.0, |o| o.1);
            let measured = (0..900).map(|k| course(k - number(late)) + by + 0.1 * random.normal()).collect();
            ((0..900).map(course).collect(), measured)
        })
        .collect();
    let [simulated, measured] = channel_of(&runs);
    faults_against(&measured, &simulated, &["wheel_speed".into()])
}

#[test]
fn runs_at_rest_tell_an_offset_and_no_delay() {
    for still in [0.0, 1e-9] {
        assert_eq!(moving_and_at_rest(still, &[], &[]), []);
        let [offset] = &moving_and_at_rest(still, &[], &[(2, -1.5), (8, -1.5), (11, -1.5)])[..] else {
            panic!("{still}")
        };
        assert_eq!(offset.kind, FaultKind::OffsetInSomeRuns);
        assert_eq!(offset.runs, ["run-2.csv", "run-8.csv", "run-11.csv"]);
        assert!((offset.value + 1.5).abs() < 0.02, "{}", offset.value);
        let [delay] = &moving_and_at_rest(still, &[(1, 6), (4, 6)], &[])[..] else { panic!("{still}") };
        assert_eq!(delay.kind, FaultKind::DelayInSomeRuns);
        assert_eq!(delay.runs, ["run-1.csv", "run-4.csv"]);
        assert!((delay.value - 0.06).abs() < 0.003, "{}", delay.value);
    }
}

#[test]
fn a_single_sine_has_a_delay_only_with_others() {
    // by itself it is a phase, which a wrong parameter makes as well
    assert_eq!(moving_and_at_rest(0.0, &[(6, 6)], &[]), []);
    for other in [1, 5] {
        let [delay] = &moving_and_at_rest(0.0, &[(other, 6), (6, 6)], &[])[..] else { panic!("{other}") };
        assert_eq!(delay.runs, [format!("run-{other}.csv"), "run-6.csv".into()]);
    }
}
