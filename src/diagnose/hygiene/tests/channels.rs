//! Channels that are exchanged, and inputs that are reversed.

use super::*;

/// Runs with an input, and two outputs of it with noise: one moves by a hundred times its noise, the other by one and a half.
fn strong_and_weak() -> Case {
    let mut random = Random::new(9);
    let mut case =
        Case { measured: Vec::new(), simulated: Vec::new(), channels: vec!["strong".into(), "weak".into()] };
    for run in 0..6 {
        let time: Vec<f64> = (0..600).map(|k| 0.02 * f64::from(k)).collect();
        let drive: Vec<f64> =
            time.iter().map(|t| (t * (1.0 + 0.3 * f64::from(run))).sin() + (2.7 * t).sin()).collect();
        let slow: Vec<f64> = time.iter().map(|t| 1.5 * (0.8 * t + f64::from(run)).cos()).collect();
        let recording = |outputs: [Vec<f64>; 2]| Recording {
            time: time.clone(),
            channels: [("drive", drive.clone())]
                .into_iter()
                .chain(["strong", "weak"].into_iter().zip(outputs))
                .map(|(name, values)| Channel { name: name.into(), unit: "N.m".into(), values })
                .collect(),
            source: format!("rig/run{run}.csv"),
        };
        let strong: Vec<f64> = drive.iter().map(|d| 100.0 * d).collect();
        case.simulated.push(recording([strong.clone(), slow.clone()]));
        let mut noisy = |values: &[f64]| values.iter().map(|v| v + random.normal()).collect::<Vec<f64>>();
        case.measured.push(recording([noisy(&strong), noisy(&slow)]));
    }
    case
}

#[test]
fn channels_are_exchanged_in_one_run_though_one_of_them_hardly_moves() {
    let mut case = strong_and_weak();
    assert!(faults(&case).is_empty());
    let taken = std::mem::take(values(&mut case.measured[4], "strong"));
    let given = std::mem::replace(values(&mut case.measured[4], "weak"), taken);
    *values(&mut case.measured[4], "strong") = given;
    let [fault] = &faults(&case)[..] else { panic!("{:?}", faults(&case)) };
    assert_eq!((fault.kind, &fault.runs[..]), (FaultKind::SwappedChannels, &["run4.csv".to_owned()][..]));
}

#[test]
fn a_reversed_input_is_not_as_many_reversed_sensors() {
    for runs in [0..6, 2..3] {
        let mut case = strong_and_weak();
        // two outputs that tell signs
        for recording in &mut case.measured {
            let mut random = Random::new(4);
            let strong = values(recording, "strong").clone();
            *values(recording, "weak") = strong.iter().map(|v| 0.1 * v + random.normal()).collect();
        }
        for recording in &mut case.simulated {
            let strong = values(recording, "strong").clone();
            *values(recording, "weak") = strong.iter().map(|v| 0.1 * v).collect();
        }
        for recording in &mut case.measured[runs.clone()] {
            for name in ["strong", "weak"] {
                values(recording, name).iter_mut().for_each(|v| *v = -*v);
            }
        }
        let [fault] = &faults(&case)[..] else { panic!("{:?}", faults(&case)) };
        assert_eq!((fault.kind, fault.channel.as_deref()), (FaultKind::WrongSign, Some("drive")));
        assert_eq!(fault.runs.len(), runs.len());
    }
}

#[test]
fn an_exchanged_channel_may_rest_altogether() {
    let mut case = strong_and_weak();
    let mut random = Random::new(11);
    values(&mut case.simulated[4], "weak").fill(0.0);
    values(&mut case.measured[4], "weak").iter_mut().for_each(|v| *v = random.normal());
    assert!(faults(&case).is_empty());
    let taken = std::mem::take(values(&mut case.measured[4], "strong"));
    let given = std::mem::replace(values(&mut case.measured[4], "weak"), taken);
    *values(&mut case.measured[4], "strong") = given;
    let [fault] = &faults(&case)[..] else { panic!("{:?}", faults(&case)) };
    assert_eq!((fault.kind, &fault.runs[..]), (FaultKind::SwappedChannels, &["run4.csv".to_owned()][..]));
}
