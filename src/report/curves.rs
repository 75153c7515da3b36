//! The page of a tire's curves, or of several tires beside each other.

use super::plot::{Axis, Plot, Size};
use crate::curves::{Condition, Curve, Kind, Measure, Point, Programme, Quantity, Tire};
use crate::page::{Html, Page, Section, Table, number};

/// A curve that never leaves this is none: kN, kN.m or mm \[of the axis\].
const NOTHING: f64 = 1e-6;

/// A quantity of a state, in the unit of its axis.
type Of = fn(&Condition, &Point) -> f64;

/// What stands along an axis: the quantity, its unit, and where it comes from.
type Along = (&'static str, &'static str, Of);

const SLIP_ANGLE: Along = ("slip angle", "deg", |at, _| at.slip_angle.to_degrees());
const SLIP: Along = ("slip", "%", |at, _| 100.0 * at.slip);
const CAMBER: Along = ("camber", "deg", |at, _| at.camber.to_degrees());
const DEFLECTION: Along = ("deflection", "mm", |_, point| 1e3 * point.deflection.unwrap_or(f64::NAN));
const LONGITUDINAL: Along = ("longitudinal force", "kN", |_, point| 1e-3 * point.force[0]);
const LATERAL: Along = ("lateral force", "kN", |_, point| 1e-3 * point.force[1]);
const VERTICAL: Along = ("vertical force", "kN", |_, point| 1e-3 * point.force[2]);
const OVERTURNING: Along = ("overturning moment", "N.m", |at, point| contact(at, point)[0]);
const ALIGNING: Along = ("aligning moment", "N.m", |at, point| contact(at, point)[2]);

/// What a picture shows.
struct Picture {
    title: &'static str,
    x: Along,
    y: Along,
}

/// The page.
pub fn curves_report(tires: &[Tire], programme: &Programme) -> String {
    let names: Vec<&str> = tires.iter().map(|tire| tire.name.as_str()).collect();
    let lead = format!(
        "Stationary states on a level road at {}; friction factor {}. Signs of ISO 8855: a positive slip angle makes a negative lateral force, a positive camber leans the top to the right, slip -100 % is a locked wheel.",
        listed(&programme.speeds, |v| format!("{} km/h", number(3.6 * v))),
        listed(&programme.frictions, number),
    );
    Page::new(&format!("Tire characteristics: {}", names.join(", ")), &lead)
        .section(cornering(tires))
        .section(braking(tires))
        .section(combined(tires))
        .section(camber(tires))
        .section(vertical(tires))
        .section(readings(tires, programme))
        .section(notes(tires))
        .html()
}

fn listed(values: &[f64], text: impl Fn(f64) -> String) -> String {
    values.iter().map(|value| text(*value)).collect::<Vec<_>>().join(", ")
}

fn kilo(load: f64) -> String {
    format!("{} kN", number(1e-3 * load))
}

/// Of one tire over loads, of several beside each other at each load.
fn readings(tires: &[Tire], programme: &Programme) -> Section {
    let mut section = Section::new("In numbers");
    let table = |columns: &[(String, &Tire, f64)]| {
        let mut head = vec!["", ""];
        head.extend(columns.iter().map(|(name, ..)| name.as_str()));
        let mut table = Table::new(&head);
        for measure in Measure::ALL {
            let values: Vec<_> = columns.iter().map(|(_, tire, load)| tire.reading(measure, *load)).collect();
            if values.iter().any(Option::is_some) {
                let [_, title, unit] = measure.words();
                let unit = if unit == "1" { "" } else { unit };
                let row = [title.to_owned(), unit.to_owned()];
                table = table
                    .row(row.into_iter().chain(values.into_iter().map(|v| number(v.unwrap_or(f64::NAN)))));
            }
        }
        table.html()
    };
    if let [tire] = tires {
        let columns: Vec<_> = programme.loads.iter().map(|load| (kilo(*load), tire, *load)).collect();
        section = section.with(table(&columns));
    } else {
        for load in &programme.loads {
            let columns: Vec<_> = tires.iter().map(|tire| (tire.name.clone(), tire, *load)).collect();
            section = section.with(Html::text(&format!("At {}:", kilo(*load)))).with(table(&columns));
        }
    }
    section.with(Html::note(&format!(
        "At {} km/h and friction factor {}. Stiffnesses are slopes at zero, over 0.2 deg, 0.2 % and 2 % of the load. A dash stands for a peak that the curve does not reach, and for what the model does not have. \
         The resistance is that of a wheel that no torque turns. The relaxation length is the way after which the lateral force has 63 % of its change behind a step of the slip angle of half a degree.",
        number(3.6 * programme.speeds.first().copied().unwrap_or(f64::NAN)),
        number(programme.frictions.first().copied().unwrap_or(f64::NAN)),
    )))
}

fn cornering(tires: &[Tire]) -> Section {
    let pictures = [
        Picture { title: "Lateral force", x: SLIP_ANGLE, y: LATERAL },
        Picture { title: "Aligning moment", x: SLIP_ANGLE, y: ALIGNING },
        Picture { title: "Overturning moment", x: SLIP_ANGLE, y: OVERTURNING },
        Picture { title: "Lateral force over aligning moment", x: ALIGNING, y: LATERAL },
    ];
    let section = section("Cornering", tires, Kind::Cornering, &pictures);
    if section.is_empty() {
        return section;
    }
    section.with(Html::note(
        "Moments are about the place where the wheel's middle plane meets the road below its axis (TYDEX W axes), or about the wheel's centre for a rig that does not tell how high that is.",
    ))
}

/// The moment about the contact, or about the wheel's centre where nothing tells how high that is.
fn contact(at: &Condition, point: &Point) -> [f64; 3] {
    point.contact_moment(at.camber).unwrap_or(point.moment)
}

fn braking(tires: &[Tire]) -> Section {
    let pictures = [Picture { title: "Longitudinal force", x: SLIP, y: LONGITUDINAL }];
    section("Braking and driving", tires, Kind::Braking, &pictures)
}

fn combined(tires: &[Tire]) -> Section {
    let pictures = [
        Picture { title: "Lateral over longitudinal force", x: LONGITUDINAL, y: LATERAL },
        Picture { title: "Lateral force", x: SLIP, y: LATERAL },
    ];
    section("Combined slip", tires, Kind::Combined, &pictures)
}

fn camber(tires: &[Tire]) -> Section {
    let pictures = [
        Picture { title: "Lateral force", x: CAMBER, y: LATERAL },
        Picture { title: "Aligning moment", x: CAMBER, y: ALIGNING },
    ];
    section("Camber", tires, Kind::Camber, &pictures)
}

fn vertical(tires: &[Tire]) -> Section {
    section("Vertical", tires, Kind::Vertical, &[Picture { title: "", x: DEFLECTION, y: VERTICAL }])
}

fn section(heading: &str, tires: &[Tire], kind: Kind, pictures: &[Picture]) -> Section {
    let plots: Vec<Html> = pictures.iter().flat_map(|picture| drawn(tires, kind, picture)).collect();
    // a tire without such forces has no such section
    if plots.is_empty() { Section::new(heading) } else { Section::new(heading).side_by_side(plots) }
}

fn notes(tires: &[Tire]) -> Section {
    tires
        .iter()
        .flat_map(|tire| tire.notes.iter().map(move |note| (tire, note)))
        .fold(Section::new("Notes"), |section, (tire, note)| {
            section.with(Html::text(&format!("{}: {note}", tire.name)))
        })
}

/// The pictures of a kind of curves: of one tire those at other loads, speeds and friction each in one, of several tires each condition
/// in one.
fn drawn(tires: &[Tire], kind: Kind, picture: &Picture) -> Vec<Html> {
    let curves =
        |tire: &'_ Tire| -> Vec<Curve> { tire.curves.iter().filter(|c| c.kind == kind).cloned().collect() };
    let mut plots = Vec::new();
    if let [tire] = tires {
        let all = curves(tire);
        let Some(first) = all.first().map(|curve| curve.held) else { return plots };
        for varied in [Varied::Load, Varied::SlipAngle, Varied::Speed, Varied::Friction] {
            // the curves that differ in it alone, from the one that has the others of the first
            let middle =
                all.iter().find(|c| varied.differs(&c.held, &first)).map(|c| varied.base(&c.held, &first));
            let Some(base) = middle else { continue };
            let of = all.iter().filter(|c| varied.is_of(&c.held, &base));
            let lines = of.map(|c| (varied.text(&c.held), c)).collect::<Vec<_>>();
            plots.extend(plot(picture, &varied.title(&base, kind), &lines));
        }
        if plots.is_empty() {
            plots.extend(plot(picture, "", &all.iter().map(|c| (kilo(c.held.load), c)).collect::<Vec<_>>()));
        }
        return plots;
    }
    let all: Vec<(&Tire, Vec<Curve>)> = tires.iter().map(|tire| (tire, curves(tire))).collect();
    let mut conditions: Vec<Condition> = Vec::new();
    for curve in all.iter().flat_map(|(_, curves)| curves) {
        if !conditions.contains(&curve.held) {
            conditions.push(curve.held);
        }
    }
    let first = conditions.first().copied();
    for held in conditions {
        let lines: Vec<(String, &Curve)> = all
            .iter()
            .flat_map(|(tire, curves)| curves.iter().map(move |curve| (tire.name.clone(), curve)))
            .filter(|(_, curve)| curve.held == held)
            .collect();
        let told: Vec<String> = [Varied::Load, Varied::SlipAngle, Varied::Speed, Varied::Friction]
            .into_iter()
            .filter(|varied| {
                matches!(varied, Varied::Load) && kind != Kind::Vertical
                    || first.is_some_and(|first| varied.of(&held) != varied.of(&first))
                    || matches!(varied, Varied::SlipAngle) && kind == Kind::Combined
            })
            .map(|varied| varied.text(&held))
            .collect();
        plots.extend(plot(picture, &told.join(", "), &lines));
    }
    plots
}

/// What differs between the curves of a picture.
#[derive(Clone, Copy, PartialEq)]
enum Varied {
    Load,
    SlipAngle,
    Speed,
    Friction,
}

impl Varied {
    fn of(self, held: &Condition) -> f64 {
        match self {
            Self::Load => held.load,
            Self::SlipAngle => held.slip_angle,
            Self::Speed => held.speed,
            Self::Friction => held.friction,
        }
    }

    fn set(self, held: &Condition, value: f64) -> Condition {
        match self {
            Self::Load => held.with(Quantity::Load, value),
            Self::SlipAngle => held.with(Quantity::SlipAngle, value),
            Self::Speed => Condition { speed: value, ..*held },
            Self::Friction => Condition { friction: value, ..*held },
        }
    }

    fn differs(self, held: &Condition, first: &Condition) -> bool {
        self.of(held) != self.of(first)
    }

    /// What the curves share that differ in this from `held`.
    fn base(self, held: &Condition, first: &Condition) -> Condition {
        self.set(held, self.of(first))
    }

    fn is_of(self, held: &Condition, base: &Condition) -> bool {
        self.set(held, self.of(base)) == *base
    }

    fn text(self, held: &Condition) -> String {
        match self {
            Self::Load => kilo(held.load),
            Self::SlipAngle => format!("{} deg", number(held.slip_angle.to_degrees())),
            Self::Speed => format!("{} km/h", number(3.6 * held.speed)),
            Self::Friction => format!("friction factor {}", number(held.friction)),
        }
    }

    /// What the curves of a picture share that is worth a word.
    fn title(self, base: &Condition, kind: Kind) -> String {
        match self {
            Self::Load => String::new(),
            _ if kind == Kind::Vertical => String::new(),
            _ => format!("at {}", kilo(base.load)),
        }
    }
}

fn plot(picture: &Picture, told: &str, lines: &[(String, &Curve)]) -> Option<Html> {
    let Picture { title, x: (x, x_unit, x_of), y: (y, y_unit, y_of) } = picture;
    let title = match (title.is_empty(), told.is_empty()) {
        (_, true) => (*title).to_owned(),
        (true, _) => told.to_owned(),
        _ => format!("{title}, {told}"),
    };
    let mut plot = Plot::new(&title, Axis::new(x, x_unit), Axis::new(y, y_unit)).size(Size::Half);
    let mut most = 0.0_f64;
    for (name, curve) in lines {
        let nothing = (f64::NAN, f64::NAN);
        let points = curve
            .states
            .iter()
            .map(|(at, point)| point.as_ref().map_or(nothing, |point| (x_of(at, point), y_of(at, point))));
        let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
        most = y.iter().filter(|y| y.is_finite()).fold(most, |most, y| most.max(y.abs()));
        plot = plot.line(name, &x, &y);
    }
    (most > NOTHING).then(|| plot.html())
}
