//! How stiffness and damping of an element depend on load and speed: constant, by power laws, or by a table. The source
//! identifies such curves and prints none of their numbers (5.1, 6.4).

use crate::{Error, Result};
use serde::{Deserialize, Serialize};

/// A coefficient over load and speed.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub enum Characteristic {
    /// Everywhere the same.
    #[default]
    Constant,
    /// The factor (load / reference)^a (speed / reference)^b on the constant.
    Power {
        /// References of load \[N\] and speed \[m/s\].
        reference: [f64; 2],
        /// Exponents of load and speed.
        exponent: [f64; 2],
    },
    /// Values over a grid of loads and speeds, with straight lines between, and the last ones beyond.
    Table {
        /// Loads \[N\], rising.
        loads: Vec<f64>,
        /// Speeds \[m/s\], rising.
        speeds: Vec<f64>,
        /// A row of values for each load.
        values: Vec<f64>,
    },
}

impl Clone for Characteristic {
    fn clone(&self) -> Self {
        match self {
            Self::Constant => Self::Constant,
            Self::Power { reference, exponent } => Self::Power { reference: *reference, exponent: *exponent },
            Self::Table { loads, speeds, values } => {
                Self::Table { loads: loads.clone(), speeds: speeds.clone(), values: values.clone() }
            }
        }
    }

    /// Reuses the memory of a table: steps must not touch the heap.
    fn clone_from(&mut self, source: &Self) {
        match (&mut *self, source) {
            (Self::Table { loads, speeds, values }, Self::Table { loads: l, speeds: s, values: v }) => {
                loads.clone_from(l);
                speeds.clone_from(s);
                values.clone_from(v);
            }
            (this, source) => *this = source.clone(),
        }
    }
}

/// Loads and speeds of a power law are taken no smaller than this share of their references: with a negative exponent it has no
/// value at 0.
const LEAST: f64 = 0.1;

impl Characteristic {
    /// A table from points `load speed value; ...` (`with_speed`) or `load value; ...` that make a whole grid.
    ///
    /// # Errors
    /// Names the parameter, and the point or the place of the grid that is wrong.
    pub fn table(name: &str, text: &str, with_speed: bool) -> Result<Self> {
        let form = if with_speed { "load [N] speed [m/s] value" } else { "load [N] value" };
        let width = if with_speed { 3 } else { 2 };
        let mut points = Vec::new();
        for (i, point) in text.trim().trim_end_matches(';').split(';').enumerate() {
            let words: Vec<&str> = point.split_whitespace().collect();
            let numbers: Option<Vec<f64>> =
                words.iter().map(|w| w.parse().ok().filter(|x: &f64| x.is_finite())).collect();
            match numbers {
                Some(numbers) if numbers.len() == width => {
                    let [load, value] = [numbers[0], numbers[width - 1]];
                    let speed = if with_speed { numbers[1] } else { 0.0 };
                    if load < 0.0 || speed < 0.0 || value < 0.0 {
                        return Err(Error::variable(format!(
                            "{name}: point {}, {:?}: negative",
                            i + 1,
                            point.trim()
                        )));
                    }
                    points.push((load, speed, value));
                }
                _ => {
                    return Err(Error::variable(format!(
                        "{name}: point {}, {:?}: a point is '{form}', numbers with spaces between them; points are separated by semicolons",
                        i + 1,
                        point.trim()
                    )));
                }
            }
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let distinct = |of: fn(&(f64, f64, f64)) -> f64| {
            let mut all: Vec<f64> = points.iter().map(of).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        };
        let (loads, speeds) = (distinct(|p| p.0), distinct(|p| p.1));
        let grid = loads.iter().flat_map(|load| speeds.iter().map(move |speed| (*load, *speed)));
        for ((load, speed), point) in grid.zip(points.iter().map(Some).chain(std::iter::repeat(None))) {
            if point.map(|p| (p.0, p.1)) != Some((load, speed)) {
                return Err(Error::variable(format!(
                    "{name}: there has to be one point for each load and each speed, and at {load} N and {speed} m/s there is none, or two before it are the same"
                )));
            }
        }
        if points.len() != loads.len() * speeds.len() {
            return Err(Error::variable(format!("{name}: a point is there twice")));
        }
        Ok(Self::Table { values: points.iter().map(|p| p.2).collect(), loads, speeds })
    }

    /// The coefficient at a load \[N\] and a speed \[m/s\], where the constant one is `constant`.
    pub fn at(&self, constant: f64, load: f64, speed: f64) -> f64 {
        match self {
            Self::Constant => constant,
            Self::Power { reference, exponent } => {
                let factor = |x: f64, i: usize| match exponent[i] == 0.0 {
                    true => 1.0,
                    false => libm::pow((x.abs() / reference[i]).max(LEAST), exponent[i]),
                };
                constant * factor(load, 0) * factor(speed, 1)
            }
            Self::Table { loads, speeds, values } => {
                let ((row, x), (column, y)) = (place(loads, load), place(speeds, speed.abs()));
                let last = speeds.len() - 1;
                let along = |row: usize| {
                    let from = values[row * speeds.len() + column];
                    from + y * (values[row * speeds.len() + (column + 1).min(last)] - from)
                };
                let from = along(row);
                from + x * (along((row + 1).min(loads.len() - 1)) - from)
            }
        }
    }

    /// Whether one that was read from bytes can be used.
    pub(super) fn is_whole(&self) -> bool {
        match self {
            Self::Table { loads, speeds, values } => {
                !loads.is_empty() && !speeds.is_empty() && values.len() == loads.len() * speeds.len()
            }
            _ => true,
        }
    }
}

/// The number of the last grid point that is not beyond `x`, and the share of the way to the next.
fn place(grid: &[f64], x: f64) -> (usize, f64) {
    let next = grid.partition_point(|g| *g <= x);
    match (next.checked_sub(1), grid.get(next)) {
        (None, _) => (0, 0.0),
        (Some(i), None) => (i, 0.0),
        (Some(i), Some(high)) => (i, (x - grid[i]) / (high - grid[i])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_met_at_its_points_straight_between_and_kept_beyond() {
        let text = "6000 2 300; 6000 4 200; 15000 2 500; 15000 4 260;";
        let table = Characteristic::table("damping_points", text, true).unwrap();
        let at = |load, speed| table.at(0.0, load, speed);
        assert_eq!([at(6000.0, 2.0), at(15000.0, 4.0)], [300.0, 260.0]);
        assert_eq!(at(10500.0, 3.0), (300.0 + 200.0 + 500.0 + 260.0) / 4.0);
        assert_eq!([at(0.0, 0.0), at(1e6, -9.0)], [300.0, 260.0]);
    }

    #[test]
    fn a_table_with_a_hole_or_a_word_is_refused_with_its_place() {
        let error = |text: &str, with_speed| {
            Characteristic::table("stiffness_points", text, with_speed).unwrap_err().to_string()
        };
        assert!(error("6000 2 300; 6000 4 200; 15000 2 500", true).contains("15000 N and 4 m/s"));
        assert!(error("6000 1e5; six 1e5", false).contains("point 2, \"six 1e5\""));
        assert!(error("6000 1e5; 6000 1e5", false).contains("twice"));
        assert!(error("6000 -1e5", false).contains("negative"));
        assert!(error("", false).contains("point 1"));
    }

    #[test]
    fn a_power_law_is_its_constant_at_the_reference() {
        let law = Characteristic::Power { reference: [6500.0, 2.0], exponent: [0.5, -1.0] };
        assert_eq!(law.at(280.0, 6500.0, 2.0), 280.0);
        assert!((law.at(280.0, 4.0 * 6500.0, 4.0) - 280.0).abs() < 1e-12);
        assert_eq!(law.at(280.0, 6500.0, 0.0), 2800.0);
    }
}
