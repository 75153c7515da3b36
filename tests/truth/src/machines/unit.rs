//! A machine as an FMU of somebody else: C that is written for it, compiled by the system's compiler, and no code of latsch.

use super::mechanism::{Element, GRAVITY, Machine, Sensor};
use super::view::{IDLE, View};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;

/// The FMI functions, the same for all machines.
const FUNCTIONS: &str = include_str!("unit.c");

/// Writes the FMU of a machine with the parameters that its builder believes in, as it is told in a view.
///
/// # Errors
/// No C compiler, or a place that cannot be written.
pub fn write(machine: &Machine, name: &str, start: &[f64], view: View, to: &Path) -> Result<(), String> {
    let place = |e: std::io::Error| format!("{}: {e}", to.display());
    let folder = to.with_extension("build");
    std::fs::create_dir_all(&folder).map_err(place)?;
    let (source, library) = (folder.join("unit.c"), folder.join("unit.so"));
    std::fs::write(&source, self::source(machine, name, start, view)).map_err(place)?;
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let done = Command::new(&compiler)
        .args(["-O2", "-ffp-contract=off", "-shared", "-fPIC", "-o"])
        .args([&library, &source])
        .arg("-lm")
        .output()
        .map_err(|e| format!("{compiler}: {e}"))?;
    if !done.status.success() {
        return Err(format!("{compiler}: {}", String::from_utf8_lossy(&done.stderr)));
    }
    let mut zip = zip::ZipWriter::new(std::fs::File::create(to).map_err(place)?);
    let options = zip::write::SimpleFileOptions::default();
    let entries = [
        ("modelDescription.xml".to_owned(), description(machine, name, start, view).into_bytes()),
        (format!("binaries/linux64/{name}.so"), std::fs::read(&library).map_err(place)?),
    ];
    for (entry, bytes) in entries {
        zip.start_file(entry, options).map_err(|e| e.to_string())?;
        zip.write_all(&bytes).map_err(place)?;
    }
    zip.finish().map_err(|e| e.to_string())?;
    std::fs::remove_dir_all(&folder).map_err(place)
}

fn source(machine: &Machine, name: &str, start: &[f64], view: View) -> String {
    let list = |values: &[f64]| {
        let all: Vec<String> = values.iter().map(|v| format!("{v:e}")).collect();
        if all.is_empty() { "0".to_owned() } else { all.join(", ") }
    };
    let mut text = String::from("#include <math.h>\n");
    let counts = [
        ("PARAMETERS", machine.parameters.len()),
        ("INPUTS", machine.inputs.len()),
        ("STATES", machine.states()),
        ("OUTPUTS", machine.outputs.len()),
    ];
    for (what, count) in counts {
        let _ = writeln!(text, "#define {what} {count}");
    }
    let _ = writeln!(text, "#define LONGEST {:e}", machine.time / 40.0);
    let _ = writeln!(text, "#define GUID \"{name}\"");
    let _ = writeln!(text, "static const double start_values[] = {{{}}};", list(start));
    let (inputs, outputs) = view.factors(machine);
    let _ = writeln!(text, "static const double input_factors[] = {{{}}};", list(&inputs));
    let _ = writeln!(text, "static const double output_factors[] = {{{}}};", list(&outputs));
    let _ = writeln!(text, "#define SLOWER {:e}", view.time());
    let (n, stores) = (machine.bodies.len(), machine.stores.len());
    text += "static void slope(const double *p, const double *u, const double *x, double *dx) {\n";
    let _ = writeln!(text, "    double f[{}] = {{0}}, q[{}] = {{0}}, e;", n.max(1), stores.max(1));
    for element in &machine.elements {
        let _ = writeln!(text, "    e = {};", effort(machine, *element));
        let others = |text: &mut String, array: &str, from: usize, to: Option<usize>| {
            let _ = writeln!(text, "    {array}[{from}] -= e;");
            if let Some(to) = to {
                let _ = writeln!(text, "    {array}[{to}] += e;");
            }
        };
        match *element {
            Element::Spring { from, to, .. }
            | Element::Cubic { from, to, .. }
            | Element::Damper { from, to, .. }
            | Element::Orifice { from, to, .. } => others(&mut text, "f", from, to),
            Element::Gravity { body, .. } | Element::Push { body, .. } | Element::Shaken { body, .. } => {
                others(&mut text, "f", body, None);
            }
            Element::Motor { body, current, input, inductance, resistance, constant } => {
                others(&mut text, "f", body, None);
                let (i, w) = (machine.other(current), machine.velocity(body));
                let _ = writeln!(
                    text,
                    "    dx[{i}] = (u[{input}] - p[{resistance}] * x[{i}] - p[{constant}] * x[{w}]) / p[{inductance}];"
                );
            }
            Element::Cylinder { body, pressure, input, time, .. } => {
                others(&mut text, "f", body, None);
                let k = machine.other(pressure);
                let _ = writeln!(text, "    dx[{k}] = (u[{input}] - x[{k}]) / p[{time}];");
            }
            Element::Inflow { store, .. } => others(&mut text, "q", store, None),
            Element::Conductance { from, to, .. } | Element::Outlet { from, to, .. } => {
                others(&mut text, "q", from, to);
            }
        }
    }
    for b in 0..n {
        let _ =
            writeln!(text, "    dx[{b}] = x[{}], dx[{}] = f[{b}] / p[{}];", n + b, n + b, machine.bodies[b]);
    }
    for s in 0..stores {
        let _ = writeln!(text, "    dx[{}] = q[{s}] / p[{}];", machine.store(s), machine.stores[s]);
    }
    text += "    (void)f, (void)q, (void)u;\n}\n";
    text += "static void begin(const double *p, const double *u, double *x) {\n    double s;\n";
    text += "    for (int k = 0; k < STATES; k++) x[k] = 0;\n";
    for element in machine.elements.iter().rev() {
        match *element {
            Element::Conductance { from, to, conductance } => {
                let after = to.map_or("0".to_owned(), |t| format!("x[{}]", machine.store(t)));
                let _ = writeln!(text, "    x[{}] = u[0] / p[{conductance}] + {after};", machine.store(from));
            }
            Element::Outlet { from, area, .. } => {
                let _ = writeln!(
                    text,
                    "    s = u[0] / p[{area}], x[{}] = s * s / {};",
                    machine.store(from),
                    2.0 * GRAVITY
                );
            }
            _ => {}
        }
    }
    text += "    (void)p, (void)u, (void)s;\n}\n";
    text += "static void measure(const double *p, const double *u, const double *x, double *y) {\n";
    text += "    double dx[STATES + 1];\n    slope(p, u, x, dx);\n";
    for (k, (_, sensor)) in machine.outputs.iter().enumerate() {
        let shown = match *sensor {
            Sensor::State(s) => format!("x[{s}]"),
            Sensor::Rate(s) => format!("dx[{s}]"),
            Sensor::Force(e) => effort(machine, machine.elements[e]),
        };
        let _ = writeln!(text, "    y[{k}] = {shown};");
    }
    text + "}\n" + FUNCTIONS
}

/// What an element gives, as C.
fn effort(machine: &Machine, element: Element) -> String {
    let between = |from: usize, to: Option<usize>| match to {
        Some(to) => format!("(x[{from}] - x[{to}])"),
        None => format!("x[{from}]"),
    };
    let speed =
        |from: usize, to: Option<usize>| between(machine.velocity(from), to.map(|t| machine.velocity(t)));
    let level = |from: usize, to: Option<usize>| between(machine.store(from), to.map(|t| machine.store(t)));
    match element {
        Element::Spring { from, to, stiffness } => format!("p[{stiffness}] * {}", between(from, to)),
        Element::Cubic { from, to, stiffness } => format!("p[{stiffness}] * pow({}, 3)", between(from, to)),
        Element::Damper { from, to, damping } => format!("p[{damping}] * {}", speed(from, to)),
        Element::Orifice { from, to, damping } => {
            let v = speed(from, to);
            format!("p[{damping}] * {v} * fabs({v})")
        }
        Element::Gravity { body, moment } => format!("p[{moment}] * sin(x[{body}])"),
        Element::Push { input, .. } | Element::Inflow { input, .. } => format!("-u[{input}]"),
        Element::Shaken { body, input, stiffness } => format!("p[{stiffness}] * (x[{body}] - u[{input}])"),
        Element::Motor { current, constant, .. } => format!("-p[{constant}] * x[{}]", machine.other(current)),
        Element::Cylinder { pressure, area, .. } => format!("-p[{area}] * x[{}]", machine.other(pressure)),
        Element::Conductance { from, to, conductance } => {
            format!("p[{conductance}] * {}", level(from, to))
        }
        Element::Outlet { from, area, .. } => {
            format!("p[{area}] * sqrt({} * fmax(x[{}], 0))", 2.0 * GRAVITY, machine.store(from))
        }
    }
}

fn description(machine: &Machine, name: &str, start: &[f64], view: View) -> String {
    let units: std::collections::BTreeSet<&str> = machine
        .parameters
        .iter()
        .map(|p| p.unit)
        .chain(machine.inputs.iter().map(|v| v.unit))
        .chain(machine.outputs.iter().map(|(v, _)| v.unit))
        .chain(view.has_idle().then_some(IDLE.1))
        .collect();
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"{name}\" \
         guid=\"{name}\" generationTool=\"a machine of no one's choosing\" numberOfEventIndicators=\"0\">\n  \
         <CoSimulation modelIdentifier=\"{name}\" canHandleVariableCommunicationStepSize=\"true\" \
         canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\" \
         canNotUseMemoryManagementFunctions=\"true\"/>\n  <UnitDefinitions>\n"
    );
    for unit in units {
        let _ = writeln!(text, "    <Unit name=\"{unit}\"/>");
    }
    text += "  </UnitDefinitions>\n  <ModelVariables>\n";
    let mut reference = 0;
    let mut variable = |text: &mut String, name: &str, unit: &str, rest: &str, start: Option<f64>| {
        let start = start.map_or(String::new(), |v| format!(" start=\"{v:e}\""));
        let _ = writeln!(
            text,
            "    <ScalarVariable name=\"{name}\" valueReference=\"{reference}\" {rest}><Real unit=\"{unit}\"{start}/></ScalarVariable>"
        );
        reference += 1;
    };
    for (p, value) in machine.parameters.iter().zip(start) {
        variable(&mut text, &p.name, p.unit, "causality=\"parameter\" variability=\"tunable\"", Some(*value));
    }
    for input in &machine.inputs {
        variable(
            &mut text,
            &input.name,
            input.unit,
            "causality=\"input\" variability=\"continuous\"",
            Some(0.0),
        );
    }
    for (output, _) in &machine.outputs {
        let rest = "causality=\"output\" variability=\"continuous\"";
        variable(&mut text, &output.name, output.unit, rest, None);
    }
    if view.has_idle() {
        variable(&mut text, IDLE.0, IDLE.1, "causality=\"input\" variability=\"continuous\"", Some(0.0));
    }
    text += "  </ModelVariables>\n  <ModelStructure><Outputs>\n";
    let before = machine.parameters.len() + machine.inputs.len();
    for k in 0..machine.outputs.len() {
        let _ = writeln!(text, "    <Unknown index=\"{}\"/>", before + k + 1);
    }
    text += "  </Outputs><InitialUnknowns>\n";
    for k in 0..machine.outputs.len() {
        let _ = writeln!(text, "    <Unknown index=\"{}\"/>", before + k + 1);
    }
    text + "  </InitialUnknowns></ModelStructure>\n</fmiModelDescription>\n"
}

#[cfg(test)]
mod tests {
    use super::super::draw::draw;
    use super::super::world::{Course, Run, World};
    use super::*;
    use crate::programme::Wave;
    use crate::random::Random;
    use std::process::Stdio;

    /// Reads lines of a step and the inputs in its middle and at its end, and says the outputs.
    const MAIN: &str = r#"
#include <stdio.h>
int main(void) {
    void *unit = fmi2Instantiate("unit", 1, GUID, "", NULL, 0, 0);
    unsigned inputs[INPUTS], outputs[OUTPUTS];
    double step, middle[INPUTS], end[INPUTS], y[OUTPUTS];
    for (unsigned k = 0; k < INPUTS; k++) inputs[k] = PARAMETERS + k;
    for (unsigned k = 0; k < OUTPUTS; k++) outputs[k] = PARAMETERS + INPUTS + k;
    for (int row = 0; scanf("%lf", &step) == 1; row++) {
        for (int k = 0; k < INPUTS; k++) if (scanf("%lf", &middle[k]) != 1) return 1;
        for (int k = 0; k < INPUTS; k++) if (scanf("%lf", &end[k]) != 1) return 1;
        fmi2SetReal(unit, inputs, INPUTS, middle);
        if (row) fmi2DoStep(unit, 0, step, 0);
        fmi2SetReal(unit, inputs, INPUTS, end);
        if (!row) fmi2ExitInitializationMode(unit);
        fmi2GetReal(unit, outputs, OUTPUTS, y);
        for (int k = 0; k < OUTPUTS; k++) printf("%.17g ", y[k]);
    }
    return 0;
}
"#;

    /// What the C code answers to inputs (middle and end of each step).
    fn answers(machine: &Machine, steps: &str) -> Vec<f64> {
        let folder = tempfile::tempdir().unwrap();
        let (file, program) = (folder.path().join("unit.c"), folder.path().join("unit"));
        std::fs::write(&file, source(machine, "unit", &machine.values(), View::Same) + MAIN).unwrap();
        let built =
            Command::new("cc").args(["-O1", "-o"]).args([&program, &file]).arg("-lm").status().unwrap();
        assert!(built.success());
        let mut child = Command::new(&program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut input = child.stdin.take().unwrap();
        let text = steps.to_owned();
        // beside the reading: pipes are short
        let writer = std::thread::spawn(move || input.write_all(text.as_bytes()).unwrap());
        let output = child.wait_with_output().unwrap();
        writer.join().unwrap();
        String::from_utf8(output.stdout).unwrap().split_whitespace().map(|v| v.parse().unwrap()).collect()
    }

    #[test]
    fn the_unit_and_the_truth_are_one_machine() {
        let (mut worst, mut elements) = (0.0_f64, std::collections::BTreeSet::new());
        for seed in 0..16 {
            let mut random = Random::new(seed, 77);
            let (machine, drives) = draw(&mut random);
            let name = |e: &Element| format!("{e:?}").split(' ').next().unwrap().to_owned();
            elements.extend(machine.elements.iter().map(name));
            const PARTS: usize = 20;
            let (interval, samples) = (machine.time / 5.0, 200);
            let course = |drive: &super::super::draw::Drive| Course {
                wave: Wave::Sines(vec![[0.6 * drive.amplitude, 1.1, 0.4], [0.3 * drive.amplitude, 2.3, 1.0]]),
                middle: drive.middle,
            };
            let run = Run {
                number: 0,
                time: (0..samples).map(|k| interval * k as f64).collect(),
                inputs: drives.iter().map(course).collect(),
            };
            let at = |t: f64| {
                run.inputs.iter().map(move |c| c.middle + c.wave.at(t / machine.time)).collect::<Vec<f64>>()
            };
            let mut steps = String::new();
            for k in 0..=(samples - 1) * PARTS {
                let (end, step) = (interval * k as f64 / PARTS as f64, interval / PARTS as f64);
                let row = [vec![step], at(if k == 0 { 0.0 } else { end - 0.5 * step }), at(end)].concat();
                steps += &row.iter().map(|v| format!("{v:e} ")).collect::<String>();
            }
            let answers = answers(&machine, &steps);
            let outputs = machine.outputs.len();
            // a filter that hides nothing
            let world = World {
                parameters: machine.values(),
                concealed: Vec::new(),
                filter: 1e-6 * interval,
                machine: machine.clone(),
            };
            let (ideal, _) = world.run(&run, false);
            for (c, truth) in ideal.outputs.iter().enumerate() {
                let unit = answers.chunks(outputs).step_by(PARTS).map(|row| row[c]);
                let size = truth.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                let error = unit.zip(truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                worst = worst.max(error / size);
                assert!(error < 1e-3 * size, "{seed}: {} {}", machine.outputs[c].0.name, error / size);
            }
        }
        // means over steps of a hundredth of the natural time: an error of second order, and not zero
        assert!(worst > 1e-9, "{worst}");
        assert!(elements.len() >= 11, "{elements:?}");
    }
}
