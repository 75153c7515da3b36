//! The wired system that is believed in, as a file of `latsch cosimulate`, and what is known of each run.

use super::parameters::Parameters;
use super::programme::{DROP, FULL, KINDS, ONSET, RISE, Run, SLAB, slabs_start};
use super::world::WHEELS;

const HEAD: &str = "# A car that stops with ABS, as it is believed to be.\nstep = 1e-3\nstop = 4.0\n\
    order = [\"abs\", \"brake_fl\", \"brake_fr\", \"brake_rl\", \"brake_rr\", \"car\"]\n";

/// Key of a value: names with a dot are quoted.
fn key(name: &str) -> String {
    if name.contains('.') { format!("\"{name}\"") } else { name.to_owned() }
}

/// `system.toml`, with a friction that scatters along the road by (deviation, correlation length), on both tracks alike or not.
pub(crate) fn system(p: &Parameters, (deviation, length): (f64, f64), alike: bool) -> String {
    let named = p.named();
    let of = |component: &str| -> Vec<String> {
        let own = named.iter().filter_map(|(name, value)| {
            let name = name.strip_prefix(component)?.strip_prefix('.')?;
            Some(format!("{} = {value:?}", key(name)))
        });
        own.collect()
    };
    let mut text = HEAD.to_owned();
    let mut component = |name: &str, model: &str, set: &[String]| {
        text += &format!(
            "\n[component.{name}]\nmodel = \"{model}\"\n[component.{name}.set]\n{}\n",
            set.join("\n")
        );
    };
    let mut car = vec!["initial_speed = \"80 km/h\"".to_owned()];
    car.extend(of("car"));
    car.extend(p.dampers().map(|(name, curve)| format!("{name} = \"{curve}\"")));
    car.push(format!("road_friction_deviation = {deviation:?}"));
    car.push(format!("road_friction_correlation_length = {length:?}"));
    car.push("road_friction_seed = 1".to_owned());
    car.push(format!("road_friction_seed_right = {}", if alike { 0 } else { 2 }));
    component("car", "magic-formula-vehicle", &car);
    let mut abs = vec!["select_low = true".to_owned()];
    abs.extend(of("abs"));
    component("abs", "abs-controller", &abs);
    for (_, wheel) in WHEELS {
        let name = format!("brake_{wheel}");
        component(&name, "brake-hydraulics", &of(&name));
    }
    text += "\n[connect]\n";
    for (k, (wheel, brake)) in WHEELS.iter().enumerate() {
        let k = k + 1;
        text += &format!(
            "\"car.{wheel}.wheel_speed\" = \"abs.wheel_speed_{k}\"\n\
             \"abs.inlet_valve_{k}\" = \"brake_{brake}.inlet_valve\"\n\
             \"abs.outlet_valve_{k}\" = \"brake_{brake}.outlet_valve\"\n\
             \"brake_{brake}.brake_torque\" = \"car.{wheel}.brake_torque\"\n"
        );
    }
    let driven: Vec<String> =
        WHEELS.iter().map(|(_, brake)| format!("\"brake_{brake}.driver_pressure\"")).collect();
    text + &format!(
        "\n[[inputs]]\nfile = \"driver.csv\"\nconnect = {{ driver_pressure = [{}, \"abs.driver_pressure\"] }}\n",
        driven.join(", ")
    )
}

/// `driver.csv`: what the driver is asked to do.
pub(crate) fn driver() -> String {
    format!("time [s],driver_pressure [bar]\n0,0\n{ONSET},0\n{:?},{FULL}\n20,{FULL}\n", ONSET + RISE)
}

/// `recordings/runs.toml`: what runs are for, which repeat each other, and what is known of them beside the system.
pub(crate) fn runs(runs: &[Run]) -> String {
    let mut text = "[runs]\n".to_owned();
    for run in runs {
        let fit = KINDS.iter().any(|(kind, _, _, fit)| *kind == run.kind && *fit);
        text += &format!("\"{}\" = \"{}\"\n", run.file(), if fit { "fit" } else { "check" });
    }
    text += "\n[repeats]\n";
    for (kind, ..) in KINDS {
        let files: Vec<String> =
            runs.iter().filter(|run| run.kind == kind).map(|run| format!("\"{}\"", run.file())).collect();
        text += &format!("{kind} = [{}]\n", files.join(", "));
    }
    for run in runs {
        if run.kind == "fast" {
            text += &format!("\n[set.\"{}\"]\n\"car.initial_speed\" = \"100 km/h\"\n", run.file());
        }
        if run.slabs.is_some() {
            text += &format!(
                "\n[set.\"{}\"]\n\"car.road_kind\" = 7\n\"car.road_height\" = {DROP:?}\n\
                 \"car.road_length\" = {SLAB:?}\n\"car.road_start\" = {:?}\n",
                run.file(),
                slabs_start()
            );
        }
    }
    text
}
