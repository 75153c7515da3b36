//! What can be concealed on the flat track, and which cases of it a study has.

use crate::draw::{Offer, offer};
use crate::hidden::Law;
use crate::random::Random;

/// What a case of the flat track is about: kinds of the study on this machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Concealed {
    /// An effect of the catalogue, several times the noise.
    Clear(&'static str),
    /// An effect of the catalogue below the noise.
    Faint(&'static str),
    /// Nothing but wrong parameters.
    Parameters,
    /// An effect that has no name.
    Outside(&'static str),
}

const fn here(
    id: &'static str,
    law: Law,
    channels: &'static [usize],
    signed: bool,
    depends_on: &'static [&'static str],
) -> Offer {
    offer(id, law, crate::base::Base::FlatTrack, channels, signed, depends_on)
}

const TIME: &[&str] = &["time"];

/// Effects of the catalogue; on the way in, the channel is that of the slip angle.
pub(crate) const OFFERS: [Offer; 7] = [
    here("plysteer", Law::SideSlip, &[1], true, &["load", "slip_angle"]),
    here("relaxation-length", Law::Relaxation, &[2], false, &["path_speed", "slip_angle"]),
    here("thermal-softening", Law::Thermal, &[1], false, &["contact_power_loss", "time"]),
    here("speed-dependent-friction", Law::SpeedFriction, &[1], false, &["path_speed"]),
    here("sensor-delay", Law::Delay, &[0, 1], false, TIME),
    here("sensor-drift", Law::Drift, &[0, 1, 2], true, TIME),
    here("cross-talk", Law::CrossTalk, &[0, 2], true, &["force_y"]),
];

/// How many of them are of the tire; the rest are of rig and sensors.
const OF_TIRE: usize = 4;

/// Effects that are in no catalogue: a friction of the belt that changes with time, evenly or by chance.
pub(crate) const OUTSIDE: [Offer; 2] = [
    here("outside-time-friction", Law::TimeFriction, &[1], false, TIME),
    here("outside-patch-friction", Law::PatchFriction, &[1], false, TIME),
];

/// In how many rounds the cases of a study are drawn: for at least 40 of them.
const ROUNDS: usize = 7;

/// The cases of a study. A round has three clear effects, two of them of the tire, a faint one of the tire, one case of
/// wrong parameters and one outside of the catalogue.
#[must_use]
pub fn draw_cases(random: &mut Random) -> Vec<Concealed> {
    let mut all = Vec::new();
    for _ in 0..ROUNDS {
        let (mut tire, mut rig) = ([0, 1, 2, 3], [0, 1, 2]);
        random.shuffle(&mut tire);
        random.shuffle(&mut rig);
        all.extend([
            Concealed::Clear(OFFERS[tire[0]].id),
            Concealed::Clear(OFFERS[tire[1]].id),
            Concealed::Clear(OFFERS[OF_TIRE + rig[0]].id),
            Concealed::Faint(OFFERS[tire[2]].id),
            Concealed::Parameters,
            Concealed::Outside(random.pick(&OUTSIDE).id),
        ]);
    }
    random.shuffle(&mut all);
    all
}
