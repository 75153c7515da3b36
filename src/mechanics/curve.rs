//! A force over a speed or a way, as points with straight lines between them.

use crate::{Error, Result, clone_in_place};
use serde::{Deserialize, Serialize};

/// Points \[x, y\] with rising x, and the first and last line on beyond them.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Curve {
    points: Vec<[f64; 2]>,
}

clone_in_place!(Curve { points });

impl Curve {
    /// A curve through points; `name` is the parameter that has them.
    ///
    /// # Errors
    /// Fewer than two of them, or an x that does not rise.
    pub fn new(name: &str, points: Vec<[f64; 2]>) -> Result<Self> {
        if points.len() < 2 {
            return Err(Error::variable(format!("{name} needs two points at least")));
        }
        if let Some(at) = points.windows(2).position(|pair| pair[0][0] >= pair[1][0]) {
            return Err(Error::variable(format!(
                "{name}: {} stands behind {}, and has to be larger",
                points[at + 1][0],
                points[at][0]
            )));
        }
        Ok(Self { points })
    }

    /// y at an x.
    pub fn at(&self, x: f64) -> f64 {
        let [a, b] = self.line(x);
        a[1] + (b[1] - a[1]) * ((x - a[0]) / (b[0] - a[0]))
    }

    /// The largest slope.
    pub fn steepest(&self) -> f64 {
        self.points.windows(2).map(|p| (p[1][1] - p[0][1]) / (p[1][0] - p[0][0])).fold(0.0, f64::max)
    }

    /// True if it can have been made by [`new`](Self::new).
    pub fn is_whole(&self) -> bool {
        self.points.len() >= 2 && self.points.windows(2).all(|pair| pair[0][0] < pair[1][0])
    }

    fn line(&self, x: f64) -> [[f64; 2]; 2] {
        let last = self.points.len() - 2;
        let at = (1..=last).take_while(|i| self.points[*i][0] <= x).count();
        [self.points[at], self.points[at + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_go_through_the_points_and_on() {
        let curve = Curve::new("damper", vec![[-1.0, -3.0], [0.0, 0.0], [0.5, 4.0], [1.0, 5.0]]).unwrap();
        for (x, y) in [
            (-2.0, -6.0),
            (-1.0, -3.0),
            (-0.5, -1.5),
            (0.0, 0.0),
            (0.25, 2.0),
            (0.5, 4.0),
            (0.75, 4.5),
            (2.0, 7.0),
        ] {
            assert!((curve.at(x) - y).abs() < 1e-12, "{x}: {}", curve.at(x));
        }
        assert_eq!(curve.steepest(), 8.0);
        let error = Curve::new("damper", vec![[0.0, 0.0], [0.0, 1.0]]).unwrap_err().to_string();
        assert!(error.contains("0 stands behind 0"), "{error}");
    }
}
