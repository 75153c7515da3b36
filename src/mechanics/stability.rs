//! How long the explicit steps of a hub may be for what it is tied to.
//!
//! Velocity Verlet with dampers that see the velocity predicted for the end of the step takes a mass m on a
//! spring k and a damper d to z^3 + (K + 3/2 g - 2) z^2 + (1 - 2 g) z + g/2 = 0, K = k h^2 / m, g = d h / m. All
//! roots are inside the unit circle as long as K / 4 + g < 1; beyond, z = -1 is the first that leaves it. For
//! masses in a row that is where M - h D - h^2 K / 4 is no longer positive definite.

use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// A quantity of the model with its name.
pub type Named = (&'static str, f64);

/// Units of mass, stiffness and damping.
pub const ALONG: [&str; 3] = ["kg", "N/m", "N.s/m"];
/// The same for rotation.
pub const ABOUT: [&str; 3] = ["kg.m2", "N.m/rad", "N.m.s/rad"];

/// What ties a hub to another mass, or to the ground: then that is infinite.
#[derive(Debug, Clone, Copy)]
pub struct Link {
    /// Its spring.
    pub stiffness: Named,
    /// Its damper.
    pub damping: Named,
    /// The mass at the other end.
    pub mass: Named,
}

impl Link {
    /// The mass that it takes at each end to be stepped by `step`.
    fn needs(&self, step: f64) -> f64 {
        step * self.damping.1 + 0.25 * step * step * self.stiffness.1
    }

    /// The mass that it takes at the hub, where the other end is as heavy as it is.
    pub fn needs_at_hub(&self, step: f64) -> f64 {
        let needed = self.needs(step);
        if needed < self.mass.1 { needed / (1.0 - needed / self.mass.1) } else { f64::INFINITY }
    }
}

fn is_stable(step: f64, hub: f64, links: &[Link]) -> bool {
    links.iter().map(|link| link.needs_at_hub(step)).sum::<f64>() < hub
}

/// The longest stable step up to `step`.
fn longest(step: f64, hub: f64, links: &[Link]) -> f64 {
    bisected(step, |step| is_stable(step, hub, links))
}

/// The longest step up to one that is not stable.
fn bisected(step: f64, is_stable: impl Fn(f64) -> bool) -> f64 {
    let (mut stable, mut unstable) = (0.0, step);
    for _ in 0..60 {
        let middle = 0.5 * (stable + unstable);
        if is_stable(middle) { stable = middle } else { unstable = middle }
    }
    stable
}

/// A positive number with two digits that is not more than it.
fn rounded_down(number: f64) -> f64 {
    let unit = libm::pow(10.0, libm::log10(number).floor() - 1.0);
    (number / unit).floor() * unit
}

/// Checks that a hub with these links can be stepped by `step` seconds.
///
/// # Errors
/// It cannot; the message names what is too stiff for what.
pub fn check_step_size(step: f64, hub: Named, links: &[Link], units: &[&str; 3]) -> Result<()> {
    if is_stable(step, hub.1, links) {
        return Ok(());
    }
    let worst = links.iter().max_by(|a, b| a.needs_at_hub(step).total_cmp(&b.needs_at_hub(step)));
    let Some(link) = worst else { return Ok(()) };
    let damps = step * link.damping.1 > 0.5 * link.needs(step);
    let ((name, value), unit) = if damps { (link.damping, units[2]) } else { (link.stiffness, units[1]) };
    let (mass, size) = if link.mass.1 < hub.1 { link.mass } else { hub };
    let limit = rounded_down(longest(step, hub.1, links));
    Err(Error::variable(format!(
        "step_size = {step:?} s is too long for {name} = {value:?} {unit} on {mass} = {size:?} {}: the motion would grow without bound; take a step_size of {limit:.1e} s at most, a smaller {name} or a larger {mass}",
        units[0]
    )))
}

/// How a coordinate of bodies is called where it moves most, and a length that makes a rotation a way \[m\]; 1 of a way.
pub type Coordinate = (String, f64);

/// What bodies do about a state: how accelerations answer to a change of each place and of each velocity, column by column.
pub struct Response {
    by_place: DMatrix<f64>,
    by_velocity: DMatrix<f64>,
}

/// Changes by which [`Response::new`] finds differences \[m or rad, m/s or rad/s\]: small against gaps and strains, and large against
/// rounding, which is some 1e-12 of accelerations.
const PROBE: f64 = 1e-6;

impl Response {
    /// From accelerations of all coordinates where places and velocities are changed by so much.
    pub fn new(coordinates: usize, mut accelerations: impl FnMut(&[f64], &[f64]) -> Vec<f64>) -> Self {
        let mut column = |n: usize, of_place: bool| {
            let mut ends = [-PROBE, PROBE].map(|by| {
                let mut changes = [vec![0.0; coordinates], vec![0.0; coordinates]];
                changes[usize::from(!of_place)][n] = by;
                accelerations(&changes[0], &changes[1])
            });
            let [before, after] = &mut ends;
            DVector::from_iterator(
                coordinates,
                after.iter().zip(before.iter()).map(|(a, b)| (a - b) / (2.0 * PROBE)),
            )
        };
        let columns = |of_place: bool, column: &mut dyn FnMut(usize, bool) -> DVector<f64>| {
            DMatrix::from_columns(&(0..coordinates).map(|n| column(n, of_place)).collect::<Vec<_>>())
        };
        Self { by_place: columns(true, &mut column), by_velocity: columns(false, &mut column) }
    }

    /// Checks that the bodies can be stepped by `step` seconds: that M - h D - h² K / 4 is positive definite. `more` says what else
    /// takes a share of each coordinate's mass at a step.
    ///
    /// # Errors
    /// They cannot; the message names what would swing without bound, and the longest step.
    pub fn check(&self, step: f64, names: &[Coordinate], more: impl Fn(f64) -> Vec<f64>) -> Result<()> {
        let matrix = |taken: Vec<f64>, step: f64| {
            let taken = DMatrix::from_diagonal(&DVector::from_vec(taken));
            &self.by_velocity * -step - &self.by_place * (0.25 * step * step) + taken
        };
        // where one coordinate has nothing left there is no mode to ask for
        let spent = |taken: &[f64]| taken.iter().position(|share| share.is_nan() || *share >= 1.0);
        let is_stable = |step: f64| {
            let taken = more(step);
            spent(&taken).is_none() && largest(&matrix(taken, step)) < 1.0
        };
        if !self.by_place.iter().chain(&self.by_velocity).all(|rate| rate.is_finite()) {
            return Err(Error::numeric("the bodies have no finite accelerations where they are"));
        }
        if is_stable(step) {
            return Ok(());
        }
        let stable = bisected(step, is_stable);
        let taken = more(step);
        let only = spent(&taken);
        // powers of the matrix leave the shape of the mode that needs most
        let matrix = matrix(taken, step);
        let mut shape = DVector::from_element(names.len(), 1.0);
        for _ in 0..SHAPED {
            shape = &matrix * &shape;
            let size = shape.amax();
            shape /= if size > 0.0 { size } else { 1.0 };
        }
        let moves = |n: &usize| (shape[*n] * names[*n].1).abs();
        let moves_most = || (0..names.len()).max_by(|a, b| moves(a).total_cmp(&moves(b)));
        let most = only.or_else(moves_most).unwrap_or(0);
        Err(Error::variable(format!(
            "step_size = {step:?} s is too long for what swings fastest, which would grow without bound: {}; take a step_size of {:.1e} s at most, softer springs and bushings there, or more mass",
            names[most].0,
            rounded_down(stable)
        )))
    }
}

/// Products after which a shape no longer changes much.
const SHAPED: usize = 100;
/// Iterations for the eigenvalues of a matrix, of which there are some for each of them.
const MOST_SHIFTS: usize = 10_000;

/// The largest real part of the eigenvalues.
fn largest(matrix: &DMatrix<f64>) -> f64 {
    nalgebra::linalg::Schur::try_new(matrix.clone(), f64::EPSILON, MOST_SHIFTS)
        .map_or(f64::INFINITY, |schur| {
            schur.complex_eigenvalues().iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max)
        })
}

/// Checks that the masses at the other ends of links in the plane of a wheel, along its axis and about it can be stepped by
/// `step` seconds while the rim is led.
///
/// # Errors
/// As [`check_step_size`].
pub fn check_steps_of_led_rim(step: f64, links: [Link; 3]) -> Result<()> {
    for (link, units) in links.into_iter().zip([&ALONG, &ALONG, &ABOUT]) {
        if link.mass.1.is_finite() {
            check_step_size(step, link.mass, &[Link { mass: ("the rim", f64::INFINITY), ..link }], units)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest amplitude at the end of many steps of the masses left - hub - right from a displaced hub, in the
    /// way of the models.
    fn last(step: f64, masses: [f64; 3], links: &[Link; 2]) -> f64 {
        let (mut x, mut v, mut a) = ([0.0, 1.0, 0.0], [0.0; 3], [0.0; 3]);
        let mut largest = 0.0_f64;
        for n in 0..30_000 {
            let mut predicted = [0.0; 3];
            for i in 0..3 {
                v[i] += 0.5 * step * a[i];
                x[i] += step * v[i];
                predicted[i] = v[i] + 0.5 * step * a[i];
            }
            let force = |link: &Link, i: usize, j: usize| {
                link.stiffness.1 * (x[i] - x[j]) + link.damping.1 * (predicted[i] - predicted[j])
            };
            let (left, right) = (force(&links[0], 0, 1), force(&links[1], 1, 2));
            a = [-left / masses[0], (left - right) / masses[1], right / masses[2]];
            for i in 0..3 {
                v[i] += 0.5 * step * a[i];
            }
            if n > 29_000 || x[1].abs() > 1e6 {
                largest = largest.max((x[1] - x[0]).abs()).max((x[2] - x[1]).abs());
            }
            if x[1].abs() > 1e6 {
                break;
            }
        }
        largest
    }

    /// The same limit from how accelerations answer, with both ends, the hub's links or all three masses.
    #[test]
    fn modes_have_the_limit_of_masses_in_a_row() {
        let (masses, stiffness, damping) = ([380.0, 40.0, 8.8], [750e3, 4.67e6], [900.0, 449.0]);
        let link = |i: usize| Link {
            stiffness: ("stiffness", stiffness[i]),
            damping: ("damping", damping[i]),
            mass: ("mass", masses[2 * i]),
        };
        let limit = longest(1.0, masses[1], &[link(0), link(1)]);
        let response = Response::new(3, |x, v| {
            let force = |i: usize| stiffness[i] * (x[i] - x[i + 1]) + damping[i] * (v[i] - v[i + 1]);
            vec![-force(0) / masses[0], (force(0) - force(1)) / masses[1], force(1) / masses[2]]
        });
        let names = ["left", "hub", "right"].map(|name| (name.to_owned(), 1.0));
        let none = |_: f64| vec![0.0; 3];
        response.check(0.999 * limit, &names, none).unwrap();
        let error = response.check(1.001 * limit, &names, none).unwrap_err().to_string();
        assert!(error.contains("right"), "{error}");
        // the right mass as a link of the hub
        let hub = Response::new(2, |x, v| {
            let force = stiffness[0] * (x[0] - x[1]) + damping[0] * (v[0] - v[1]);
            vec![-force / masses[0], force / masses[1]]
        });
        let tied = |step: f64| vec![0.0, link(1).needs_at_hub(step) / masses[1]];
        hub.check(0.999 * limit, &names[..2], tied).unwrap();
        assert!(hub.check(1.001 * limit, &names[..2], tied).is_err());
    }

    #[test]
    fn the_limit_is_where_the_motion_begins_to_grow() {
        for (masses, stiffness, damping) in [
            ([380.0, 40.0, 8.8], [750e3, 4.67e6], [900.0, 449.0]),
            ([380.0, 40.0, 8.8], [750e3, 4.67e6], [1e6, 449.0]),
            ([380.0, 40.0, 8.8], [1e9, 4.67e6], [900.0, 449.0]),
            ([380.0, 0.1, 8.8], [750e3, 4.67e6], [900.0, 449.0]),
            ([380.0, 40.0, 0.1], [38e3, 4.67e6], [2600.0, 449.0]),
            ([1.0, 2.0, 3.0], [1e4, 2e4], [0.0, 0.0]),
            ([1.0, 2.0, 3.0], [1e4, 2e4], [50.0, 1e3]),
            ([5.0, 1.0, 0.2], [1e3, 1e6], [1e4, 3.0]),
        ] {
            let link = |i: usize| Link {
                stiffness: ("stiffness", stiffness[i]),
                damping: ("damping", damping[i]),
                mass: ("mass", masses[2 * i]),
            };
            let links = [link(0), link(1)];
            let limit = longest(1.0, masses[1], &links);
            let [below, above] = [0.98, 1.02].map(|share| last(share * limit, masses, &links));
            assert!(below < 1e3, "{masses:?} {stiffness:?} {damping:?}: {below} below {limit} s");
            assert!(above > 1e6, "{masses:?} {stiffness:?} {damping:?}: {above} above {limit} s");
        }
    }
}
