//! Checks of reading and writing property files of the super-elastic tire.

use super::super_elastic::{create, read, write};
use super::*;
use crate::model::{Causality, Setting, Settings, Value as Model};
use proptest::prelude::*;

/// What the source prints, but for comments.
const PRINTED: &str = "\
[MDI_HEADER]\n FILE_TYPE = 'tir'\n FILE_VERSION = 2.0\n FILE_FORMAT = 'ASCII'\n\
(COMMENTS)\n{comment_string}\n'Pressure - Vollgummi'\n\
[UNITS]\nLENGTH = 'mm'\nFORCE = 'newton'\nANGLE = 'degree'\nMASS = 'kg'\nTIME = 'sec'\n\
[MODEL]\n! use mode      1   2\nPROPERTY_FILE_FORMAT = 'USER'\nFUNCTION_NAME = 'TYR501'\nNUM_INT_METHODE = 'DOPRI5'\n\
SIM_TIME = 20.0\nSIM_STEPSIZE = 0.0007\nUSE_MODE = 2.00\nFREE_ROLL = 0.0\n\
[DIMENSION]\nUNLOADED_RADIUS = 226.5\nWIDTH = 187.0\nWEIGHT = 26.1\nASPECT_RATIO = 0.66\n\
[RIM]\nWEIGHT_RIM = 6.3\nNUM_RIM = 1\nRADIUS_RIM = 102.2\n\
[CONTACTELEMENT]\nNUM_CE = 45\nLEN_CE = 5\nANG_INSIDE_CE = 1\nDIS_LAYER = 10\nNUM_LAYER = 1\n\
[PARAMETER]\nRADIAL_NONLINEAR = 'yes'\nRADIAL_STIFFNESS = 122\nRADIAL_DAMPING = 0.28\nROLLING_RESISTANCE = 0.010\n\
COR_FACTOR_RSTIFF = 2.1\nCSLIP = 5\nUMIN = 0.85\nUMAX = 0.94\nREL_LEN_LON = 10\n\
[CONTACT_COEFFICIENTS]\nCONTACT_MODEL = 'fml_imp'\nSTIFFNESS = 35000.0\nDAMPING = 0.7\nMU = 0.9\nPENETRATION = 0.1\nEXPONENT = 1.9\n";

fn document(text: &str) -> Document {
    Document::parse(text, "se.tir").unwrap()
}

/// [`PRINTED`] with one text replaced by another.
fn changed(from: &str, to: &str) -> String {
    assert_eq!(PRINTED.matches(from).count(), 1, "{from}");
    PRINTED.replace(from, to)
}

/// [`PRINTED`] in other units: (length, its m), (force, its N), (angle, its degrees), (mass, its kg), (time, its s).
fn in_units([length, force, angle, mass, time]: [(&str, f64); 5]) -> String {
    let mut text = String::new();
    for line in PRINTED.lines() {
        let Some((key, value)) = line.split_once(" = ") else {
            text += &format!("{line}\n");
            continue;
        };
        let (l, f, t) = (length.1 / 1e-3, force.1, time.1);
        let factor = match key {
            "LENGTH" | "FORCE" | "ANGLE" | "MASS" | "TIME" => {
                let units =
                    [("LENGTH", length), ("FORCE", force), ("ANGLE", angle), ("MASS", mass), ("TIME", time)];
                let name = units.iter().find(|(unit, _)| *unit == key).unwrap().1.0;
                text += &format!("{key} = '{name}'\n");
                continue;
            }
            "UNLOADED_RADIUS" | "WIDTH" | "RADIUS_RIM" | "LEN_CE" | "DIS_LAYER" | "REL_LEN_LON"
            | "PENETRATION" => l,
            "WEIGHT" | "WEIGHT_RIM" => mass.1,
            "ANG_INSIDE_CE" => angle.1,
            "RADIAL_STIFFNESS" => f / l,
            "RADIAL_DAMPING" | "DAMPING" => f * t / l,
            "STIFFNESS" => f / l.powf(1.9),
            _ => {
                text += &format!("{line}\n");
                continue;
            }
        };
        text += &format!("{key} = {:e}\n", value.parse::<f64>().unwrap() / factor);
    }
    text
}

fn value(settings: &Settings, name: &str) -> f64 {
    match settings.values.iter().find(|s| s.name == name).map(|s| &s.value) {
        Some(Model::Real(value)) => *value,
        Some(Model::Integer(value)) => f64::from(*value),
        other => panic!("{name}: {other:?}"),
    }
}

fn settings(values: &[(&str, f64)]) -> Settings {
    let values = values.iter().map(|(name, value)| Setting {
        name: (*name).into(),
        value: Model::Real(*value),
        causality: Causality::Parameter,
        place: "p.toml:2".into(),
    });
    Settings { values: values.collect(), ..Settings::default() }
}

#[test]
fn the_printed_file_is_read_as_the_specification_says() {
    let (read, notes) = read(&document(PRINTED)).unwrap();
    for (name, expected) in [
        ("tire_radius", 0.2265),
        ("tire_width", 0.187),
        ("elements", 45.0),
        ("element_thickness", 0.005),
        ("gap_angle", 1f64.to_radians()),
        ("rubber_mass", 19.8),
        ("element_radial_stiffness", 122e3),
        ("element_radial_damping", 280.0),
        ("rolling_resistance", 0.010),
        ("slip_stiffness", 5000.0),
        ("friction_min", 0.85),
        ("friction_max", 0.94),
        ("relaxation_length", 0.01),
        ("contact_stiffness", 35000.0),
        ("contact_damping", 700.0),
        ("contact_full_damping", 1e-4),
        ("contact_exponent", 1.9),
    ] {
        assert!((value(&read, name) / expected - 1.0).abs() < 1e-15, "{name} {}", value(&read, name));
    }
    // the factor is one on a curve that the file does not carry
    assert!(read.values.iter().all(|s| s.name != "stiffness_factor" && s.name != "stiffness_law"));
    for words in [
        "se.tir:39: RADIAL_NONLINEAR is 'yes', but such a file carries no curve",
        "COR_FACTOR_RSTIFF = 2.1, a factor on that curve only, is not used",
        "6.3 kg belong to the hub",
        "CSLIP = 5 is taken as kN",
        "DIS_LAYER",
        "NUM_LAYER",
        "SIM_TIME",
        "SIM_STEPSIZE",
        "USE_MODE",
        "FREE_ROLL",
        "MU (",
    ] {
        assert!(notes.iter().any(|note| note.contains(words)), "{words}: {notes:?}");
    }
}

#[test]
fn other_units_are_the_same_physics() {
    let (here, _) = read(&document(PRINTED)).unwrap();
    for units in [
        [("m", 1.0), ("newton", 1.0), ("radian", 180.0 / std::f64::consts::PI), ("kg", 1.0), ("sec", 1.0)],
        [("inch", 0.0254), ("kN", 1e3), ("deg", 1.0), ("g", 1e-3), ("ms", 1e-3)],
    ] {
        let text = in_units(units);
        let mut document = document(&text);
        let (there, _) = read(&document).unwrap();
        assert_eq!(here.values.len(), there.values.len());
        for setting in &here.values {
            let (a, b) = (value(&here, &setting.name), value(&there, &setting.name));
            assert!((a - b).abs() <= 1e-14 * a.abs(), "{} {a} {b} {units:?}", setting.name);
        }
        // back in the units of this file, with nothing changed: no byte
        assert_eq!(write(&there, &mut document).unwrap().0, 0, "{units:?}");
        assert_eq!(document.bytes(), text.as_bytes());
    }
}

#[test]
fn writing_changes_values_only_and_says_what_has_no_key() {
    let text = changed("NUM_LAYER = 1\n", "NUM_LAYER = 1 $ kept\nMAKER'S = 'x'\nOWN_KEY = 7\n");
    let mut d = document(&text);
    let own = settings(&[
        ("element_radial_stiffness", 151_105.0),
        ("rubber_mass", 20.0),
        ("contact_points", 1.0),
        ("relaxing_stiffness", 5e4),
        ("stiffness_factor", 1.5),
        ("hub_mass", 200.0),
    ]);
    let mut own = own;
    own.values[2].value = Model::Integer(1);
    let (count, lost) = change(&mut d, &own).unwrap();
    assert_eq!(count, 4);
    let expected = text
        .replace("RADIAL_STIFFNESS = 122", "RADIAL_STIFFNESS = 151.105")
        .replace("WEIGHT = 26.1", "WEIGHT = 26.3")
        .replace("COR_FACTOR_RSTIFF = 2.1", "COR_FACTOR_RSTIFF = 1.5")
        .replace("OWN_KEY = 7\n", "OWN_KEY = 7\nNUM_CP                   = 1\n");
    assert_eq!(String::from_utf8_lossy(d.bytes()), expected);
    assert_eq!(lost.len(), 3, "{lost:?}");
    assert_eq!(lost[2], "what is no parameter of a super-elastic tire: hub_mass");
    assert!(
        lost[0].starts_with("relaxing_stiffness = 50000") && lost[1].starts_with("stiffness_factor = 1.5")
    );
    let (back, _) = read(&d).unwrap();
    assert_eq!(value(&back, "element_radial_stiffness"), 151_105.0);
    assert_eq!(value(&back, "contact_points"), 1.0);
    assert!((value(&back, "rubber_mass") - 20.0).abs() < 1e-14);
}

/// Values of another tire would all be left aside, and the file would be that of a tire that nobody meant.
#[test]
fn a_file_of_another_tire_is_refused() {
    let magic = Document::parse(
        "[UNITS]\nLENGTH='m'\nFORCE='N'\nANGLE='rad'\nMASS='kg'\nTIME='s'\n[MODEL]\nFITTYP=6\n",
        "mf.tir",
    );
    let (radial, pacejka, rig) = (("element_radial_stiffness", 1.5e5), ("PDX1", 1.1), ("hub_mass", 200.0));
    for (mut d, own, words) in [
        (
            document(PRINTED),
            &[pacejka, rig][..],
            &["p.toml:2", "PDX1", "Magic Formula", "se.tir", "super-elastic"][..],
        ),
        (document(PRINTED), &[radial, pacejka], &["PDX1"]),
        (
            magic.unwrap(),
            &[radial],
            &["element_radial_stiffness", "super-elastic tire", "mf.tir", "Magic Formula"],
        ),
        (document(PRINTED), &[rig], &["p.toml:2", "hub_mass", "se.tir", "super-elastic"]),
    ] {
        let before = d.bytes().to_vec();
        let message = change(&mut d, &settings(own)).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message} lacks one of {words:?}");
        assert_eq!(d.bytes(), before);
    }
    // nor is a tire with nothing but defaults made of it
    let message = create_super_elastic(&settings(&[pacejka]), None, "new.tir", "").unwrap_err().to_string();
    assert!(message.contains("PDX1") && message.contains("new.tir"), "{message}");
    // no values are no other tire's
    assert_eq!(change(&mut document(PRINTED), &Settings::default()).unwrap(), (0, vec![]));
}

#[test]
fn a_table_that_is_not_used_is_told() {
    let (_, notes) =
        read(&document(&format!("{PRINTED}[SHAPE]\n{{radial width}}\n1.0 0.0\n0.9 1.0\n"))).unwrap();
    assert!(notes.iter().any(|note| note == "se.tir: rows that are not used stand in [SHAPE]"), "{notes:?}");
}

#[test]
fn a_file_from_nothing_is_the_default_tire() {
    let (read, _) = read(&create("new.tir", "A tire").unwrap()).unwrap();
    let table = <crate::tire::super_elastic::SuperElastic as crate::tire::Tire>::rows().infos();
    for setting in &read.values {
        let start = table.iter().find(|info| info.name == setting.name).unwrap().start.clone().unwrap();
        let expected = match start {
            Model::Real(value) => value,
            Model::Integer(value) => f64::from(value),
            other => panic!("{other:?}"),
        };
        assert!((value(&read, &setting.name) / expected - 1.0).abs() < 1e-15, "{}", setting.name);
    }
}

#[test]
fn faults_are_named_with_file_line_and_key() {
    for (from, to, what) in [
        ("UNLOADED_RADIUS = 226.5\n", "", "se.tir: it has no value for [DIMENSION] UNLOADED_RADIUS"),
        ("UMAX = 0.94", "UMAX =", "se.tir: it has no value for [PARAMETER] UMAX"),
        ("LENGTH = 'mm'", "LENGTH = 'parsec'", "se.tir:9: the unit of length is 'parsec'"),
        ("NUM_CE = 45", "NUM_CE = 45.5", "se.tir:33: NUM_CE is 45.5; it is a whole number"),
        ("NUM_CE = 45", "NUM_CE = -1", "se.tir:33: NUM_CE cannot be used: elements = -1"),
        ("NUM_CE = 45", "NUM_CE = 1e300", "se.tir:33: NUM_CE is 1"),
        ("RADIAL_STIFFNESS = 122", "RADIAL_STIFFNESS = 1,22", "se.tir:40: RADIAL_STIFFNESS is '1,22'"),
        ("RADIAL_STIFFNESS = 122", "RADIAL_STIFFNESS = 1e999", "se.tir:40: RADIAL_STIFFNESS is too large"),
        ("RADIAL_STIFFNESS = 122", "RADIAL_STIFFNESS = -1", "se.tir:40: RADIAL_STIFFNESS cannot be used"),
        ("RADIAL_NONLINEAR = 'yes'", "RADIAL_NONLINEAR = 'ja'", "se.tir:39: RADIAL_NONLINEAR is 'ja'"),
        ("CONTACT_MODEL = 'fml_imp'", "CONTACT_MODEL = 'hertz'", "se.tir:49: CONTACT_MODEL is 'hertz'"),
        ("UMIN = 0.85", "UMIN = 0.85\nUMIN = 0.8", "se.tir:46: UMIN has another value than in line 45"),
        ("WEIGHT = 26.1", "WEIGHT = 6.1", "se.tir:26: WEIGHT = 6.1 less WEIGHT_RIM = 6.3"),
        ("EXPONENT = 1.9", "EXPONENT = 0.5", "se.tir:54: EXPONENT cannot be used"),
    ] {
        let message = read(&document(&changed(from, to))).unwrap_err().to_string();
        assert!(message.starts_with(what), "{message}");
    }
    for (from, to, what) in [
        (
            "UMIN = 0.85",
            "UMIN = 0.85\nROT_CE_STIFFNESS = 3",
            "se.tir:46: ROT_CE_STIFFNESS belongs to springs that turn",
        ),
        (
            "UMIN = 0.85",
            "UMIN = 0.85\nUNHEARD = 3",
            "se.tir: [PARAMETER] has a key that the model does not use: UNHEARD",
        ),
        (
            "RADIAL_NONLINEAR = 'yes'",
            "RADIAL_NONLINEAR = 'no'",
            "se.tir:43: COR_FACTOR_RSTIFF = 2.1 is not used",
        ),
    ] {
        let notes = read(&document(&changed(from, to))).unwrap().1;
        assert!(notes.iter().any(|note| note.starts_with(what)), "{what}: {notes:?}");
    }
}

#[test]
fn the_kind_of_a_file_is_what_it_says() {
    for (text, kind) in [
        (PRINTED.into(), Kind::SuperElastic),
        (changed("FUNCTION_NAME = 'TYR501'", "FUNKTION_NAME = 'se::tyr501'"), Kind::SuperElastic),
        (changed("FUNCTION_NAME = 'TYR501'", "FUNCTION_NAME = 'TYR900'"), Kind::MagicFormula),
        // a user's routine of that name with coefficients of the Magic Formula
        (changed("FUNCTION_NAME = 'TYR501'", "FUNCTION_NAME = 'TYR501'\nFITTYP = 6"), Kind::MagicFormula),
        (changed("'USER'", "'PAC2002'"), Kind::MagicFormula),
    ] {
        assert_eq!(Kind::of(&document(&text)), kind, "{text}");
    }
}

proptest! {
    /// Whatever is written is read again as it was meant, to the last bit but for what rounding of a unit leaves.
    #[test]
    fn what_is_written_is_read(
        radius in 0.1f64..1.0, stiffness in 1e3f64..1e7, damping in 0.0f64..1e4, slip in 1e2f64..1e5,
        length in 1e-3f64..1.0, contact in 1e2f64..1e8, exponent in 1.0f64..3.0, mass in 0.1f64..100.0, metres in any::<bool>(),
    ) {
        let text = if metres { in_units([("m", 1.0), ("newton", 1.0), ("radian", 57.29577951308232), ("kg", 1.0), ("sec", 1.0)]) } else { PRINTED.into() };
        let mut d = document(&text);
        let own = settings(&[
            ("tire_radius", radius), ("element_radial_stiffness", stiffness), ("element_radial_damping", damping),
            ("slip_stiffness", slip), ("relaxation_length", length), ("contact_stiffness", contact),
            ("contact_exponent", exponent), ("rubber_mass", mass),
        ]);
        write(&own, &mut d).unwrap();
        let (back, _) = read(&d).unwrap();
        for setting in &own.values {
            let (a, b) = (value(&own, &setting.name), value(&back, &setting.name));
            prop_assert!((a - b).abs() <= 3e-16 * a.abs() + if setting.name == "rubber_mass" { 1e-14 } else { 0.0 }, "{} {a} {b}", setting.name);
        }
        prop_assert_eq!(d.sections().count(), document(PRINTED).sections().count());
    }
}
