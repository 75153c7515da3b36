//! Which cases there are, in which order.

use crate::draw::{ids, outside_ids};
use crate::fault::FAULTS;
use crate::flat_track::{self, Concealed};
use crate::random::Random;

/// What a case is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// An effect of the catalogue, several times the noise.
    Clear(&'static str),
    /// An effect of the catalogue below the noise.
    Faint(&'static str),
    /// Two clear effects.
    Mix,
    /// Nothing: the model is right.
    Null,
    /// Nothing but wrong parameters.
    Parameters,
    /// A fault of the recording.
    Fault(&'static str),
    /// An effect that has no name.
    Outside(&'static str),
    /// A wrong effect fits the fitting runs.
    Decoy(usize),
    /// A case of Mack (2009), by number.
    Mack(usize),
    /// A case of the flat track; it counts as [what it is about](Kind::plain).
    FlatTrack(Concealed),
}

impl Kind {
    /// As answers have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.plain() {
            Self::Clear(_) => "clear",
            Self::Faint(_) => "faint",
            Self::Mix => "mix",
            Self::Null => "null",
            Self::Parameters => "parameters",
            Self::Fault(_) => "fault",
            Self::Outside(_) => "outside",
            Self::Decoy(_) => "decoy",
            Self::Mack(_) | Self::FlatTrack(_) => "mack",
        }
    }

    /// The kind of a case without the machine that it is on.
    #[must_use]
    pub fn plain(self) -> Self {
        match self {
            Self::FlatTrack(Concealed::Clear(id)) => Self::Clear(id),
            Self::FlatTrack(Concealed::Faint(id)) => Self::Faint(id),
            Self::FlatTrack(Concealed::Parameters) => Self::Parameters,
            Self::FlatTrack(Concealed::Outside(id)) => Self::Outside(id),
            other => other,
        }
    }
}

/// All cases of the study with this seed, in the order of their numbers.
#[must_use]
pub fn study(seed: u64) -> Vec<Kind> {
    let mut random = Random::new(seed, 0);
    let mut shuffled = |mut list: Vec<&'static str>| {
        random.shuffle(&mut list);
        list
    };
    let (clear, faint, outside) = (shuffled(ids()), shuffled(ids()), shuffled(outside_ids()));
    let mut all: Vec<Kind> = Vec::new();
    all.extend(clear.iter().cycle().take(60).map(|id| Kind::Clear(id)));
    all.extend(faint.iter().cycle().take(60).map(|id| Kind::Faint(id)));
    all.extend([Kind::Mix; 20]);
    all.extend([Kind::Null; 20]);
    all.extend([Kind::Parameters; 40]);
    all.extend(FAULTS.iter().cycle().take(20).map(|name| Kind::Fault(name)));
    all.extend(outside.iter().cycle().take(40).map(|id| Kind::Outside(id)));
    all.extend((0..20).map(Kind::Decoy));
    all.extend([1, 2, 4, 5, 6, 7, 8].map(Kind::Mack));
    random.shuffle(&mut all);
    // behind all others, whose numbers and draws stay what they are
    all.extend(flat_track::draw_cases(&mut random).into_iter().map(Kind::FlatTrack));
    all
}

/// The name of case number `number`, which says nothing about it.
#[must_use]
pub fn name(number: usize) -> String {
    format!("case-{:03}", number + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::family;
    use std::collections::BTreeSet;

    #[test]
    fn holds_what_the_study_asks_for_in_an_order_of_its_own() {
        let all = study(1);
        let count = |name: &str| all.iter().filter(|kind| kind.name() == name).count();
        let counts = ["clear", "faint", "mix", "fault", "outside", "decoy", "mack"].map(count);
        assert_eq!(counts, [60 + 21, 60 + 7, 20, 20, 40 + 7, 20, 7]);
        assert_eq!(count("null") + count("parameters"), 60 + 7);
        // the flat track comes last
        let place = all.iter().position(|k| matches!(k, Kind::FlatTrack(_)));
        assert_eq!((all.len(), place), (287 + 42, Some(287)));
        assert!(all[287..].iter().all(|k| matches!(k, Kind::FlatTrack(_))));
        for kind in ["clear", "faint"] {
            let ids: BTreeSet<_> = all
                .iter()
                .filter(|k| k.name() == kind)
                .filter_map(|k| match k {
                    Kind::Clear(id) | Kind::Faint(id) => Some(*id),
                    _ => None,
                })
                .collect();
            assert!(ids.len() >= 24, "{}", ids.len());
            assert!(ids.iter().all(|id| family(id).is_some()), "{ids:?}");
        }
        assert_eq!(study(1), all);
        assert_ne!(study(2), all);
    }
}
