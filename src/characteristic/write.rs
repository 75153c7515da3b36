//! What becomes of an answer: parameters for the super-elastic models, and a property file of their source's form.

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
    if let Some(width) = plan.tire.width.as_ref() {
        line("tire_width", width.in_unit("width", "m")?);
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

/// A property file with the keys of the source's (5.2.2): millimetres, newtons, degrees.
///
/// The form names curves over load and speed (`RADIAL_NONLINEAR = 'yes'`) and has no place for them: it gets the constants at the
/// references, and a comment.
///
/// # Errors
/// A plan that cannot be followed.
pub fn property_file(plan: &Plan, answer: &Answer) -> Result<String> {
    let tire = &plan.tire;
    let wheel = plan.wheel(tire.elements, false)?;
    let or = |q: &Option<super::plan::Quantity>, name: &str, unit: &str, default: f64| -> Result<f64> {
        Ok(q.as_ref().map(|q| q.in_unit(name, unit)).transpose()?.unwrap_or(default))
    };
    let rubber = plan.rubber_mass()?;
    let rim = or(&tire.rim_mass, "rim_mass", "kg", 6.3)?;
    // a quote or a line break would end the text
    let name: String = tire.name.chars().filter(|c| *c != '\'' && !c.is_control()).collect();
    let mut text = String::from(
        "$---------------------------------------------------------------header\n[MDI_HEADER]\nFILE_TYPE = 'tir'\nFILE_VERSION = 2.0\nFILE_FORMAT = 'ASCII'\n(COMMENTS)\n{comment_string}\n",
    );
    let _ = writeln!(text, "'Tire - {name}'\n'Pressure - solid rubber'");
    let mut block = |title: &str, lines: &[(&str, String)]| {
        let _ = writeln!(
            text,
            "$---------------------------------------------------------------{}\n[{title}]",
            title.to_lowercase()
        );
        for (key, value) in lines {
            let _ = writeln!(text, "{key} = {value}");
        }
    };
    let number = |v: f64| format!("{v}");
    let quoted = |v: &str| format!("'{v}'");
    block(
        "UNITS",
        &[
            ("LENGTH", quoted("mm")),
            ("FORCE", quoted("newton")),
            ("ANGLE", quoted("degree")),
            ("MASS", quoted("kg")),
            ("TIME", quoted("sec")),
        ],
    );
    block(
        "MODEL",
        &[
            ("PROPERTY_FILE_FORMAT", quoted("USER")),
            ("FUNCTION_NAME", quoted("TYR501")),
            ("NUM_INT_METHODE", quoted("DOPRI5")),
        ],
    );
    let mut dimension = vec![("UNLOADED_RADIUS", number(1e3 * wheel.radius))];
    if let Some(width) = tire.width.as_ref() {
        dimension.push(("WIDTH", number(1e3 * width.in_unit("width", "m")?)));
    }
    dimension.push(("WEIGHT", number(or(&tire.mass, "mass", "kg", rubber + rim)?)));
    block("DIMENSION", &dimension);
    let mut rims = vec![("WEIGHT_RIM", number(rim)), ("NUM_RIM", "1".to_owned())];
    if let Some(radius) = tire.rim_radius.as_ref() {
        rims.push(("RADIUS_RIM", number(1e3 * radius.in_unit("rim_radius", "m")?)));
    }
    block("RIM", &rims);
    block(
        "CONTACTELEMENT",
        &[
            ("NUM_CE", wheel.elements.to_string()),
            ("LEN_CE", number(5.0)),
            ("ANG_INSIDE_CE", number(plan.gap_angle()?.to_degrees())),
            ("NUM_CP", wheel.points.len().to_string()),
        ],
    );
    block(
        "PARAMETER",
        &[
            ("RADIAL_NONLINEAR", quoted("no")),
            ("RADIAL_STIFFNESS", number(1e-3 * answer.stiffness.value.value)),
            ("RADIAL_DAMPING", number(1e-3 * answer.damping.value.value)),
            ("COR_FACTOR_RSTIFF", number(1.0)),
            ("ROLLING_RESISTANCE", number(0.015)),
            ("CSLIP", number(5.0)),
            ("UMIN", number(0.85)),
            ("UMAX", number(0.94)),
            ("REL_LEN_LON", number(10.0)),
        ],
    );
    if let Some((force, exponent)) = wheel.contact {
        block(
            "CONTACT_COEFFICIENTS",
            &[
                ("CONTACT_MODEL", quoted("fml_imp")),
                ("STIFFNESS", number(force)),
                ("DAMPING", number(0.7)),
                ("PENETRATION", number(0.1)),
                ("EXPONENT", number(exponent)),
            ],
        );
    }
    text.push_str("$ identified: RADIAL_STIFFNESS, RADIAL_DAMPING. LEN_CE, rolling resistance, slip, friction and the damping of the contact are defaults of the super-elastic model\n");
    for (what, c) in [("stiffness", &answer.stiffness), ("damping", &answer.damping)] {
        if matches!(c.law, Law::Power | Law::Table) {
            let _ = writeln!(
                text,
                "$ the {what} depends on load or speed: above is its value at {:.0} N and {:.2} m/s; the law has no place in this form",
                c.reference_load, c.reference_speed
            );
        }
    }
    Ok(text)
}
