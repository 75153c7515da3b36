//! Cases of sessions as they are drawn.

use super::case::{Drawn, case, study};
use super::offers::Offer;
use super::parameters::Parameters;
use super::programme::RUNS;
use super::session::{COARSE, FINE, FORCES, World};
use crate::machines::Kind;
use crate::random::Random;
use crate::sizing::strongest;

const SEED: u64 = 1;

fn first(kind: Kind) -> usize {
    study(SEED).iter().position(|(k, ..)| *k == kind).unwrap()
}

/// Columns of a CSV file.
fn columns(text: &str) -> Vec<Vec<f64>> {
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    (0..rows[0].len()).map(|c| rows.iter().map(|row| row[c]).collect()).collect()
}

/// The tire that a `parameters.toml` tells.
fn told(toml: &str) -> Parameters {
    let mut tire = Parameters::default();
    let mut count = 0;
    for (name, value) in toml.lines().filter_map(|line| line.split_once(" = ")) {
        count += usize::from(value.parse().is_ok_and(|value| tire.set(name, value)));
    }
    assert_eq!(count, 34);
    tire
}

#[test]
fn a_study_has_its_kinds_and_deals_every_effect() {
    let study = study(SEED);
    assert_eq!(study.len(), 64);
    let mut clear: Vec<_> =
        study.iter().filter(|(k, ..)| *k == Kind::Clear).map(|(_, o, _)| o[0].id()).collect();
    clear.sort_unstable();
    clear.dedup();
    assert!(clear.len() >= 13, "{clear:?}");
    assert_ne!(study, super::case::study(SEED + 1));
}

#[test]
fn true_parameters_of_a_null_leave_noise_alone() {
    let number = first(Kind::Null);
    let recorded = case(SEED, number).unwrap();
    let file = |name: &str| &recorded.files.iter().find(|(n, _)| n == name).unwrap().1;
    assert!(
        file("recordings/runs.toml").matches("check").count() == 3
            && file("model") == "ring-brush-flat-track\n"
    );
    let world = World { tire: told(file("parameters.toml")), concealed: Vec::new() };
    let mut random = Random::new(SEED, 1 + number as u64);
    let (drawn, ..) = Drawn::bare(Kind::Null, &mut random, |_| true);
    // drawn again it is the same tire, and the runs below are the same ones: the first half of them, as each takes seconds
    assert_eq!(world.tire, drawn.world.tire);
    let session = world.session(&drawn.runs[..RUNS / 2], FINE);
    for c in 0..FORCES {
        let (mut square, mut count) = (0.0, 0.0);
        for (run, ideal) in session.iter().enumerate() {
            let recorded = &columns(file(&format!("recordings/run-{:02}.csv", run + 1)))[7 + c];
            assert_eq!(recorded.len(), ideal.outputs[c].len());
            square += recorded
                .iter()
                .zip(&ideal.outputs[c])
                .map(|(r, v)| (r - v - drawn.offsets[c]) * (r - v - drawn.offsets[c]))
                .sum::<f64>();
            count += recorded.len() as f64;
        }
        // strongly coloured noise of some five thousand samples
        let rms = (square / count).sqrt() / drawn.noise[c].deviation;
        assert!((rms - 1.0).abs() < 0.06, "channel {c}: {rms}");
    }
}

#[test]
fn what_is_concealed_leaves_what_is_wanted() {
    // a sweep and a run of many things: enough for these effects to be seen
    let mut random = Random::new(SEED, 1);
    let (mut drawn, few, bare) = Drawn::bare(Kind::Plain, &mut random, |run| [3, 11].contains(&run));
    let offers = [Offer::Imbalance, Offer::Softening];
    drawn.conceal(&offers, (&few, &bare), &mut random).unwrap();
    // all samples with a step as in recordings tell the same as some of them
    let nominal = World { concealed: Vec::new(), ..drawn.world.clone() }.session(&drawn.runs, FINE);
    let refit = drawn.refit(&few, &bare);
    assert_eq!(drawn.marks.len(), 2);
    for (one, (offer, left)) in drawn.world.concealed.iter().zip(&drawn.marks) {
        let (said, order) = strongest(left);
        assert!((1.3..2.7).contains(&said), "{offer:?}: {said}");
        let world = World { concealed: vec![one.clone()], ..drawn.world.clone() };
        let again = refit.left(&drawn.flat(&world.session(&few, COARSE)), FORCES);
        assert!((strongest(&again).0 / said - 1.0).abs() < 1e-9);
        // a refit takes a part of it away
        let session = world.session(&drawn.runs, FINE);
        let (with, without) = (drawn.flat(&session), drawn.flat(&nominal));
        let own = || with.iter().zip(&without).skip(order[0]).step_by(FORCES).map(|(a, b)| (a - b) * (a - b));
        let rms = (own().sum::<f64>() / own().count() as f64).sqrt();
        assert!(rms > 0.97 * said, "{offer:?}: {rms} {said}");
    }
}
