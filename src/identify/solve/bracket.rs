//! One unknown: a monotone function between two ends.

/// How a search in one unknown weighs its ends: values of a rising function, or only on which side it has to go on.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value<T> {
    /// The function minus its goal, and what came with it.
    At(f64, T),
    /// As if it were minus infinity: the unknown has to be larger.
    Larger(Vec<super::nested::Beyond>),
    /// As if it were infinity: the unknown has to be smaller.
    Smaller(Vec<super::nested::Beyond>),
}

impl<T> Value<T> {
    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::At(value, _) => Some(*value),
            _ => None,
        }
    }
}

/// Where to look next between two ends: in the middle, or, where both have numbers, nearer to where a line between them meets
/// zero, but never so far from the middle that more steps than those of halving, and one, would be needed. After Oliveira
/// and Takahashi, ACM Transactions on Mathematical Software 47 (2021) 5 (ITP).
pub(in crate::identify) struct Next {
    /// Widths from which on the bracket counts as a point.
    pub width: f64,
    first: f64,
    most: i32,
    step: i32,
}

impl Next {
    pub fn new(range: f64, width: f64) -> Self {
        let halvings = (range / (2.0 * width)).log2().ceil().max(0.0) as i32;
        Self { width, first: range, most: halvings + 1, step: 0 }
    }

    pub fn between(&mut self, [low, high]: [f64; 2], values: [Option<f64>; 2]) -> f64 {
        let (middle, range) = (0.5 * (low + high), high - low);
        let reach = 0.5 * self.width * 2f64.powi(self.most - self.step) - 0.5 * range;
        self.step += 1;
        let [Some(below), Some(above)] = values else { return middle };
        let line = (above * low - below * high) / (above - below);
        // towards the middle, so that the other end moves, too
        let towards = (middle - line).signum();
        let truncation = (0.2 / self.first) * range * range;
        let point = if truncation <= (middle - line).abs() { line + towards * truncation } else { middle };
        let reach = reach.max(0.0);
        if (point - middle).abs() <= reach { point } else { middle - towards * reach }
    }
}
