//! How long the explicit steps of a hub may be for what it is tied to.
//!
//! Velocity Verlet with dampers that see the velocity predicted for the end of the step takes a mass m on a
//! spring k and a damper d to z^3 + (K + 3/2 g - 2) z^2 + (1 - 2 g) z + g/2 = 0, K = k h^2 / m, g = d h / m. All
//! roots are inside the unit circle as long as K / 4 + g < 1; beyond, z = -1 is the first that leaves it. For
//! masses in a row that is where M - h D - h^2 K / 4 is no longer positive definite.

use crate::{Error, Result};

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
    fn needs_at_hub(&self, step: f64) -> f64 {
        let needed = self.needs(step);
        if needed < self.mass.1 { needed / (1.0 - needed / self.mass.1) } else { f64::INFINITY }
    }
}

fn is_stable(step: f64, hub: f64, links: &[Link]) -> bool {
    links.iter().map(|link| link.needs_at_hub(step)).sum::<f64>() < hub
}

/// The longest stable step up to `step`.
fn longest(step: f64, hub: f64, links: &[Link]) -> f64 {
    let (mut stable, mut unstable) = (0.0, step);
    for _ in 0..60 {
        let middle = 0.5 * (stable + unstable);
        if is_stable(middle, hub, links) { stable = middle } else { unstable = middle }
    }
    stable
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
    // two digits of it are not more than it
    let limit = 0.99 * longest(step, hub.1, links);
    Err(Error::variable(format!(
        "step_size = {step:?} s is too long for {name} = {value:?} {unit} on {mass} = {size:?} {}: the motion would grow without bound; take a step_size of {limit:.1e} s at most, a smaller {name} or a larger {mass}",
        units[0]
    )))
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
