//! Stretches of a recording in which the rig holds everything, and whether the tire has come to rest there.

use crate::stats::{even_line, mean, median, median_interval, redundancy};
use std::ops::Range;
use std::sync::OnceLock;

/// Recordings are looked at in pieces of this length \[s\]: a tire at walking pace and above settles within a few of them.
const PIECE: f64 = 0.1;
/// of at least so many samples.
const LEAST: usize = 4;
/// What is held for less than so many pieces is none.
const PIECES: usize = 6;
/// Means of noise differ by more than so many standard errors once in 15,000.
const SIDE: f64 = 4.0;
/// A response that changes by less than this share of its range in all recordings is taken for steady: without noise, the end of
/// an exponential is never reached.
const STEADY: f64 = 5e-4;

/// An interval this many times the usual one is a gap: a lost sample or two make 2 or 3, and a mean hardly feels them.
const GAP: f64 = 5.0;

/// So many samples are a piece.
pub fn piece_length(time: &[f64]) -> usize {
    ((PIECE / median_interval(time)).round() as usize).max(LEAST)
}

/// The samples between gaps.
pub fn sections(time: &[f64]) -> Vec<Range<usize>> {
    let longest = GAP * median_interval(time);
    let ends = (1..time.len()).filter(|k| time[*k] - time[k - 1] > longest).chain([time.len()]);
    let mut from = 0;
    ends.map(|to| std::mem::replace(&mut from, to)..to).collect()
}

/// A channel of a recording, and what scatters in it, which is found once, when it is asked for.
#[derive(Clone)]
pub struct Sampled {
    values: Vec<f64>,
    /// So many samples are a piece.
    piece: usize,
    noise: OnceLock<Noise>,
}

impl Sampled {
    /// One with these values, of which so many are a piece.
    pub fn new(values: Vec<f64>, piece: usize) -> Self {
        Self { values, piece, noise: OnceLock::new() }
    }

    /// Its values.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// What scatters in it.
    pub fn noise(&self) -> &Noise {
        self.noise.get_or_init(|| Noise::of(&self.values, self.piece))
    }

    /// Replaces each value, and forgets what scattered.
    pub fn change(&mut self, of: impl Fn(f64) -> f64) {
        self.values.iter_mut().for_each(|value| *value = of(*value));
        self.noise.take();
    }
}

/// A channel that tells whether something moves.
pub struct Watched<'a> {
    /// It.
    pub channel: &'a Sampled,
    /// By how much it may change while it is held; `None` for a response.
    pub held_within: Option<f64>,
    /// Its range in all recordings.
    pub range: f64,
}

/// A stretch of samples in which all that is held stays where it is. Of these, the second half is meant.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// First sample, and the one after the last.
    pub samples: [usize; 2],
    /// Mean of each channel.
    pub means: Vec<f64>,
    /// Standard error of it, from what scatters within the stretch.
    pub errors: Vec<f64>,
    /// The response that moves most, if one does, by number.
    pub moving: Option<usize>,
}

/// All stretches of a recording; none goes over a gap.
pub fn stretches(time: &[f64], channels: &[Watched<'_>]) -> Vec<Stretch> {
    if time.len() < LEAST {
        return Vec::new();
    }
    let length = piece_length(time);
    let within = |section: Range<usize>| between_gaps(section, length, channels);
    sections(time).into_iter().flat_map(within).collect()
}

/// The stretches of samples between two gaps, with pieces of `length` samples.
fn between_gaps(section: Range<usize>, length: usize, channels: &[Watched<'_>]) -> Vec<Stretch> {
    let pieces = section.len() / length;
    let sample = |piece: usize| section.start + piece * length;
    let of = |channel: &Sampled, piece: usize| mean(&channel.values[sample(piece)..sample(piece + 1)]);
    let mut found = Vec::new();
    let mut from = 0;
    while from < pieces {
        // as long as all that is held stays within its tolerance of where it was
        let stays = |piece: usize| {
            channels.iter().all(|Watched { channel, held_within, .. }| {
                held_within.is_none_or(|tolerance| {
                    let change = of(channel, piece) - of(channel, from);
                    change.abs() <= tolerance + SIDE * 2f64.sqrt() * channel.noise().error(length)
                })
            })
        };
        let to = (from..pieces).find(|piece| !stays(*piece)).unwrap_or(pieces);
        // a move that begins in a piece may not show in its mean
        let end = if to < pieces { to - 1 } else { to };
        if end - from >= PIECES {
            found.push(second_half(sample(from), sample(end), channels));
        }
        from = to.max(from + 1);
    }
    found
}

fn second_half(from: usize, to: usize, channels: &[Watched<'_>]) -> Stretch {
    let from = from + (to - from) / 2;
    let middle = from + (to - from) / 2;
    let (mut moving, mut most) = (None, 1.0);
    for (number, Watched { channel, held_within, range }) in channels.iter().enumerate() {
        let change = mean(&channel.values[middle..to]) - mean(&channel.values[from..middle]);
        let allowed = STEADY * range + SIDE * 2f64.sqrt() * channel.noise().error(to - middle);
        if held_within.is_none() && change.abs() > most * allowed {
            (moving, most) = (Some(number), change.abs() / allowed);
        }
    }
    Stretch {
        samples: [from, to],
        means: channels.iter().map(|c| mean(&c.channel.values[from..to])).collect(),
        errors: channels.iter().map(|c| c.channel.noise().error(to - from)).collect(),
        moving,
    }
}

/// What scatters within pieces of a channel.
#[derive(Clone)]
pub struct Noise {
    deviation: f64,
    /// So many samples tell as much as one.
    redundancy: f64,
}

impl Noise {
    /// Of a channel, in pieces of so many samples.
    fn of(values: &[f64], length: usize) -> Self {
        let pieces: Vec<Vec<f64>> = values.chunks_exact(length).map(about_line).collect();
        let size = |piece: &Vec<f64>| (piece.iter().map(|v| v * v).sum::<f64>() / (length - 2) as f64).sqrt();
        let deviation = median(&pieces.iter().map(size).collect::<Vec<_>>());
        // pieces in which something moves are no noise
        let typical = pieces.iter().filter(|piece| size(piece) <= 2.0 * deviation);
        let shares: Vec<f64> = typical.map(|piece| redundancy(piece)).collect();
        Self { deviation, redundancy: median(&shares).max(1.0) }
    }

    /// Standard error of a mean of so many samples.
    pub fn error(&self, samples: usize) -> f64 {
        self.deviation * (self.redundancy / samples as f64).sqrt().min(1.0)
    }
}

/// A piece less its line.
fn about_line(piece: &[f64]) -> Vec<f64> {
    let (level, slope) = even_line(piece);
    piece.iter().enumerate().map(|(k, v)| v - level - slope * k as f64).collect()
}
