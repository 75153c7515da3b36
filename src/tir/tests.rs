//! Checks of reading and writing tire property files.

use super::*;
use crate::tire::magic_formula::{Coefficients, FIELDS, Input, steady};
use proptest::prelude::*;

/// A file with everything that is met in real ones: comments, blank lines, tabs, Fortran and three-digit exponents, tables,
/// a vendor's section, keys that are commented out, `MASS` as unit and as mass.
const ODD: &str = "\
! a comment with = and [brackets]\r\n\
$-----------------------------------------------------units\r\n\
[UNITS]   $ tail\r\n\
 LENGTH ='meter'\t\r\n\
FORCE = 'newton'\r\n\
ANGLE= 'radians'  ! tail\r\n\
MASS                     ='kg'\r\n\
TIME                     = 'second  '\r\n\
\r\n\
[MAKER'S OWN]\r\n\
[MAKER]\r\n\
WHATEVER = 'it $ is'   $ not a comment inside quotes\r\n\
EMPTY =\r\n\
[model]\r\n\
fittyp = 6\r\n\
!CONTACT_MODEL='3D_ENVELOPING'\r\n\
VXLOW =1\t\t\r\n\
[DIMENSION]\r\n\
UNLOADED_RADIUS=3.3d-001 $Free radius\r\n\
[SHAPE]\r\n\
{radial width}\r\n\
 1.0    0.0\r\n\
 0.9    1.0\r\n\
[INERTIA]\r\n\
MASS = 9.3\r\n\
[VERTICAL]\r\n\
FNOMIN = 4000\r\n\
VERTICAL_STIFFNESS = 2.1E5\r\n\
[LONGITUDINAL_COEFFICIENTS]\r\n\
PCX1 = 1.6\r\n\
PDX1 = +1.1\r\n\
PKX1 = 21.\r\n\
PHX1 = -2.2142e-005\r\n\
[LATERAL_COEFFICIENTS]\r\n\
PCY1 = 1.3\r\n\
PDY1 = .95\r\n\
PKY1 = -18\r\n\
PKY2 = 1.8";

fn document(text: &str) -> Document {
    Document::parse(text, "test.tir").unwrap()
}

fn refusal(text: &str) -> String {
    match Document::parse(text, "test.tir") {
        Ok(document) => read(&document).unwrap_err().to_string(),
        Err(e) => e.to_string(),
    }
}

/// [`ODD`] with one text replaced by another.
fn changed(from: &str, to: &str) -> String {
    assert_eq!(ODD.matches(from).count(), 1, "{from}");
    ODD.replace(from, to)
}

#[test]
fn a_document_keeps_every_byte() {
    for text in
        [ODD.to_string(), ODD.replace("\r\n", "\n"), ODD.replace("\r\n", "\r"), format!("\u{feff}{ODD}\r\n")]
    {
        let document = document(&text);
        assert_eq!(document.bytes(), text.as_bytes());
        assert_eq!(read(&document).unwrap().coefficients.unloaded_radius, 0.33);
    }
}

#[test]
fn values_are_found_by_section_and_key() {
    let d = document(ODD);
    let value = |section, key| d.get(section, key).map(|e| e.value);
    assert_eq!(value("UNITS", "MASS"), Some(Value::Text("kg".into())));
    assert_eq!(value("inertia", "mass"), Some(Value::Number(9.3)));
    assert_eq!(value("MAKER", "WHATEVER"), Some(Value::Text("it $ is".into())));
    assert_eq!(value("MAKER", "EMPTY"), Some(Value::Empty));
    assert_eq!(value("MODEL", "FITTYP"), Some(Value::Number(6.0)));
    assert_eq!(value("MODEL", "CONTACT_MODEL"), None);
    assert_eq!(value("UNITS", "TIME"), Some(Value::Text("second".into())));
    assert_eq!(d.get("VERTICAL", "FNOMIN").unwrap().line, 27);
    assert_eq!(d.sections().filter(|s| *s == "SHAPE").count(), 1);
}

#[test]
fn what_a_file_lacks_and_what_is_not_used_is_listed() {
    let reading = read(&document(ODD)).unwrap();
    let c = &reading.coefficients;
    assert_eq!((c.fnomin, c.pdy1, c.phx1, c.pkx1, c.mass), (4000.0, 0.95, -2.2142e-5, 21.0, 9.3));
    // not those of the default tire: a term that the file does not have is not there, a scaling factor is 1
    assert_eq!((c.qdz1, c.lmux, c.pdy2), (0.0, 1.0, 0.0));
    assert!(["QDZ1", "LMUX", "PDY2", "LONGVL"].iter().all(|key| reading.missing.contains(key)));
    assert!(!reading.missing.contains(&"FNOMIN"));
    assert_eq!(reading.unused, ["[MAKER] WHATEVER", "[MAKER] EMPTY"]);
    assert!(
        reading.notes.iter().any(|n| n.starts_with("test.tir:10: '[MAKER'S OWN]'")),
        "{:?}",
        reading.notes
    );
}

#[test]
fn what_is_written_touches_nothing_else() {
    let mut d = document(ODD);
    let mut c = read(&d).unwrap().coefficients;
    assert_eq!(write(&c, &mut d).unwrap(), 0);
    assert_eq!(d.bytes(), ODD.as_bytes());
    c.unloaded_radius = 0.345;
    c.pky2 = 2.0;
    assert_eq!(write(&c, &mut d).unwrap(), 2);
    let expected = changed("=3.3d-001 $", "=0.345 $").replace("PKY2 = 1.8", "PKY2 = 2");
    assert_eq!(String::from_utf8_lossy(d.bytes()), expected);
    // a key that the file does not have goes to the end of its section, or of the file
    c.pdx2 = -0.05;
    c.qsy1 = 0.012;
    assert_eq!(write(&c, &mut d).unwrap(), 2);
    let text = String::from_utf8_lossy(d.bytes()).into_owned();
    let expected = expected.replace("e-005\r\n", "e-005\r\nPDX2                     = -0.05\r\n")
        + "\r\n[ROLLING_COEFFICIENTS]\r\nQSY1                     = 0.012\r\n";
    assert_eq!(text, expected);
    assert_eq!(read(&d).unwrap().coefficients, c);
}

#[test]
fn texts_and_empty_values_can_be_set() {
    let mut d = document(ODD);
    d.set_text("MAKER", "EMPTY", "no more").unwrap();
    d.set_number("model", "fittyp", 21.0).unwrap();
    let expected = changed("EMPTY =\r\n", "EMPTY ='no more'\r\n").replace("fittyp = 6", "fittyp = 21");
    assert_eq!(String::from_utf8_lossy(d.bytes()), expected);
    assert!(d.set_text("MAKER", "EMPTY", "it's").is_err());
    assert!(d.set_number("MAKER", "EMPTY", f64::NAN).is_err());
    assert!(d.set_number("MAKER", "NO=KEY", 1.0).is_err());
    assert!(d.set_number("MA]KER", "KEY", 1.0).is_err());
    assert_eq!(String::from_utf8_lossy(d.bytes()), expected);
}

/// The units of a file, and what one of each is in SI units.
const UNITS: &[([&str; 5], [f64; 5])] = &[
    (["mm", "newton", "degrees", "kg", "ms"], [1e-3, 1.0, std::f64::consts::PI / 180.0, 1.0, 1e-3]),
    (
        ["inch", "pound_force", "deg", "pound_mass", "second"],
        [0.0254, 4.4482216152605, std::f64::consts::PI / 180.0, 0.45359237, 1.0],
    ),
    (["km", "knewton", "radian", "gram", "hour"], [1e3, 1e3, 1.0, 1e-3, 3600.0]),
    (
        ["foot", "kpound_force", "RADIANS", "slug", "min"],
        [0.3048, 4448.2216152605, 1.0, 14.593902937206365, 60.0],
    ),
    (["cm", "dyne", "Degree", "g", "sec"], [1e-2, 1e-5, std::f64::consts::PI / 180.0, 1e-3, 1.0]),
    (["mile", "kg_force", "rad", "kg", "s"], [1609.344, 9.80665, 1.0, 1.0, 1.0]),
];

#[test]
fn the_same_tire_in_other_units_has_the_same_forces() {
    let c = Coefficients::default();
    let input = Input { fz: 4000.0, kappa: 0.04, alpha: -0.05, gamma: 0.03, vx: 22.0, friction: 0.9 };
    let here = steady(&c, &input);
    for (names, factors) in UNITS {
        // independent of the conversion that is tested: the dimensions are spelled out by unit
        let [length, force, angle, mass, time] = *factors;
        let mut text = format!(
            "[UNITS]\nLENGTH='{}'\nFORCE='{}'\nANGLE='{}'\nMASS='{}'\nTIME='{}'\n[MODEL]\nFITTYP=6\n",
            names[0], names[1], names[2], names[3], names[4]
        );
        for field in FIELDS {
            let factor = match field.unit {
                "m" => length,
                "N" => force,
                "kg" => mass,
                "kg.m2" => mass * length * length,
                "m/s" => length / time,
                "N/m" => force / length,
                "N.s/m" => force * time / length,
                "rad" if field.name.starts_with("ALP") || field.name.starts_with("CAM") => angle,
                _ => 1.0,
            };
            text += &format!("[{}]\n{} = {:e}\n", field.section, field.name, (field.get)(&c) / factor);
        }
        let mut document = document(&text);
        let read_c = read(&document).unwrap().coefficients;
        for field in FIELDS {
            let (a, b) = ((field.get)(&c), (field.get)(&read_c));
            assert!((a - b).abs() <= 1e-15 * a.abs() * 4.0, "{} in {names:?}: {a} {b}", field.name);
        }
        let there = steady(&read_c, &input);
        for (a, b) in [
            (here.fx, there.fx),
            (here.fy, there.fy),
            (here.mx, there.mx),
            (here.my, there.my),
            (here.mz, there.mz),
        ] {
            assert!((a - b).abs() <= 1e-12 * a.abs(), "{a} {b} in {names:?}");
        }
        // and back: what is written in these units is read as what was meant
        write(&c, &mut document).unwrap();
        let again = read(&document).unwrap().coefficients;
        for field in FIELDS {
            let (a, b) = ((field.get)(&c), (field.get)(&again));
            assert!((a - b).abs() <= 2.3e-16 * a.abs(), "{} in {names:?}: {a} {b}", field.name);
        }
    }
}

#[test]
fn units_that_do_not_belong_together_are_noted() {
    let reading = read(&document(&changed("LENGTH ='meter'", "LENGTH ='mm'"))).unwrap();
    assert_eq!(reading.coefficients.unloaded_radius, 0.33e-3);
    assert!(reading.notes.iter().any(|n| n.contains("1000.000000 times")), "{:?}", reading.notes);
    let without = read(&document(&changed("FORCE = 'newton'\r\n", ""))).unwrap();
    assert!(without.notes.iter().any(|n| n.contains("unit of force; it is taken as newton")));
}

#[test]
fn a_created_file_is_read_as_it_was_meant() {
    let mut c = Coefficients::default();
    c.phx1 = -1.0 / 3.0 * 1e-7;
    c.fzmax = 1.0 / 3.0 * 1e20;
    let d = create(&c, Some(Side::Right), "new.tir", "A tire\nof two lines").unwrap();
    let reading = read(&d).unwrap();
    assert_eq!(reading.coefficients, c);
    assert_eq!(reading.side, Some(Side::Right));
    assert!(
        reading.missing.is_empty() && reading.unused.is_empty() && reading.notes.is_empty(),
        "{reading:?}"
    );
    assert!(d.bytes().starts_with(b"$ A tire\n$ of two lines\n[MDI_HEADER]\n"));
}

#[test]
fn other_models_and_versions_are_refused_by_name() {
    for (to, what) in [
        ("fittyp = 61", "test.tir:15: FITTYP 61 is version 6.1 of the Magic Formula"),
        ("fittyp = 62", "test.tir:15: FITTYP 62 is version 6.2 of the Magic Formula"),
        ("fittyp = 7", "test.tir:15: FITTYP 7 is a version of the Magic Formula that is not modelled"),
        ("fittyp = 'x'", "test.tir:15: FITTYP is no number"),
        (
            "PROPERTY_FILE_FORMAT = 'FTIRE'",
            "test.tir:15: PROPERTY_FILE_FORMAT is 'FTIRE'; modelled is version 5.2",
        ),
        (
            "PROPERTY_FILE_FORMAT = 'USER'",
            "test.tir:15: PROPERTY_FILE_FORMAT is 'USER'; modelled is version 5.2",
        ),
        ("", "test.tir: it does not say which tire model it is for"),
    ] {
        let message = refusal(&changed("fittyp = 6", to));
        assert!(message.starts_with(what), "{message}");
    }
    for good in [
        "FITTYP=5",
        "FITTYP=21",
        "FITTYP=6\nPROPERTY_FILE_FORMAT='MF-Tyre'",
        "PROPERTY_FILE_FORMAT='PAC2002'",
        "PROPERTY_FILE_FORMAT=MF_05",
    ] {
        read(&document(&changed("fittyp = 6", good))).unwrap();
    }
}

#[test]
fn faults_are_named_with_file_and_line() {
    for (from, to, what) in [
        ("FNOMIN = 4000", "FNOMIN = 1e999", "test.tir:27: FNOMIN is too large for a number"),
        ("FNOMIN = 4000", "FNOMIN = NaN", "test.tir:27: FNOMIN is 'NaN', which is no number"),
        ("FNOMIN = 4000", "FNOMIN = 4,000", "test.tir:27: FNOMIN is '4,000', which is no number"),
        ("FNOMIN = 4000", "FNOMIN = 0", "test.tir:27: FNOMIN is 0 N; it must be more than 0"),
        ("PKY1 = -18", "PKY1 = 18", "test.tir:37: PKY1 is 18 1/rad; it must be less than 0"),
        ("PKY1 = -18", "PKY1 =", "test.tir: it has no value for [LATERAL_COEFFICIENTS] PKY1"),
        (
            "LENGTH ='meter'",
            "LENGTH ='parsec'",
            "test.tir:4: the unit of length is 'parsec', which is not known; known are m,",
        ),
        ("PCY1 = 1.3", "PCY1 = 1.3\r\nPCY1 = 1.4", "test.tir:36: PCY1 has another value than in line 35"),
    ] {
        let message = refusal(&changed(from, to));
        assert!(message.starts_with(what), "{message}");
    }
}

#[test]
fn oddities_are_noted_with_file_and_line() {
    for (from, to, what) in [
        (
            "PCY1 = 1.3",
            "PCY1 = 1.3\r\nPCY1 = 1.3",
            "test.tir:36: PCY1 stands more than once in [LATERAL_COEFFICIENTS], in the lines 35, 36",
        ),
        ("MASS = 9.3", "MASS = kg", "test.tir:25: MASS is 'kg', which is no number; no equation uses it"),
        ("PHX1 = -2.2142e-005", "PHX1 =", "test.tir:33: PHX1 is empty, as if it were not there"),
        ("PHX1 = -2.2142e-005", "PPX1 = 0.1", "test.tir:33: PPX1 = 0.1 belongs to a term that version 5.2"),
        ("VXLOW =1\t\t", "USE_MODE = 12", "test.tir:17: USE_MODE 12 asks for something else"),
        (
            "VXLOW =1\t\t",
            "FE_METHOD = 'YES'",
            "test.tir:17: the file asks for combined slip by a friction ellipse",
        ),
        ("VXLOW =1\t\t", "TYRESIDE = 'UNKNOWN'", "test.tir:17: TYRESIDE is 'UNKNOWN'"),
        ("VXLOW =1\t\t", "KPUMAX = 0", "test.tir: KPUMAX is 0, the tire was not measured at driving"),
        (
            "VXLOW =1\t\t",
            "PDX2 = 0.1",
            "test.tir:17: PDX2 stands in [MODEL] instead of [LONGITUDINAL_COEFFICIENTS]",
        ),
        ("VXLOW =1\t\t", "?", "test.tir:17: '?' is no assignment, table or comment"),
        ("VXLOW =1\t\t", "A='b", "test.tir:17: a text has no closing quote"),
        (
            "[SHAPE]",
            "[BOTTOMING_CURVE]",
            "test.tir: the table in [BOTTOMING_CURVE] is not used; the vertical force",
        ),
        ("VXLOW =1\t\t", "", "test.tir: rows that are not used stand in [SHAPE]"),
    ] {
        let notes = read(&document(&changed(from, to))).unwrap().notes;
        assert!(notes.iter().any(|n| n.starts_with(what)), "{what}: {notes:?}");
    }
}

#[test]
fn what_is_no_tire_property_file_is_refused() {
    for (bytes, what) in [
        (Vec::new(), "test.tir: it has no section"),
        (b"A = 1\nB = 2\n".to_vec(), "test.tir: it has no section"),
        (vec![0u8; 100_000], "test.tir: it has no section"),
        (vec![b'['; MAX_BYTES + 1], "test.tir: it has more than 16 MB"),
        ("A=\n".repeat(MAX_ENTRIES + 1).into_bytes(), "test.tir: it has more than 10000 assignments"),
        ("[\n".repeat(MAX_ENTRIES + 2).into_bytes(), "test.tir: it has more than 10000 sections"),
    ] {
        let error = Document::parse(bytes, "test.tir").unwrap_err().to_string();
        assert!(error.starts_with(what), "{error}");
    }
}

#[test]
fn sixteen_megabytes_of_anything_are_read_without_harm() {
    for unit in
        ["\n", "\r", "x\n", "(\n", "'\n", "$", "=", "[UNITS]", "1e999 ", "\u{0}\u{1}\n", "{", "A='", "é\n"]
    {
        let text = format!("[UNITS]\nA=1\n{}", unit.repeat((MAX_BYTES - 20) / unit.len()));
        let document = Document::parse(text.clone(), "test.tir").unwrap();
        assert!(document.bytes() == text.as_bytes());
        assert!(document.notes().len() <= 51 && document.notes().iter().all(|n| n.message.len() < 300));
        let error = read(&document).unwrap_err().to_string();
        assert!(error.len() < 1000, "{error}");
    }
}

proptest! {
    #[test]
    fn any_bytes_are_kept_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let mut bytes = bytes;
        bytes.extend_from_slice(b"\n[UNITS]\nA=1");
        let document = Document::parse(bytes.clone(), "test.tir").unwrap();
        prop_assert_eq!(document.bytes(), bytes.as_slice());
        let _ = read(&document);
    }

    #[test]
    fn any_lines_are_kept_and_changed_only_where_asked(
        lines in prop::collection::vec("[ A-Z='$!\\[\\](){}0-9.e\t+-]{0,20}(\r\n|\n|\r)", 0..30),
        number in any::<f64>().prop_filter("finite", |x| x.is_finite()),
    ) {
        let text = format!("{}\n[ZZ]\nKEY9 = 12 $ tail\n{}", lines.concat(), lines.concat());
        let mut document = Document::parse(text.clone(), "test.tir").unwrap();
        prop_assert_eq!(document.bytes(), text.as_bytes());
        let _ = read(&document);
        if document.all("ZZ", "KEY9").len() == 1 {
            document.set_number("ZZ", "KEY9", number).unwrap();
            prop_assert_eq!(document.get("ZZ", "KEY9").unwrap().value, Value::Number(number));
            let (before, after) = text.split_once("KEY9 = 12 $ tail").unwrap();
            let new = document.bytes();
            let end = format!(" $ tail{after}");
            prop_assert!(new.starts_with(before.as_bytes()) && new.ends_with(end.as_bytes()));
        }
    }

    #[test]
    fn every_number_is_written_so_that_it_is_read_again(number in any::<f64>()) {
        match super::document::number_text(number) {
            Some(text) => {
                let document = Document::parse(format!("[A]\nB={text}"), "test.tir").unwrap();
                prop_assert_eq!(document.get("A", "B").unwrap().value, Value::Number(number));
            }
            None => prop_assert!(!number.is_finite()),
        }
    }
}
