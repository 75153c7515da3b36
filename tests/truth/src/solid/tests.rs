//! Cases as they are drawn.

use super::case::{Drawn, case, study};
use super::concealed::{OFFERS, Offer};
use super::parameters::Rig;
use super::world::{COARSE, FINE, World};
use crate::machines::Kind;
use crate::random::Random;
use crate::simulate::Ideal;
use crate::sizing::strongest;

const SEED: u64 = 1;

/// rms of the differences per channel, over the noise.
fn differ(drawn: &Drawn, a: &[Ideal], b: &[Ideal]) -> Vec<f64> {
    let channels = drawn.noise.len();
    let (a, b) = (drawn.flat(a), drawn.flat(b));
    let of = |c: usize| {
        let own = || a.iter().zip(&b).skip(c).step_by(channels).map(|(a, b)| (a - b) * (a - b));
        (own().sum::<f64>() / own().count() as f64).sqrt()
    };
    (0..channels).map(of).collect()
}

#[test]
fn a_study_has_every_effect_once_and_two_cases_without() {
    for seed in 1..20 {
        let study = study(seed);
        assert_eq!(study.len(), 10);
        assert!(OFFERS.iter().all(|o| study.iter().filter(|(_, offer)| *offer == Some(*o)).count() == 1));
        assert!(study.contains(&(Kind::Null, None)) && study.contains(&(Kind::Parameters, None)));
        assert!(study.contains(&(Kind::Plain, Some(Offer::Play))));
    }
    assert!((2..20).any(|seed| study(seed) != study(SEED)));
}

#[test]
fn shorter_steps_make_no_other_recording() {
    for (rig, run) in [(Rig::Force, 5), (Rig::Position, 6), (Rig::Drum, 2)] {
        let mut random = Random::new(SEED, 7);
        let drawn = Drawn::bare(Kind::Null, rig, &mut random, |k| k == run);
        let session = |dt: f64| drawn.world.session(&drawn.runs, dt);
        let fine = session(FINE);
        let half = differ(&drawn, &session(0.5 * FINE), &fine);
        let coarse = differ(&drawn, &session(COARSE), &fine);
        assert!(half.iter().all(|d| *d < 1e-3), "{rig:?}: {half:?}");
        assert!(coarse.iter().all(|d| *d < 0.1), "{rig:?}: {coarse:?}");
    }
}

#[test]
fn what_is_concealed_leaves_what_is_wanted() {
    for (offer, rig) in [(Offer::Relaxation, Rig::Force), (Offer::NonUniformity, Rig::Drum)] {
        let mut random = Random::new(SEED, 3);
        let mut drawn = Drawn::bare(Kind::Plain, rig, &mut random, |k| [0, 2].contains(&k));
        let nominal = drawn.world.session(&drawn.runs, FINE);
        drawn.conceal(offer, &mut random).unwrap();
        let (_, left) = drawn.mark.clone().unwrap();
        let (said, _) = strongest(&left);
        assert!((1.3..2.7).contains(&said), "{offer:?}: {said}");
        // a refit takes a part of it away
        let whole = differ(&drawn, &drawn.world.session(&drawn.runs, FINE), &nominal);
        assert!(whole[0] > 0.95 * said, "{offer:?}: {whole:?} {said}");
        let without = World { concealed: None, ..drawn.world.clone() };
        assert_eq!(without.session(&drawn.runs, FINE), nominal);
    }
}

#[test]
fn a_case_is_the_same_each_time_and_says_what_may_be_fitted() {
    let number = study(SEED).iter().position(|(kind, _)| *kind == Kind::Null).unwrap();
    let recorded = case(SEED, number).unwrap();
    assert_eq!(recorded.files, case(SEED, number).unwrap().files);
    let file = |name: &str| &recorded.files.iter().find(|(n, _)| n == name).unwrap().1;
    assert!(file("recordings/runs.toml").matches("check").count() == 2);
    assert!(file("parameters.toml").contains("[fit]\nelement_radial_stiffness = true\n"));
    assert!(recorded.answer.parameters.iter().all(|p| (p.start - p.value).abs() < 1e-12));
}
