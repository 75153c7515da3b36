//! What the rubber of an element does beyond spring and damper. Sizes are those of one element.

/// A law of the rubber. Forces count as that of the spring: positive pulls the element to the rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rubber {
    /// A second spring \[N/m\] with a dashpot in line, which relaxes in this time \[s\]: a standard linear solid.
    Relaxing(f64, f64),
    /// Chains and filler that slip: three springs with dry friction in line. Forces at which they slip \[N\] add up to the
    /// first number; they slip after a fifth of, once, and four times this way \[m\].
    Friction(f64, f64),
    /// A network of filler \[N/m\], broken down to half at this amplitude \[m\] and built up again within so many
    /// seconds about where the rubber is then.
    Filler(f64, f64, f64),
}

/// Share of the friction and way of each branch.
const BRANCHES: [(f64, f64); 3] = [(0.3, 0.2), (0.4, 1.0), (0.3, 4.0)];

/// What an element remembers of its past.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Past {
    /// Deflection at the end of the last step \[m\].
    last: f64,
    /// Forces of the branches then \[N\].
    branches: [f64; 3],
    /// Highest and lowest deflection of late \[m\].
    high: f64,
    low: f64,
}

impl Past {
    /// At rest for long at this deflection.
    pub(crate) fn at(x: f64) -> Self {
        Self { last: x, branches: [0.0; 3], high: x, low: x }
    }
}

impl Rubber {
    /// Force at a deflection, whose slow part is `slow`.
    pub(crate) fn force(self, x: f64, slow: f64, past: &Past) -> f64 {
        match self {
            Self::Relaxing(stiffness, _) => stiffness * (x - slow),
            Self::Friction(..) => self.branches(x, past).into_iter().sum(),
            Self::Filler(stiffness, half, _) => {
                let amplitude = 0.5 * (past.high.max(x) - past.low.min(x));
                stiffness * (x - slow) / (1.0 + amplitude / half)
            }
        }
    }

    fn branches(self, x: f64, past: &Past) -> [f64; 3] {
        let Self::Friction(force, way) = self else { return [0.0; 3] };
        std::array::from_fn(|k| {
            let (share, slips) = BRANCHES[k];
            let most = share * force;
            (past.branches[k] + most / (slips * way) * (x - past.last)).clamp(-most, most)
        })
    }

    /// Rate of the slow part of the deflection \[m/s\].
    pub(crate) fn slow_rate(self, x: f64, slow: f64) -> f64 {
        match self {
            Self::Relaxing(_, time) | Self::Filler(.., time) => (x - slow) / time,
            Self::Friction(..) => 0.0,
        }
    }

    /// A step has ended at this deflection.
    pub(crate) fn remember(self, x: f64, slow: f64, past: &mut Past, dt: f64) {
        past.branches = self.branches(x, past);
        if let Self::Filler(.., time) = self {
            // broken bonds come back where the rubber is now
            let share = dt / time;
            past.high = x.max(past.high + share * (slow - past.high));
            past.low = x.min(past.low + share * (slow - past.low));
        }
        past.last = x;
    }
}
