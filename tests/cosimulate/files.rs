//! What the short form says, and how mistakes in it are reported.

use crate::models::{channel, run, wire};
use latsch::cosimulate::{BondKind, Plan, PlannedBond, Transfer, parse_toml, read_system, write_corrected};
use latsch::fmi::archive::ModelLibrary;
use latsch::model::Value;
use latsch::shipped::MODELS;
use std::path::Path;

const GOOD: &str = r#"
step = 1e-3
stop = 0.01
order = ["spring", "mass"]
[component.spring]
model = "spring"
set = { stiffness = 400 }
[component.mass]
model = "side"
set = { x0 = 0.1 }
[connect]
"spring.force" = "mass.force"
"mass.position" = "spring.position"
"#;

#[test]
fn mistakes_are_named_with_their_line() {
    wire(GOOD).unwrap();
    for (from, to, words) in [
        (r#""spring.force" ="#, r#""sprung.force" ="#, &["system.toml:12", "sprung", "spring, mass"][..]),
        (
            r#""spring.force" ="#,
            r#""spring.farce" ="#,
            &["system.toml:12", "farce", "did you mean \"force\""],
        ),
        (r#""spring.force" ="#, r#""spring.position" ="#, &[":12", "an input, not an output"]),
        (r#"= "mass.force""#, r#"= "mass.velocity""#, &[":12", "mass.velocity is an output, not an input"]),
        (r#"= "mass.force""#, r#"= "mass""#, &[":12", "component.variable"]),
        (r#"= "mass.force""#, r#"= ["mass.force", "mass.force"]"#, &[":12", "two sources", "spring.force"]),
        (r#"= "mass.force""#, "= 3", &[":12", "integer"]),
        (r#"= "mass.force""#, r#"= { to = "mass.force", gain = 2 }"#, &[":12", "gain"]),
        (r#"= "mass.force""#, r#"= { to = "mass.force", factor = "2" }"#, &[":12", "string"]),
        (r#"= "mass.force""#, r#"= { to = "mass.force", factor = inf }"#, &[":12", "finite"]),
        (r#""spring.force" ="#, r#""spring.moment" ="#, &[":12", "N.m cannot be converted to N", "factor"]),
        ("x0 = 0.1", "x0 = 0.1, force = 2", &[":12", "two sources", "constant value"]),
        ("x0 = 0.1", "x1 = 0.1", &[":10", "x1"]),
        ("x0 = 0.1", "mass = -1", &[":10", "mass = -1"]),
        ("x0 = 0.1", "x0 = \"0.1 kg\"", &[":10", "x0", "kg"]),
        ("x0 = 0.1", "velocity = 1", &[":10", "computed"]),
        ("[component.mass]\nmodel = \"side\"", "[component.mass]", &[":8", "model = ", "fmu = "]),
        ("model = \"side\"", "model = \"sides\"", &[":8", "sides"]),
        ("[component.mass]", "[component.\"ma.ss\"]", &[":8", "without a dot"]),
        (r#"["spring", "mass"]"#, r#"["spring"]"#, &["order", "\"mass\" is named 0 times"]),
        (
            r#"["spring", "mass"]"#,
            r#"["spring", "mass", "spring"]"#,
            &["order", "\"spring\" is named 2 times"],
        ),
        (r#"["spring", "mass"]"#, r#"["spring", "moss"]"#, &["order", "moss"]),
        ("step = 1e-3", "step = \"fast\"", &[":2", "fast"]),
        ("step = 1e-3", "steps = 1e-3", &[":2", "steps"]),
        ("order =", "record_every = -1\norder =", &[":4"]),
        ("[connect]", "[[bond]]\neffort = \"spring.force\"\n[connect]", &[":11", "flow", "displacement"]),
        (
            "[connect]",
            "[[bond]]\neffort = \"mass.reaction\"\nflow = \"mass.velocity\"\n[connect]",
            &[":11", "mass.reaction is not connected"],
        ),
        (
            "[connect]",
            "[[inputs]]\nfile = \"no.csv\"\nconnect = { a = \"mass.other_position\" }\n[connect]",
            &["no.csv"],
        ),
    ] {
        assert!(GOOD.contains(from), "{from}");
        let Err(error) = wire(&GOOD.replace(from, to)) else { panic!("{to} was accepted") };
        let message = error.to_string();
        for word in words {
            assert!(message.contains(word), "{to}\n  expected: {word}\n  message: {message}");
        }
    }
}

#[test]
fn times_that_are_missing_or_wrong_are_named() {
    for (from, to, word) in [
        ("step = 1e-3", "", "spring 0.001 s"),
        ("stop = 0.01", "", "--stop"),
        ("step = 1e-3", "step = -1e-3", "positive"),
        ("step = 1e-3", "step = nan", "positive"),
        ("stop = 0.01", "stop = -1", "after the start"),
    ] {
        let (plan, system) = wire(&GOOD.replace(from, to)).unwrap();
        let error =
            plan.experiment(&system, None, None, None).and_then(|e| e.schedule().map(|_| ())).unwrap_err();
        assert!(error.to_string().contains(word), "{to}: {error}");
    }
}

#[test]
fn values_are_converted_and_transformed_on_the_way() {
    let text = GOOD
        .replace(
            r#""spring.force" = "mass.force""#,
            r#""spring.moment" = { to = "mass.force", factor = 0.5, offset = 3 }"#,
        )
        .replace("x0 = 0.1", "x0 = \"1 dm\"");
    let (system, outcome) = run(&text);
    assert_eq!(system.warnings(), [] as [String; 0]);
    let (moment, force) = (channel(&outcome, "spring.moment"), channel(&outcome, "mass.force"));
    assert_eq!(channel(&outcome, "mass.position")[0], 0.1);
    assert!((1..10).all(|k| force[k] == 0.5 * moment[k] + 3.0));
}

#[test]
fn recorded_inputs_are_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rig.csv");
    std::fs::write(&path, "time [s],lift [mm]\n0,0\n0.004,4\n0.02,4\n").unwrap();
    let text = format!(
        "step = 1e-3\n[component.spring]\nmodel = \"spring\"\n[[inputs]]\nfile = {path:?}\nconnect = {{ lift = \"spring.position\" }}\n"
    );
    // until the recording ends
    let (_, outcome) = run(&text);
    assert_eq!(outcome.recording.time.last(), Some(&0.02));
    let (force, position) = (channel(&outcome, "spring.force"), channel(&outcome, "spring.position"));
    for k in 1..=20 {
        // what was recorded at the beginning of the interval, held
        let expected = 1e-3 * (k as f64 - 1.0).min(4.0);
        assert!((position[k] - expected).abs() < 1e-15, "{k} {}", position[k]);
        assert!((force[k] + 100.0 * expected).abs() < 1e-12);
    }
    let long = format!("stop = 0.03\n{text}");
    let (plan, mut system) = wire(&long).unwrap();
    let experiment = plan.experiment(&system, None, None, None).unwrap();
    let error = latsch::cosimulate::cosimulate(&mut system, &experiment, |_| ()).unwrap_err();
    assert!(error.to_string().contains("0 s to 0.02 s"), "{error}");
    let error = wire(&text.replace("lift =", "lyft =")).err().unwrap().to_string();
    assert!(error.contains("system.toml:4") && error.contains("lyft") && error.contains("lift"), "{error}");
}

#[test]
fn the_documentation_has_all_keys_right() {
    let plan = documented();
    assert_eq!((plan.start, plan.stop, plan.step), (Some(0.0), Some(5.0), Some(1e-4)));
    assert_eq!((plan.components.len(), plan.connections.len()), (2, 5));
    assert_eq!((plan.inputs[0].connect.len(), plan.bonds.len(), plan.record_every), (2, 1, 10));
    let usual = Transfer::default();
    let transfers: Vec<Transfer> = plan.connections.iter().map(|c| c.transfer).collect();
    let expected = [
        usual,
        usual,
        Transfer { linear: Some((-1.0, 0.0)), ..usual },
        Transfer { derivative: true, ..usual },
        Transfer { keep_units: true, ..usual },
    ];
    assert_eq!(transfers, expected);
}

/// What the documentation shows of the short form.
fn documented() -> Plan {
    let page = include_str!("../../docs/cosimulate.md");
    let form = page.split("## All of the short form").nth(1).unwrap();
    let form = form.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    parse_toml(form, "page", Path::new("")).unwrap()
}

/// The same with everything in the order of names, and without places in the file.
fn in_order(mut plan: Plan) -> Plan {
    plan.components.sort_by(|a, b| a.name.cmp(&b.name));
    for component in &mut plan.components {
        component.place.clear();
        component.set.sort_by(|a, b| a.variable.cmp(&b.variable));
        component.set.iter_mut().for_each(|a| a.place.clear());
    }
    plan.connections.sort_by_key(|c| format!("{}.{}", c.to.component, c.to.variable));
    plan.connections.iter_mut().for_each(|c| c.place.clear());
    for inputs in &mut plan.inputs {
        inputs.place.clear();
        inputs.connect.sort_by(|a, b| a.0.cmp(&b.0));
    }
    plan.bonds.iter_mut().for_each(|b| b.place.clear());
    plan
}

#[test]
fn what_is_written_says_the_same() {
    let mut plan = documented();
    plan.bonds.push(PlannedBond { kind: BondKind::Displacement, ..plan.bonds[0].clone() });
    plan.connections[0].transfer.linear = Some((0.1 + 0.2, -1e-300));
    let text = plan.to_toml(&|path| path.display().to_string());
    let again = parse_toml(&text, "page", Path::new("")).unwrap();
    assert_eq!(in_order(again), in_order(plan), "{text}");
    // files under other names
    let text = documented().to_toml(&|path| format!("elsewhere/{}", path.display()));
    assert!(text.contains("fmu = \"elsewhere/controller.fmu\""), "{text}");
    assert!(text.contains("elsewhere/tire.toml") && text.contains("elsewhere/drive.csv"), "{text}");
}

#[test]
fn a_file_without_components_is_refused() {
    let plan = parse_toml("stop = 1\nstep = 1e-3", "s.toml", Path::new("")).unwrap();
    let message = plan.load().err().unwrap().to_string();
    assert!(message.contains("s.toml") && message.contains("no components"), "{message}");
}

#[test]
fn files_that_parameters_name_go_with_a_corrected_system() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("road.csv"), "x [m],z [mm]\n0,0\n0.1,5\n0.2,0\n").unwrap();
    std::fs::write(
        at("rig.toml"),
        "[parameters]\nroad_profile = \"@road.csv\"\nstripes = 3\nfriction_sliding_zero = 0.9\n",
    )
    .unwrap();
    let text = "[component.rig]\nmodel = \"ring-brush-flat-track\"\nparameters = \"rig.toml\"\nset = { stripes = 4 }\n";
    std::fs::write(at("system.toml"), text).unwrap();
    let fitted = [("rig.friction_sliding_zero".to_owned(), 0.8)];
    let library = ModelLibrary::shipped(MODELS).unwrap();
    write_corrected(&at("system.toml"), &at("corrected"), &fitted, &[], &library).unwrap();
    // nothing outside is needed
    for name in ["road.csv", "rig.toml", "system.toml"] {
        std::fs::remove_file(at(name)).unwrap();
    }
    let plan = read_system(&at("corrected/system.toml")).unwrap().plan;
    let get = |name: &str| {
        let mut found = plan.components[0].set.iter().filter(|a| a.variable == name).map(|a| a.value.clone());
        (found.next().unwrap(), found.count())
    };
    assert_eq!(get("road_profile"), (Value::Text("0 0; 0.1 0.005; 0.2 0".into()), 0));
    assert_eq!(get("stripes"), (Value::Integer(4), 0));
    assert_eq!(get("friction_sliding_zero"), (Value::Real(0.8), 0));
    plan.load().unwrap();
}

#[test]
fn what_a_system_is_made_from_includes_its_roads() {
    let folder = tempfile::tempdir().unwrap();
    let road = folder.path().join("road.csv");
    std::fs::write(&road, "x [m],z [mm]\n0,0\n0.1,5\n").unwrap();
    let text = "[component.rig]\nmodel = \"ring-brush-flat-track\"\nset = { road_profile = \"@road.csv\" }\n";
    let plan = parse_toml(text, "system.toml", folder.path()).unwrap();
    assert_eq!(plan.files(), [road.as_path()]);
}
