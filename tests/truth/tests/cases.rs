//! Cases as they are written: the same bytes from the same seed, plausible recordings, effects of the size that they claim.
#![allow(clippy::unwrap_used, clippy::panic)]

use latsch_truth::draw::draw;
use latsch_truth::files::case;
use latsch_truth::recording::record;
use latsch_truth::simulate::{STEP, World};
use latsch_truth::study::{Kind, name, study};

const SEED: u64 = 1;

fn first(wanted: impl Fn(&Kind) -> bool) -> usize {
    study(SEED).iter().position(wanted).unwrap()
}

/// Fowler, Noll and Vo: enough to notice a changed byte.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

fn columns(csv: &str) -> Vec<Vec<f64>> {
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    (0..rows[0].len()).map(|c| rows.iter().map(|row| row[c]).collect()).collect()
}

#[test]
fn a_seed_gives_the_same_bytes_and_another_one_others() {
    let number = first(|k| matches!(k, Kind::Clear(_)));
    let (one, two) = (case(SEED, number).unwrap(), case(SEED, number).unwrap());
    assert_eq!(one.files, two.files);
    assert_eq!(one.answer, two.answer);
    assert_ne!(one.files, case(SEED + 1, number).unwrap().files);
}

#[test]
fn recordings_are_what_they_shall_be() {
    for number in 0..4 {
        let recorded = case(SEED, number).unwrap();
        let csv: Vec<_> = recorded.files.iter().filter(|(name, _)| name.ends_with(".csv")).collect();
        assert!((5..=20).contains(&csv.len()));
        let bytes: usize = csv.iter().map(|(_, text)| text.len()).sum();
        assert!((150_000..1_200_000).contains(&bytes), "{bytes}");
        for (name, text) in csv {
            assert!(text.starts_with("time [s],"), "{name}");
            let columns = columns(text);
            if !matches!(study(SEED)[number], Kind::Fault(_)) {
                assert!(columns[0].windows(2).all(|w| w[1] > w[0]), "{name}");
            }
            assert!(columns.iter().flatten().all(|v| v.is_finite()));
            assert!(columns[0].len() >= 150);
        }
        // nothing of the answer is in what the diagnosis sees
        let seen: String = recorded.files.iter().map(|(name, text)| name.clone() + text).collect();
        for effect in &recorded.answer.effects {
            assert!(!seen.contains(&effect.id));
        }
    }
}

#[test]
fn what_is_recorded_is_the_truth_with_noise_of_the_size_that_was_drawn() {
    let case = draw(SEED, first(|k| matches!(k, Kind::Parameters))).unwrap();
    let recorded = record(&case);
    let inputs = case.world.base.inputs().len();
    for (c, noise) in case.noise.iter().enumerate() {
        let (mut square, mut stamped, mut count) = (0.0, 0.0, 0.0);
        for (number, run) in (0_u64..).zip(&case.runs) {
            let name = format!("recordings/run-{:02}.csv", number + 1);
            let text = &recorded.files.iter().find(|(n, _)| *n == name).unwrap().1;
            let ideal = case.world.run(run, number, STEP);
            let column = &columns(text)[1 + inputs + c];
            square += column.iter().zip(&ideal.outputs[c]).map(|(r, v)| (r - v) * (r - v)).sum::<f64>();
            count += column.len() as f64;
            // the reference takes the time stamps as they are recorded: straight between the true samples
            let (stamps, values) = (&columns(text)[0], &ideal.outputs[c]);
            stamped += stamps
                .iter()
                .zip(column)
                .map(|(t, r)| {
                    let k = run.time.partition_point(|s| s < t).clamp(1, run.time.len() - 1);
                    let slope = (values[k] - values[k - 1]) / (run.time[k] - run.time[k - 1]);
                    (r - values[k - 1] - slope * (t - run.time[k - 1])).powi(2)
                })
                .sum::<f64>();
        }
        let measured = (square / count).sqrt();
        assert!(
            (measured / noise.deviation - 1.0).abs() < 0.12,
            "channel {c}: {measured} for {}",
            noise.deviation
        );
        let floor: f64 =
            recorded.reference.runs.iter().map(|r| r.channels[c].1 * r.samples as f64).sum::<f64>() / count;
        assert!((floor / stamped * count - 1.0).abs() < 1e-9, "channel {c}");
    }
}

#[test]
fn clear_effects_stand_out_and_faint_ones_do_not() {
    for (kind, low, high) in [("clear", 2.9, 8.5), ("faint", 0.25, 1.3), ("outside", 2.9, 8.5)] {
        let numbers: Vec<usize> = study(SEED)
            .iter()
            .enumerate()
            .filter(|(_, k)| k.name() == kind)
            .map(|(n, _)| n)
            .take(3)
            .collect();
        for number in numbers {
            let case = draw(SEED, number).unwrap();
            let size = case.marks[0].1.iter().copied().fold(0.0, f64::max);
            assert!((low..high).contains(&size), "{:?}: {size}", case.kind);
            // and it does change the recording, beyond what the deviation of the parameters does
            let without = World { hidden: vec![], ..case.world.clone() };
            let (a, b) = (case.world.run(&case.runs[0], 0, STEP), without.run(&case.runs[0], 0, STEP));
            assert_eq!(a.inputs, b.inputs);
        }
    }
}

#[test]
fn cases_before_those_of_the_flat_track_are_what_they_were_without_them() {
    // kinds and files as they were drawn before there was a flat track
    let kinds = study(7).into_iter().enumerate().take(287);
    let list: String = kinds.map(|(n, kind)| format!("{} {kind:?}\n", name(n))).collect();
    assert_eq!(hash(&list), 0x8b73_dabc_d3ea_612a, "{:#x}", hash(&list));
    for (number, expected) in [(0, 0x887d_139e_b1cf_7161), (286, 0x3085_8758_e552_2a6d)] {
        let text: String = case(SEED, number).unwrap().files.into_iter().map(|(_, text)| text).collect();
        assert_eq!(hash(&text), expected, "{number}: {:#x}", hash(&text));
    }
}

/// The sources that are compiled into the generator.
fn sources(folder: &std::path::Path) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(sources(&path));
        } else {
            all.push((path.display().to_string(), std::fs::read_to_string(&path).unwrap()));
        }
    }
    all
}

#[test]
fn of_latsch_only_the_tire_of_the_flat_track_is_used() {
    let all = sources(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let (mut used, mut seen) = (0, 0);
    for (file, text) in all {
        seen += 1;
        for line in text.lines().filter(|line| line.contains("latsch::")) {
            let allowed = ["Result;", "model::{Native, Settings, Slave};", "rig::RingBrushFlatTrack;"];
            let fits = allowed.iter().any(|what| line == format!("use latsch::{what}"));
            assert!(fits && file.contains("flat_track"), "{file}: {line}");
            used += 1;
        }
    }
    assert!(seen > 15 && used >= 3, "{seen} {used}");
}

#[test]
fn the_bytes_of_a_case_do_not_depend_on_the_machine() {
    // found on x86-64; another machine has to get them too
    let number = first(|k| matches!(k, Kind::Mack(1)));
    let text: String = case(SEED, number).unwrap().files.into_iter().map(|(_, text)| text).collect();
    assert_eq!(hash(&text), 0x9c63_8d63_16b0_c7ac, "{:#x}", hash(&text));
}
