//! Cases as they are drawn.

use super::case::{Drawn, case, study};
use super::concealed::{Concealed, Law, OFFERS, Offer};
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
        let list: Vec<f64> =
            a.iter().zip(&b).skip(c).step_by(channels).map(|(a, b)| (a - b) * (a - b)).collect();
        (list.iter().sum::<f64>() / list.len() as f64).sqrt()
    };
    (0..channels).map(of).collect()
}

#[test]
fn shorter_steps_make_no_other_recording() {
    for (rig, run) in [(Rig::Force, 5), (Rig::Position, 8), (Rig::Drum, 3)] {
        let mut random = Random::new(SEED, 7);
        let drawn = Drawn::bare(Kind::Null, rig, &mut random, |k| k == run);
        let session = |dt: f64| drawn.world.session(&drawn.runs, dt);
        let fine = session(FINE);
        let (half, coarse) =
            (differ(&drawn, &session(0.5 * FINE), &fine), differ(&drawn, &session(COARSE), &fine));
        println!("{rig:?}: {half:?} {coarse:?}");
        let pivot = World {
            concealed: Some(Concealed { law: Law::PivotFriction, size: 0.08 }),
            ..drawn.world.clone()
        };
        println!("{:?}", differ(&drawn, &pivot.session(&drawn.runs, FINE), &fine));
        println!("{:?}", differ(&drawn, &pivot.session(&drawn.runs, COARSE), &session(COARSE)));
        println!("noise {:?}", drawn.noise.iter().map(|n| n.deviation).collect::<Vec<_>>());
    }
}
