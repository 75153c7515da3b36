//! What becomes of an answer: parameters for the super-elastic models.

use super::answer::{Answer, Coefficient};
use super::geometry::RimForce;
use super::laws::Known;
use super::plan::{Law, Plan};
use crate::Result;
use std::fmt::Write as _;

/// How far beyond its interval a diagnosis may move a parameter, in half intervals: what scatters normally is outside of this once in
/// ten thousand times.
const BEYOND: f64 = 2.0;

fn law_number(law: Law) -> i32 {
    match law {
        Law::Auto | Law::Constant => 1,
        Law::Power => 2,
        Law::Table => 3,
    }
}

/// Parameters as TOML for `latsch export` and `latsch simulate` on any super-elastic model.
///
/// # Errors
/// A plan that cannot be followed.
pub fn parameters(plan: &Plan, answer: &Answer) -> Result<String> {
    let wheel = plan.wheel(plan.tire.elements, false)?;
    let mut text = format!("# {}\n[parameters]\n", crate::one_line(&answer.title));
    let _ = writeln!(text, "tire_name = {}", toml::Value::String(plan.tire.name.clone()));
    let mut line = |name: &str, value: f64| {
        let _ = writeln!(text, "{name} = {value:?}");
    };
    line("tire_radius", wheel.radius);
    line("gap_angle", plan.gap_angle()?);
    line("rubber_mass", plan.rubber_mass()?);
    if let [Some(width), _] = plan.width_and_rim_radius()? {
        line("tire_width", width);
    }
    if wheel.contact.is_some() {
        line("contact_stiffness", plan.contact_stiffness()?);
        line("contact_exponent", plan.contact_exponent()?);
    }
    let _ = writeln!(text, "elements = {}\ncontact_points = {}", wheel.elements, wheel.points.len());
    let _ = writeln!(text, "rim_force = {}", if wheel.rim_force == RimForce::Radial { 1 } else { 2 });
    let mut free = String::new();
    coefficient(&mut text, &mut free, ("stiffness", "element_radial_stiffness"), &answer.stiffness, false);
    coefficient(&mut text, &mut free, ("damping", "element_radial_damping"), &answer.damping, true);
    let Coefficient { reference_load, reference_speed, .. } = &answer.damping;
    let _ = writeln!(text, "reference_load = {reference_load:?}\nreference_speed = {reference_speed:?}");
    let _ = write!(text, "\n# what `latsch diagnose` may change\n[fit]\n{free}");
    Ok(text)
}

fn coefficient(text: &mut String, free: &mut String, names: (&str, &str), c: &Coefficient, with_speed: bool) {
    let (short, name) = names;
    let mut known = |name: &str, known: Known, least: f64| {
        let Known { value, half_width } = known;
        if !(half_width.is_finite() && half_width > 0.0) {
            let _ = writeln!(text, "{name} = {value:?}");
            return;
        }
        let (low, high) = ((value - half_width).max(least), value + half_width);
        let _ = writeln!(text, "{name} = {{ value = {value:?}, low = {low:?}, high = {high:?} }}");
        // of a table it does nothing
        if c.law == Law::Table {
            return;
        }
        let (min, max) = ((value - BEYOND * half_width).max(least), value + BEYOND * half_width);
        let _ = writeln!(free, "{name} = {{ min = {min:?}, max = {max:?} }}");
    };
    known(name, c.value, 0.0);
    if c.law == Law::Power {
        for (of, exponent) in [("load", c.load_exponent), ("speed", c.speed_exponent)] {
            if let Some(exponent) = exponent {
                known(&format!("{short}_{of}_exponent"), exponent, f64::NEG_INFINITY);
            }
        }
    }
    let _ = writeln!(text, "{short}_law = {}", law_number(c.law));
    if c.law == Law::Table {
        let point = |p: &super::answer::Point| match with_speed {
            true => format!("{:?} {:?} {:?}", p.load, p.speed, p.value.value),
            false => format!("{:?} {:?}", p.load, p.value.value),
        };
        let points: Vec<String> = points_on_grid(c).iter().map(point).collect();
        let _ = writeln!(text, "{short}_points = \"{}\"", points.join("; "));
    }
}

/// The points with loads and speeds that are the same to a few percent made equal: a table's grid is exact.
fn points_on_grid(c: &Coefficient) -> Vec<super::answer::Point> {
    let mut points = c.points.clone();
    for i in 0..points.len() {
        for j in 0..i {
            if (points[i].load / points[j].load - 1.0).abs() < 0.02 {
                points[i].load = points[j].load;
            }
            if (points[i].speed - points[j].speed).abs() <= 0.03 * points[j].speed {
                points[i].speed = points[j].speed;
            }
        }
    }
    points
}
