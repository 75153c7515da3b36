//! A force over a speed or a way, as points with straight lines between them.

use crate::{Error, Result, clone_in_place};
use serde::{Deserialize, Serialize};

/// Points \[x, y\] with rising x, and the first and last line on beyond them.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Curve {
    points: Vec<[f64; 2]>,
}

clone_in_place!(Curve { points });

/// What rounding may leave of a line through 0, over the largest value.
const ROUNDING: f64 = 1e-9;

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

    /// Checks that a force over a speed takes energy at every speed; `name` is the parameter.
    ///
    /// # Errors
    /// It is not 0 at 0, or gives energy somewhere.
    pub fn check_resists(&self, name: &str) -> Result<()> {
        let largest = self.points.iter().fold(0.0, |most: f64, [_, y]| most.max(y.abs()));
        if self.at(0.0).abs() > ROUNDING * largest {
            return Err(Error::variable(format!(
                "{name}: at speed 0 the force has to be 0, and is {} N: give it a point '0 0'",
                self.at(0.0)
            )));
        }
        if let Some([x, y]) = self.points.iter().find(|[x, y]| x * y < 0.0) {
            return Err(Error::variable(format!(
                "{name}: at {x} m/s a force of {y} N pushes the way that it moves, and makes energy: both have to have the same sign"
            )));
        }
        let last = self.points.len() - 1;
        let ends = [[self.points[0], self.points[1]], [self.points[last - 1], self.points[last]]];
        match ends.iter().any(|[a, b]| b[1] < a[1]) {
            false => Ok(()),
            true => Err(Error::variable(format!(
                "{name}: its first and its last line go on beyond the points, and must not fall there: at high speeds they would make energy"
            ))),
        }
    }

    /// How much larger than that at x = 0 the largest slope is.
    pub fn steeper(&self) -> f64 {
        let slope = |[a, b]: [[f64; 2]; 2]| (b[1] - a[1]) / (b[0] - a[0]);
        let here = slope(self.line(0.0));
        self.points.windows(2).map(|pair| slope([pair[0], pair[1]]) - here).fold(0.0, f64::max)
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
        // at 0 the line begins that goes to 0.5
        assert_eq!(curve.steeper(), 0.0);
        let curve = Curve::new("damper", vec![[-1.0, -3.0], [1.0, 3.0], [2.0, 10.0]]).unwrap();
        assert_eq!(curve.steeper(), 4.0);
        // a line through 0 by rounding only
        Curve::new("damper", vec![[-0.3, -900.0], [0.6, 1800.0]]).unwrap().check_resists("damper").unwrap();
        for (points, word) in [
            (vec![[-1.0, 5e3], [0.0, 0.0], [1.0, -5e3]], "makes energy"),
            (vec![[0.0, 10.0], [1.0, 20.0]], "speed 0"),
            (vec![[-1.0, -1e3], [0.0, 0.0], [1.0, 2e3], [2.0, 1e3]], "beyond the points"),
        ] {
            let error =
                Curve::new("damper", points).unwrap().check_resists("damper").unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
        let error = Curve::new("damper", vec![[0.0, 0.0], [0.0, 1.0]]).unwrap_err().to_string();
        assert!(error.contains("0 stands behind 0"), "{error}");
    }
}
