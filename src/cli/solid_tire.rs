//! `latsch solid-tire`: stiffness and damping of a solid tire from loops and decays.

use super::{Format, check_outputs, print, print_json_text, warn};
use latsch::characteristic::laws::Known;
use latsch::characteristic::{Answer, Coefficient, Plan, characterize, parameters};
use latsch::model::Settings;
use latsch::report::{characteristic_report, write_html};
use latsch::tir::create_super_elastic;
use latsch::{Error, Result, read_text, write_file};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Find stiffness and damping of a solid tire from force-deflection loops and from decays after a cleat
///
/// The plan names recordings, channels, and what is known of tire and rig: docs/solid-tire.md. What recordings cannot tell is
/// refused with the reason.
#[derive(clap::Args)]
pub struct Args {
    /// The plan
    #[arg(value_name = "PLAN.toml")]
    plan: PathBuf,
    /// Parameters to write: TOML for `latsch export` and `latsch simulate` on the super-elastic models, with intervals
    #[arg(long, short, value_name = "F.toml")]
    output: PathBuf,
    /// Property file of the super-elastic tire to write
    #[arg(long, value_name = "F.tir")]
    tir: Option<PathBuf>,
    /// Page to write: loops with their laws, decays with envelopes, tables over load, speed and number of elements
    #[arg(long, value_name = "F.html")]
    report: Option<PathBuf>,
    /// All numbers to write as JSON
    #[arg(long, value_name = "F.json")]
    json: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

pub fn run(args: &Args) -> Result<()> {
    let text = read_text(&args.plan)?;
    let plan = Plan::read(&text).map_err(|e| e.at(args.plan.display()))?;
    let folder = args.plan.parent().map(Path::to_path_buf).unwrap_or_default();
    let recordings: Vec<PathBuf> = plan
        .loops
        .iter()
        .map(|l| &l.file)
        .chain(plan.decays.iter().map(|d| &d.file))
        .map(|file| folder.join(file))
        .collect();
    let read: Vec<&Path> = std::iter::once(&args.plan).chain(&recordings).map(PathBuf::as_path).collect();
    let others = [&args.tir, &args.report, &args.json].into_iter().flatten();
    let outputs: Vec<&Path> = std::iter::once(&args.output).chain(others).map(PathBuf::as_path).collect();
    check_outputs(&outputs, &read)?;
    let answer = characterize(&plan, &folder).map_err(|e| e.at(args.plan.display()))?;
    let json = serde_json::to_string_pretty(&answer).map_err(|e| Error::file(e.to_string()))?;
    let parameters = parameters(&plan, &answer)?;
    let property_file =
        args.tir.as_ref().map(|file| property_file(&plan, &answer, &parameters, file)).transpose()?;
    write_file(&args.output, parameters.as_bytes())?;
    if let (Some(file), Some((bytes, lost))) = (&args.tir, &property_file) {
        write_file(file, bytes)?;
        for what in lost {
            warn(&format!("{}: it has no place for {what}", file.display()));
        }
    }
    if let Some(file) = &args.report {
        write_html(file, &characteristic_report(&answer))?;
    }
    if let Some(file) = &args.json {
        write_file(file, json.as_bytes())?;
    }
    match args.format {
        Format::Json => print_json_text(&json),
        Format::Text => print(&told(&answer)),
    }
}

/// The property file of the parameters that are written, and what it has no place for.
fn property_file(
    plan: &Plan,
    answer: &Answer,
    parameters: &str,
    file: &Path,
) -> Result<(Vec<u8>, Vec<String>)> {
    let name = file.display().to_string();
    let settings = Settings::parse(parameters, &name)?;
    let rim = plan.rim_mass()?;
    let (mut document, lost) = create_super_elastic(&settings, rim, &name, &answer.title)?;
    if let [_, Some(radius)] = plan.width_and_rim_radius()? {
        // the file is in millimetres
        document.set_number("RIM", "RADIUS_RIM", 1e3 * radius)?;
    }
    Ok((document.bytes().to_vec(), lost))
}

fn told(answer: &Answer) -> String {
    let mut text = String::new();
    for one in &answer.loops {
        let analysis = &one.analysis;
        let _ = writeln!(
            text,
            "loop {}: {} cycles of {:.3} s, {:.2} to {:.2} mm, {:.0} to {:.0} N",
            one.file,
            analysis.cycles,
            analysis.period,
            1e3 * analysis.deflections[0],
            1e3 * analysis.deflections[1],
            analysis.loads[0],
            analysis.loads[1]
        );
        if let Some(fit) = analysis.forms.first() {
            let _ =
                writeln!(text, "    closest law: {:?}, leaves {:.0} N, R2 {:.5}", fit.form, fit.rmse, fit.r2);
        }
        let _ = writeln!(
            text,
            "    loses {:.1} J a cycle; equivalent damping {:.0} N.s/m, of an element {:.1} N.s/m; loss angle {:.2} deg",
            analysis.area.value,
            analysis.equivalent_damping.value,
            one.element_damping.value,
            analysis.loss_angle.to_degrees()
        );
        tell(&mut text, &analysis.notes);
    }
    for one in &answer.decays {
        let analysis = &one.analysis;
        let _ = writeln!(
            text,
            "decay {}: {:.0} N, {:.2} m/s, {} periods of {:.3} s: {:.3} Hz, decay rate {} 1/s (envelope {:.3}), {:.1} % left; c of the tire {:.0} N.s/m, of an element {:.1} N.s/m",
            one.file,
            one.load,
            one.speed,
            analysis.periods,
            analysis.period,
            analysis.frequency.value / std::f64::consts::TAU,
            with_interval(analysis.decay_rate),
            analysis.envelope_rate.value,
            100.0 * analysis.left,
            one.damping.value,
            one.element.value
        );
        tell(&mut text, &analysis.notes);
    }
    coefficient(&mut text, "element_radial_stiffness", "N/m", &answer.stiffness);
    coefficient(&mut text, "element_radial_damping", "N.s/m", &answer.damping);
    tell(&mut text, &answer.notes);
    text.trim_end().to_owned()
}

fn coefficient(text: &mut String, name: &str, unit: &str, c: &Coefficient) {
    let law = format!("{:?}", c.law).to_lowercase();
    let _ = writeln!(text, "{name} = {} {unit}, {law}: {}", with_interval(c.value), c.why);
    for (of, exponent) in [("load", c.load_exponent), ("speed", c.speed_exponent)] {
        if let Some(exponent) = exponent {
            let _ = writeln!(text, "    exponent of the {of}: {}", with_interval(exponent));
        }
    }
}

fn with_interval(known: Known) -> String {
    match known.half_width.is_finite() {
        true => format!("{:.4} +- {:.2e}", known.value, known.half_width),
        false => format!("{:.4}", known.value),
    }
}

fn tell(text: &mut String, notes: &[String]) {
    for note in notes {
        let _ = writeln!(text, "    note: {note}");
    }
}
