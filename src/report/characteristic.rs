//! The page of a characterization: the coefficients first, then loops, decays, and tables over load, speed and number of elements.

use super::plot::{Axis, Plot, Size, Tone};
use crate::characteristic::laws::{Form, Known};
use crate::characteristic::{Answer, Coefficient, DecayAnswer, LoopAnswer, MassFrom, value_at};
use crate::page::{Html, Page, Section, Table, escape, number};

/// The page of what loops and decays told of a tire.
pub fn characteristic_report(answer: &Answer) -> String {
    let lead = format!(
        "{}. From {} and {}. Intervals are those of 95 %, by what cycles, periods and residuals scatter.",
        answer.title,
        count(answer.loops.len(), "loop"),
        count(answer.decays.len(), "recording of decays")
    );
    let mut page = Page::new("Characteristics of a solid tire", &lead).section(coefficients(answer));
    for one in &answer.loops {
        page = page.section(loop_section(one));
    }
    page = page.section(stiffness_over_load(answer)).section(elements(answer));
    let decays = answer.decays.iter().fold(Section::new("Decays"), decay_part);
    page.section(damping_table(answer)).section(decays).section(notes(answer)).html()
}

fn count(n: usize, what: &str) -> String {
    match n {
        1 => format!("1 {what}"),
        n if what.contains(' ') => format!("{n} {}", what.replacen(' ', "s ", 1)),
        n => format!("{n} {what}s"),
    }
}

/// A number and its interval.
fn known(known: Known) -> [String; 2] {
    [number(known.value), number(known.half_width)]
}

/// A number that is for comparison, without an interval of its own.
fn unqualified(value: f64) -> Known {
    Known { value, half_width: f64::NAN }
}

fn coefficients(answer: &Answer) -> Section {
    let mut table = Table::new(&["", "value", "±", "unit", "written as", "why"]);
    for (name, unit, c) in [
        ("stiffness of an element", "N/m", &answer.stiffness),
        ("damping of an element", "N.s/m", &answer.damping),
    ] {
        let law = format!("{:?}", c.law).to_lowercase();
        let [value, half] = known(c.value);
        table = table.row([name.to_owned(), value, half, unit.to_owned(), law, c.why.clone()]);
        for (of, exponent) in [("load", c.load_exponent), ("speed", c.speed_exponent)] {
            if let Some(exponent) = exponent {
                let [value, half] = known(exponent);
                table = table.row([
                    format!("exponent of the {of}"),
                    value,
                    half,
                    "1".into(),
                    String::new(),
                    String::new(),
                ]);
            }
        }
    }
    let reference = format!(
        "Power laws hold their value at {} N and {} m/s.",
        number(answer.damping.reference_load),
        number(answer.damping.reference_speed)
    );
    Section::new("Coefficients").with(table.html()).with(Html::note(&reference))
}

fn loop_section(one: &LoopAnswer) -> Section {
    let analysis = &one.analysis;
    let mm = |values: &[f64]| values.iter().map(|v| 1e3 * v).collect::<Vec<f64>>();
    let kilo = |values: &[f64]| values.iter().map(|v| 1e-3 * v).collect::<Vec<f64>>();
    let (e, f): (Vec<f64>, Vec<f64>) = analysis.samples.iter().map(|[e, f]| (*e, *f)).unzip();
    let (deflection, force) = (Axis::new("deflection", "mm"), Axis::new("force", "kN"));
    let curve = &analysis.curve;
    let mut plot = Plot::new("", deflection.clone(), force).line("measured", &mm(&e), &kilo(&f));
    plot = plot.line("mean of the branches", &mm(&curve.deflection), &kilo(&curve.mean));
    let mut left = Plot::new("", deflection, Axis::new("law less mean", "N")).size(Size::Half);
    let mut fits = Table::new(&["law", "a", "±", "b", "±", "RMSE N", "R²"]);
    for fit in &analysis.forms {
        let (name, units) = match fit.form {
            Form::Power => ("F = a e^b", "N/m^b, 1"),
            Form::Hyperbola => ("F = a e / (b − e)", "N, m"),
            Form::Polynomial => ("F = a e + b e²", "N/m, N/m²"),
        };
        let law: Vec<f64> = curve.deflection.iter().map(|e| fit.at(*e)).collect();
        plot = plot.line(name, &mm(&curve.deflection), &kilo(&law));
        let off: Vec<f64> = law.iter().zip(&curve.mean).map(|(a, b)| a - b).collect();
        left = left.line(name, &mm(&curve.deflection), &off);
        let ([a, da], [b, db]) = (known(fit.coefficients[0]), known(fit.coefficients[1]));
        fits =
            fits.row([format!("{name} ({units})"), a, da, b, db, number(fit.rmse), format!("{:.6}", fit.r2)]);
    }
    let mut at = Table::new(&[
        "load N",
        "deflection mm",
        "±",
        "secant N/mm",
        "±",
        "tangent N/mm",
        "element N/mm",
        "±",
        "by (6-6)",
    ]);
    for row in &one.at {
        let ([e, de], [secant, ds], [k, dk]) =
            (known(row.deflection.times(1e3)), known(row.secant.times(1e-3)), known(row.element.times(1e-3)));
        at = at.row([
            number(row.load),
            e,
            de,
            secant,
            ds,
            number(1e-3 * row.tangent),
            k,
            dk,
            number(1e-3 * row.printed),
        ]);
    }
    let [area, da] = known(analysis.area);
    let [c, dc] = known(analysis.equivalent_damping.times(1e-3));
    let [ce, dce] = known(one.element_damping.times(1e-3));
    let words = format!(
        "{} cycles of {} s, {} to {} mm. A cycle loses {area} ± {da} J: an equivalent damping of {c} ± {dc} N.s/mm for the whole tire, {ce} ± {dce} N.s/mm for an element, a loss angle of {}°.",
        analysis.cycles,
        number(analysis.period),
        number(1e3 * analysis.deflections[0]),
        number(1e3 * analysis.deflections[1]),
        number(analysis.loss_angle.to_degrees())
    );
    let halves = [
        left.html(),
        Plot::new("", Axis::new("load", "N"), Axis::new("stiffness of the tire", "N/mm"))
            .size(Size::Half)
            .line("secant", &loads(one), &one.at.iter().map(|r| 1e-3 * r.secant.value).collect::<Vec<_>>())
            .line("tangent", &loads(one), &one.at.iter().map(|r| 1e-3 * r.tangent).collect::<Vec<_>>())
            .html(),
    ];
    let section = Section::new(&format!("Loop {}", one.file)).with(Html::text(&words)).with(plot.html());
    let section = section.side_by_side(halves).with(fits.html()).with(at.html());
    analysis.notes.iter().fold(section, |section, note| section.with(Html::note(note)))
}

fn loads(one: &LoopAnswer) -> Vec<f64> {
    one.at.iter().map(|r| r.load).collect()
}

/// Places of a law between the least and the largest of its points.
fn between(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let (low, high) = crate::stats::extent(values);
    (0..=40).map(|k| low + (high - low) * f64::from(k) / 40.0).collect()
}

fn stiffness_over_load(answer: &Answer) -> Section {
    let c = &answer.stiffness;
    let section = Section::new("Stiffness of an element over the load");
    if c.points.is_empty() {
        return section;
    }
    let at: Vec<f64> = c.points.iter().map(|p| p.load).collect();
    let places = between(at.iter().copied());
    let law: Vec<f64> = places.iter().map(|f| 1e-3 * value_at(c, *f, 0.0)).collect();
    let ends = |sign: f64| -> Vec<f64> {
        c.points.iter().map(|p| 1e-3 * (p.value.value + sign * p.value.half_width)).collect()
    };
    let mut plot = Plot::new("", Axis::new("load", "N"), Axis::new("stiffness of an element", "N/mm"));
    let (low, high) = (ends(-1.0), ends(1.0));
    if low.iter().all(|v| v.is_finite()) && at.len() > 1 {
        plot = plot.band(Tone::Before, &at, &low, &high);
    }
    plot = plot.line("as written", &places, &law);
    plot =
        plot.dots("from the loops", &at, &c.points.iter().map(|p| 1e-3 * p.value.value).collect::<Vec<_>>());
    section.with(plot.html())
}

fn elements(answer: &Answer) -> Section {
    let section = Section::new("For other numbers of elements");
    let mut numbers: Vec<usize> = answer.elements.iter().map(|e| e.elements).collect();
    numbers.dedup();
    if numbers.len() < 2 {
        return section;
    }
    let mut table = Table::new(&[
        "N",
        "load N",
        "in contact M",
        "k element by (6-6) N/mm",
        "k element of the tire N/mm",
        "c element / whole by (6-10)",
        "by 1 / M",
    ]);
    for row in &answer.elements {
        table = table.row([
            row.elements.to_string(),
            number(row.load),
            row.touching.to_string(),
            number(1e-3 * row.stiffness),
            number(1e-3 * row.tire),
            number(row.by_cosines),
            number(row.by_elements),
        ]);
    }
    let mut plot = Plot::new("", Axis::new("load", "N"), Axis::new("stiffness of an element", "N/mm"));
    for n in numbers {
        let own = || answer.elements.iter().filter(move |e| e.elements == n);
        let (x, y): (Vec<f64>, Vec<f64>) = own().map(|e| (e.load, 1e-3 * e.tire)).unzip();
        plot = plot.dots(&format!("N = {n}"), &x, &y);
    }
    section.with(plot.html()).with(table.html())
}

fn decay_part(section: Section, one: &DecayAnswer) -> Section {
    let analysis = &one.analysis;
    let axis = Axis::new(&one.channel, &one.unit);
    let mut plot = Plot::new("", Axis::new("time since the impact", "s"), axis.clone()).columns(600);
    let low: Vec<f64> = analysis.average.iter().zip(&analysis.scatter).map(|(a, s)| a - 2.0 * s).collect();
    let high: Vec<f64> = analysis.average.iter().zip(&analysis.scatter).map(|(a, s)| a + 2.0 * s).collect();
    plot = plot.band(Tone::Before, &analysis.time, &low, &high).line(
        "average of the aligned periods",
        &analysis.time,
        &analysis.average,
    );
    let free: Vec<f64> = analysis.time.iter().copied().filter(|t| *t >= analysis.free_from).collect();
    let envelope = |sign: f64| -> Vec<f64> {
        free.iter().map(|t| analysis.zero + sign * analysis.envelope_at(*t)).collect()
    };
    let (x, y): (Vec<f64>, Vec<f64>) = analysis.turns.iter().map(|[t, d]| (*t, analysis.zero + d)).unzip();
    // both sides of the envelope as one line with a break
    let both_x: Vec<f64> = free.iter().copied().chain([f64::NAN]).chain(free.iter().copied()).collect();
    let both_y: Vec<f64> = envelope(1.0).into_iter().chain([f64::NAN]).chain(envelope(-1.0)).collect();
    plot = plot.line("envelope of the fitted oscillation", &both_x, &both_y).rings("turns", &x, &y);
    let mut aligned =
        Plot::new("", Axis::new("time since the impact", "s"), axis).size(Size::Strip).columns(300);
    for (k, period) in analysis.aligned.iter().take(6).enumerate() {
        aligned = aligned.line(&format!("period {}", k + 1), &analysis.time, period);
    }
    let mass = match one.mass_from {
        MassFrom::Given => "given",
        MassFrom::Pivot => "inertia about the pivot over the square of the wheel's arm",
        MassFrom::Load => "load over gravity",
    };
    let mut table = Table::new(&["", "value", "±", "unit"]);
    let rows = [
        ("decay rate, whole oscillation", analysis.decay_rate, "1/s"),
        ("decay rate, envelope through the turns", analysis.envelope_rate, "1/s"),
        ("frequency", analysis.frequency.times(1.0 / std::f64::consts::TAU), "Hz"),
        ("damping of the whole tire 2 m δ (6-1)", one.damping.times(1e-3), "N.s/mm"),
        ("stiffness by the frequency", one.stiffness.times(1e-3), "N/mm"),
        ("tangent by the loops", unqualified(1e-3 * one.tangent), "N/mm"),
        ("damping of an element, as the tire has it", one.element.times(1e-3), "N.s/mm"),
        ("damping of an element by Σ cos² (6-10)", unqualified(1e-3 * one.by_cosines), "N.s/mm"),
        ("damping of an element by M", unqualified(1e-3 * one.by_elements), "N.s/mm"),
    ];
    for (name, value, unit) in rows {
        let [value, half] = known(value);
        table = table.row([name.to_owned(), value, half, unit.to_owned()]);
    }
    let words = format!(
        "{} N, {} m/s, {} kg ({mass}). {} periods of {} s (standard deviation {} ms); {} % of the amplitude is left when the next impact comes. The fit leaves {} % of the amplitude (root mean square).",
        number(one.load),
        number(one.speed),
        number(one.mass),
        analysis.periods,
        number(analysis.period),
        number(1e3 * analysis.jitter),
        number(100.0 * analysis.left),
        number(100.0 * analysis.residual)
    );
    let head = Html::raw(format!("<h3>{}</h3>\n", escape(&one.file)));
    let section = section.with(head).with(Html::text(&words)).with(plot.html());
    let section = section.with(aligned.html()).with(table.html());
    analysis.notes.iter().fold(section, |section, note| section.with(Html::note(note)))
}

fn damping_table(answer: &Answer) -> Section {
    let section = Section::new("Damping over load and speed");
    if answer.decays.len() < 2 {
        return section;
    }
    let c: &Coefficient = &answer.damping;
    let mut table = Table::new(&["load N", "speed m/s", "whole tire N.s/mm", "±", "element N.s/mm", "±"]);
    for one in &answer.decays {
        let ([whole, dw], [element, de]) = (known(one.damping.times(1e-3)), known(one.element.times(1e-3)));
        table = table.row([number(one.load), number(one.speed), whole, dw, element, de]);
    }
    let mut all: Vec<f64> = c.points.iter().map(|p| p.load).collect();
    all.dedup_by(|a, b| (*a / *b - 1.0).abs() < 0.02);
    let mut plot = Plot::new("", Axis::new("speed", "m/s"), Axis::new("damping of an element", "N.s/mm"));
    for load in all {
        let own = || c.points.iter().filter(move |p| (p.load / load - 1.0).abs() < 0.02);
        let (x, y): (Vec<f64>, Vec<f64>) = own().map(|p| (p.speed, 1e-3 * p.value.value)).unzip();
        if c.law == crate::characteristic::Law::Power {
            let places = between(x.iter().copied());
            let law: Vec<f64> = places.iter().map(|v| 1e-3 * value_at(c, load, *v)).collect();
            plot = plot.line(&format!("{} N, law", number(load)), &places, &law);
        }
        plot = plot.dots(&format!("{} N", number(load)), &x, &y);
    }
    let mut laws = Table::new(&[
        "load N",
        "c = a v^b: a N.s/mm",
        "b",
        "±",
        "misses %",
        "c = a + b / v: a N.s/mm",
        "b N",
        "misses %",
    ]);
    for one in &answer.over_speed {
        laws = laws.row([
            number(one.load),
            number(1e-3 * one.power[0].value),
            number(one.power[1].value),
            number(one.power[1].half_width),
            number(100.0 * one.misses[0]),
            number(1e-3 * one.hyperbola[0].value),
            number(one.hyperbola[1].value),
            number(100.0 * one.misses[1]),
        ]);
    }
    let section = section.with(plot.html()).with(table.html());
    if laws.is_empty() { section } else { section.with(laws.html()) }
}

fn notes(answer: &Answer) -> Section {
    answer.notes.iter().fold(Section::new("Notes"), |section, note| section.with(Html::text(note)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_english() {
        assert_eq!([count(1, "loop"), count(2, "loop")], ["1 loop", "2 loops"]);
        assert_eq!(count(3, "recording of decays"), "3 recordings of decays");
    }
}
