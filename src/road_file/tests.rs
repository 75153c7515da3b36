//! Checks of reading and writing road files; all files are made here.

use super::*;
use crate::road::{MAX_POINTS, Road, RoadParameters};
use proptest::prelude::*;
use std::path::PathBuf;

/// The cleat of the source's second listing, with a key that nobody knows.
const CLEAT: &str = "\
$--- a comment\n\
[MDI_HEADER]\nFILE_TYPE='rdf'\nFILE_VERSION=5.00\nFILE_FORMAT='ASCII'\n(COMMENTS)\n{comment_string}\n'cleat'\n\
[UNITS]\nLENGTH='mm'\nFORCE='newton'\nANGLE='degree'\nMASS='kg'\nTIME='sec'\n\
[MODEL]\nMETHOD='USER'\nFUNCTION_NAME='ARC501'\nROAD_TYPE='poly'\n\
[GRAPHICS]\nLENGTH=160000.0\nTYPE_STEPSIZE='FLEXIBLE'\n\
[PROFILE]\n{XZ}\n-80000 0.0 0.0\n500 0.0 0.0\n550 0.0 5.0 $ up\n700 5.0\n750 0.0 0.0\n80000 0.0 0.0\n\
[OFFSET]\nX=0.0\nY=0.0\nZ=0.0\nALPHA=0.0\nBETHA=0.0\nGAMMA=0.0\n[OWN]\nKEPT = 'yes'\n";

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    fn read(&self, name: &str, content: impl AsRef<[u8]>, lanes: &Lanes) -> Result<RoadProfile> {
        read(&self.file(name, content), lanes)
    }
}

fn rdf(content: &str) -> Result<RoadProfile> {
    Folder::new().read("r.rdf", content, &Lanes::default())
}

/// A text with one piece replaced by another.
fn changed(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "{from}");
    text.replace(from, to)
}

fn refused(result: Result<RoadProfile>, words: &[&str]) {
    let message = result.unwrap_err().to_string();
    assert!(words.iter().all(|word| message.contains(word)), "{message} lacks one of {words:?}");
    assert!(message.len() < 800, "{message}");
}

/// The height of the road that a model makes of a profile.
fn height(road: &RoadProfile, x: f64, y: f64) -> f64 {
    let settings = road.settings().unwrap();
    let mut parameters = RoadParameters::flat();
    parameters.kind = 8;
    let real = |name: &str, default: f64| match settings.values.iter().find(|s| s.name == name) {
        Some(crate::model::Setting { value: crate::model::Value::Real(value), .. }) => *value,
        _ => default,
    };
    let text = |name: &str| match settings.values.iter().find(|s| s.name == name) {
        Some(crate::model::Setting { value: crate::model::Value::Text(value), .. }) => value.clone(),
        _ => String::new(),
    };
    parameters.start = real("road_start", 5.0);
    parameters.track_width = real("road_track_width", 1.5);
    parameters.lateral_position = real("road_lateral_position", 0.0);
    parameters.direction = real("road_direction", 0.0);
    parameters.spacing = real("road_spacing", 0.0);
    parameters.profile = text("road_profile");
    parameters.profile_right = text("road_profile_right");
    Road::new(&parameters).unwrap().at(x, y).height
}

#[test]
fn the_road_of_the_source_is_read_in_two_units_and_with_rows_of_two() {
    let road = rdf(CLEAT).unwrap();
    assert_eq!(road.left, [[-80.0, 0.0], [0.5, 0.0], [0.55, 0.005], [0.7, 0.005], [0.75, 0.0], [80.0, 0.0]]);
    assert!(road.right.is_none());
    for (x, z) in
        [(0.525, 0.0025), (0.55, 0.005), (0.7, 0.005), (0.725, 0.0025), (0.4, 0.0), (0.8, 0.0), (100.0, 0.0)]
    {
        assert!((height(&road, x, 0.3) - z).abs() < 1e-15, "{x}");
    }
    // what the model has no place for is named
    for word in ["[MDI_HEADER]", "[GRAPHICS]", "[OWN] KEPT"] {
        assert!(road.left_out().any(|lost| lost.contains(word)), "{word}: {road:?}");
    }
    let metres = CLEAT
        .replace("'mm'", "'meter'")
        .replace("-80000 0.0 0.0", "-80 0 0")
        .replace("500 0.0 0.0", "0.5 0 0")
        .replace("550 0.0 5.0", "0.55 0 0.005")
        .replace("700 5.0", "0.7 0.005")
        .replace("750 0.0 0.0", "0.75 0 0")
        .replace("80000 0.0 0.0", "80 0 0");
    let other = rdf(&metres).unwrap();
    for (a, b) in road.left.iter().zip(&other.left) {
        assert!((a[0] - b[0]).abs() < 1e-14 && (a[1] - b[1]).abs() < 1e-17, "{a:?} {b:?}");
    }
}

#[test]
fn an_offset_turns_and_then_shifts() {
    let road = rdf(&CLEAT.replace("X=0.0\nY=0.0\nZ=0.0", "X=1000\nY=7\nZ=20")).unwrap();
    assert_eq!(road.left[2], [1.55, 0.025]);
    let road = rdf(&CLEAT.replace("BETHA=0.0", "BETHA=10").replace("Z=0.0", "Z=20")).unwrap();
    let (sin, cos) = 10f64.to_radians().sin_cos();
    let [x, z] = road.left[2];
    assert!(
        (x - (0.55 * cos + 0.005 * sin)).abs() < 1e-14
            && (z - (0.005 * cos - 0.55 * sin + 0.02)).abs() < 1e-14
    );
    assert!(road.notes.iter().any(|note| note.contains("BETHA")));
    let road = rdf(&CLEAT.replace("GAMMA=0.0", "GAMMA=30").replace("X=0.0", "X=100")).unwrap();
    assert!((road.direction - 30f64.to_radians()).abs() < 1e-15);
    assert!((road.left[1][0] - (0.5 + 0.1 * 30f64.to_radians().cos())).abs() < 1e-15);
    refused(rdf(&CLEAT.replace("ALPHA=0.0", "ALPHA=2")), &["r.rdf:34", "[OFFSET] ALPHA"]);
}

#[test]
fn a_road_of_the_source_comes_back_with_every_byte_but_its_points() {
    let folder = Folder::new();
    let like = folder.file("like.rdf", CLEAT);
    let out = folder.0.path().join("out.rdf");
    let writing = Writing { like: Some(&like), ..Writing::default() };
    let mut road = read(&like, &Lanes::default()).unwrap();
    assert!(write(&out, &road, &writing).unwrap().is_empty());
    assert_eq!(std::fs::read_to_string(&out).unwrap(), CLEAT);
    road.left[2][1] = 0.01;
    write(&out, &road, &writing).unwrap();
    let text = std::fs::read_to_string(&out).unwrap();
    let (before, after) = CLEAT.split_once("-80000 0.0 0.0").unwrap();
    let after = after.split_once("[OFFSET]").unwrap().1;
    assert!(text.starts_with(before) && text.ends_with(after) && text.contains(" 550 0.0 10\n"), "{text}");
    assert_eq!(read(&out, &Lanes::default()).unwrap().left, road.left);
}

#[test]
fn a_file_like_another_one_has_the_direction_of_the_road() {
    let folder = Folder::new();
    let out = folder.0.path().join("out.rdf");
    let turned = CLEAT.replace("GAMMA=0.0", "GAMMA=30");
    // from another direction, from none, and with no line for it
    for (like, direction) in [
        (CLEAT.to_string(), 0.25),
        (turned.clone(), 0.25),
        (turned.clone(), 0.0),
        (CLEAT.replace("GAMMA=0.0\n", ""), -0.1),
        (CLEAT.split_once("[OFFSET]").unwrap().0.to_string(), 0.5),
    ] {
        let like = folder.file("like.rdf", like);
        let writing = Writing { like: Some(&like), ..Writing::default() };
        let mut road = RoadProfile::of("r", rdf(CLEAT).unwrap().left);
        road.direction = direction;
        for z in [0.005, 0.01] {
            road.left[2][1] = z;
            let lost = write(&out, &road, &writing).unwrap();
            assert!(lost.iter().all(|lost| !lost.contains("direction")), "{lost:?}");
            let back = read(&out, &Lanes::default()).unwrap();
            assert_eq!((back.direction, &back.left), (direction, &road.left));
        }
    }
    // an offset that would move points, seen along the new direction, is refused
    let like = folder.file("like.rdf", CLEAT.replace("Y=0.0", "Y=500"));
    let mut road = rdf(CLEAT).unwrap();
    road.direction = 0.25;
    let message =
        write(&out, &road, &Writing { like: Some(&like), ..Writing::default() }).unwrap_err().to_string();
    assert!(message.contains("[OFFSET]"), "{message}");
    // rows in a file of Adams mean nothing, so that points put there would be lost
    let like = folder.file(
        "adams.rdf",
        "[UNITS]\nLENGTH='m'\nANGLE='rad'\n[MODEL]\nMETHOD='2D'\nROAD_TYPE='flat'\n[PROFILE]\n0 0\n1 0\n",
    );
    let message =
        write(&out, &road, &Writing { like: Some(&like), ..Writing::default() }).unwrap_err().to_string();
    assert!(message.contains("METHOD = 'USER'"), "{message}");
}

#[test]
fn what_is_lost_beside_a_road_is_told_unless_the_file_is_kept() {
    let folder = Folder::new();
    let like = folder.file("like.rdf", CLEAT.replace("500 0.0 0.0", "500 3.0 0.0"));
    let out = folder.0.path().join("out.rdf");
    let mut road = read(&like, &Lanes::default()).unwrap();
    let told = |road: &RoadProfile, out: &Path, like: Option<&Path>| -> String {
        write(out, road, &Writing { like, ..Writing::default() }).unwrap().join("; ")
    };
    // the file itself
    assert_eq!(told(&road, &out, Some(&like)), "");
    // its rows are others: what stands in them and between them goes, what stands beside them stays
    road.left[2][1] = 0.01;
    let lost = told(&road, &out, Some(&like));
    assert!(lost.contains("y of [PROFILE]") && lost.contains("comments between the rows"), "{lost}");
    assert!(!lost.contains("[MDI_HEADER]") && !lost.contains("KEPT"), "{lost}");
    // like another file, or in another format, nothing of it stays
    let other = folder.file("other.rdf", CLEAT);
    for lost in [told(&road, &out, Some(&other)), told(&road, &folder.0.path().join("out.csv"), None)] {
        for word in ["y of [PROFILE]", "[MDI_HEADER]", "[GRAPHICS]", "[OWN] KEPT"] {
            assert!(lost.contains(word), "{word}: {lost}");
        }
    }
}

#[test]
fn what_a_format_does_not_know_is_refused() {
    let folder = Folder::new();
    let like = folder.file("like.rdf", CLEAT);
    let road = rdf(CLEAT).unwrap();
    let plain = Writing::default();
    for (name, writing, words) in [
        ("out.csv", Writing { adams: true, ..plain.clone() }, &["out.csv", "--adams", ".rdf"][..]),
        ("out.toml", Writing { increment: Some(0.1), ..plain.clone() }, &["out.toml", "--increment", ".crg"]),
        ("out.rdf", Writing { increment: Some(0.1), ..plain.clone() }, &["out.rdf", "--increment", ".crg"]),
        ("out.crg", Writing { like: Some(&like), ..plain.clone() }, &["out.crg", "--like", ".rdf"]),
        (
            "out.rdf",
            Writing { like: Some(Path::new("x.tir")), ..plain.clone() },
            &["--like x.tir", "out.rdf"],
        ),
        ("out.rdf", Writing { like: Some(&like), adams: true, ..plain.clone() }, &["--adams", "--like"]),
    ] {
        let path = folder.0.path().join(name);
        let message = write(&path, &road, &writing).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message} lacks one of {words:?}");
        assert!(!path.exists(), "{name}");
    }
}

#[test]
fn faults_of_a_road_name_file_line_block_and_key() {
    for (from, to, words) in [
        ("LENGTH='mm'\n", "", &["r.rdf", "[UNITS] has no LENGTH"][..]),
        ("LENGTH='mm'", "LENGTH='furlong'", &["r.rdf:10", "furlong"]),
        ("ROAD_TYPE='poly'\n", "", &["r.rdf", "[MODEL] has no ROAD_TYPE"]),
        ("METHOD='USER'\n", "", &["r.rdf", "[MODEL] has no METHOD"]),
        ("METHOD='USER'", "METHOD='3D'", &["r.rdf:16", "three dimensions"]),
        ("METHOD='USER'", "METHOD='HOUSE'", &["r.rdf:16", "HOUSE"]),
        ("ROAD_TYPE='poly'", "ROAD_TYPE='drum'", &["r.rdf:18", "rig"]),
        ("500 0.0 0.0", "900 0.0 0.0", &["r.rdf:26", "[PROFILE]", "folds back"]),
        ("500 0.0 0.0", "550 0 0\n550 0 3", &["r.rdf:27", "[PROFILE]", "third point"]),
        ("500 0.0 0.0", "550 0 0", &["r.rdf:26", "[PROFILE]", "vertical edge"]),
        ("500 0.0 0.0", "549.999 0 0", &["r.rdf:26", "[PROFILE]", "neither"]),
        ("500 0.0 0.0", "500 0,0 0", &["r.rdf:25", "[PROFILE]", "'500 0,0 0'"]),
        ("500 0.0 0.0", "500 0 0 0", &["r.rdf:25", "4 numbers"]),
        ("500 0.0 0.0", "500 0 1e999", &["r.rdf:25", "no row of numbers"]),
        ("500 0.0 0.0", "500 0 1e30", &["r.rdf:25", "roads go to"]),
        ("GAMMA=0.0", "GAMMA='x'", &["r.rdf:36", "[OFFSET] GAMMA"]),
    ] {
        refused(rdf(&changed(CLEAT, from, to)), words);
    }
    let without = CLEAT.split_once("[PROFILE]").unwrap().0;
    refused(rdf(without), &["[PROFILE] has no rows"]);
    refused(rdf("no road"), &["r.rdf"]);
}

/// A road of Adams with these lines of `[PARAMETERS]`.
fn adams(kind: &str, parameters: &str) -> Result<RoadProfile> {
    rdf(&format!(
        "[UNITS]\nLENGTH='mm'\nFORCE='newton'\nANGLE='degrees'\nMASS='kg'\nTIME='sec'\n[MODEL]\nMETHOD='2D'\nROAD_TYPE='{kind}'\n[PARAMETERS]\nOFFSET=10\nMU=0.8\n{parameters}"
    ))
}

#[test]
fn roads_of_adams_are_what_their_keys_say() {
    let plank =
        adams("plank", "HEIGHT=20\nSTART=1000\nLENGTH=100\nBEVEL_EDGE_LENGTH=5\nROTATION_ANGLE_XY_PLANE=180")
            .unwrap();
    for (x, z) in [(0.99, 0.01), (1.0, 0.025), (1.0025, 0.0275), (1.05, 0.03), (1.1, 0.01), (9.0, 0.01)] {
        assert!((height(&plank, x, 0.0) - z).abs() < 1e-9, "{x} {}", height(&plank, x, 0.0));
    }
    assert_eq!(plank.friction, [[-1e6, 0.8]]);
    assert!(plank.lost.iter().any(|lost| lost.contains("ROTATION_ANGLE_XY_PLANE")));
    let hole = adams("pot_hole", "DEPTH=50\nSTART=1000\nLENGTH=200\nDIRECTION=0.0").unwrap();
    assert!((height(&hole, 1.1, 0.0) + 0.04).abs() < 1e-15 && hole.notes[0].contains("DEPTH"));
    let ramp = adams("ramp", "HEIGHT=100\nSTART=1000\nSLOPE=0.5").unwrap();
    assert!((height(&ramp, 1.1, 0.0) - 0.06).abs() < 1e-12 && (height(&ramp, 5.0, 0.0) - 0.11).abs() < 1e-15);
    let roof = adams("roof", "HEIGHT=100\nSTART=1000\nLENGTH=400").unwrap();
    assert!((height(&roof, 1.1, 0.0) - 0.06).abs() < 1e-12);
    let sine = adams("sine", "AMPLITUDE=10\nWAVE_LENGTH=2000\nSTART=1000").unwrap();
    for i in 0..500 {
        let x = 1.0 + f64::from(i) * 0.0137;
        let exact = 0.01 + 0.01 * (std::f64::consts::PI * (x - 1.0)).sin();
        assert!((height(&sine, x, 0.0) - exact).abs() < 1.3e-6, "{x}");
    }
    let lines = adams("poly_line", "(XZ_DATA)\n{}\n 0 0 0\n 900 0 0\n 1000 100 50 ! two tracks\n").unwrap();
    assert!(
        (height(&lines, 0.95, 5.0) - 0.06).abs() < 1e-12
            && (height(&lines, 0.95, -5.0) - 0.035).abs() < 1e-12
    );
    let oblique = adams("plank", "HEIGHT=20\nSTART=1000\nLENGTH=100\nDIRECTION=30").unwrap();
    assert!(height(&oblique, 0.999, 0.0) == 0.01 && (height(&oblique, 1.001, 0.0) - 0.03).abs() < 1e-9);
    for (kind, parameters, words) in [
        ("plank", "HEIGHT=20\nSTART=1000", &["r.rdf", "[PARAMETERS]", "LENGTH"][..]),
        ("plank", "HEIGHT=2\nSTART=0\nLENGTH=100\nBEVEL_EDGE_LENGTH=5", &["bevels"]),
        ("stochastic_uneven", "", &["r.rdf:9", "stochastic_uneven", "random numbers"]),
        ("drum", "", &["r.rdf:9", "rig"]),
        ("sine_sweep", "", &["r.rdf:9", "sweep"]),
        ("castle", "", &["r.rdf:9", "castle", "poly_line"]),
        ("poly_line", "", &["(XZ_DATA)"]),
        ("poly_line", "(XZ_DATA)\n 0 0 0\n -1 0 0", &["r.rdf:15", "folds back"]),
        ("ramp", "HEIGHT=1\nSTART=0\nSLOPE=0", &["SLOPE"]),
        ("sine", "AMPLITUDE=1\nWAVE_LENGTH=0\nSTART=0", &["WAVE_LENGTH"]),
    ] {
        refused(adams(kind, parameters), words);
    }
}

/// MU of an Adams file holds everywhere: a friction that begins or changes somewhere must not become one that holds everywhere.
#[test]
fn a_friction_that_is_not_the_same_everywhere_is_told_when_adams_has_one_number() {
    let folder = Folder::new();
    let out = folder.0.path().join("out.rdf");
    let writing = Writing { adams: true, ..Writing::default() };
    let mut road = RoadProfile::of("r", vec![[0.0, 0.0], [1.0, 0.01]]);
    for (friction, mu, words) in [
        (vec![[-1e6, 0.8]], 0.8, None),
        (vec![[5.0, 0.5]], 1.0, Some("0.5 from 5 m on")),
        (vec![[-2.0, 0.5]], 0.5, Some("begins, at -2 m")),
        (vec![[-1e6, 0.8], [3.0, 0.8]], 0.8, None),
        (vec![[-1e6, 0.8], [3.0, 0.4]], 1.0, Some("changes along the road")),
        (vec![[3.0, 1.0]], 1.0, None),
        (vec![], 1.0, None),
    ] {
        road.friction = friction;
        let lost = write(&out, &road, &writing).unwrap();
        let back = read(&out, &Lanes::default()).unwrap();
        let expected = if mu == 1.0 { vec![] } else { vec![[-1e6, mu]] };
        assert_eq!(back.friction, expected, "{:?}", road.friction);
        let told: Vec<&String> = lost.iter().filter(|lost| lost.contains("friction")).collect();
        match words {
            None => assert!(told.is_empty(), "{told:?}"),
            Some(words) => assert!(told.len() == 1 && told[0].contains(words), "{told:?}"),
        }
    }
}

#[test]
fn an_angle_without_a_unit_is_told() {
    let road = rdf(&CLEAT.replace("ANGLE='degree'\n", "").replace("GAMMA=0.0", "GAMMA=0.5")).unwrap();
    assert_eq!(road.direction, 0.5);
    assert!(
        road.notes.iter().any(|note| note.contains("unit of angle; it is taken as radian")),
        "{:?}",
        road.notes
    );
    // units that no number of a road has are no matter
    let road = rdf(&changed(CLEAT, "MASS='kg'\nTIME='sec'\n", "")).unwrap();
    assert!(road.notes.is_empty(), "{:?}", road.notes);
    let plank = "[UNITS]\nLENGTH='mm'\n[MODEL]\nMETHOD='2D'\nROAD_TYPE='plank'\n[PARAMETERS]\nHEIGHT=20\nSTART=1000\nLENGTH=100\nDIRECTION=0.5\n";
    let road = rdf(plank).unwrap();
    assert!(road.notes.iter().any(|note| note.contains("unit of angle")), "{:?}", road.notes);
}

// ---- OpenCRG

/// A grid of heights with slope and banking: `z[i][j]` at u = 3 + 0.5 i and v = V[j].
const V: [f64; 4] = [-1.5, -0.5, 0.25, 1.5];

fn grid(i: usize, j: usize) -> f64 {
    // exact in four bytes and in ten characters
    f64::from(((i * 7 + j * 13) % 11) as u32) * 0.0078125 - 0.015625
}

fn slope(i: usize) -> f64 {
    if i == 0 { 0.0 } else { f64::from((i % 3) as u32) * 0.015625 }
}

fn bank(i: usize) -> f64 {
    f64::from((i % 2) as u32) * 0.03125
}

const SECTIONS: usize = 9;

/// The height at (i, v) as the standard adds it up.
fn expected(i: usize, v: f64) -> f64 {
    let j = (0..3).rev().find(|j| v >= V[*j]).unwrap();
    let share = (v - V[j]) / (V[j + 1] - V[j]);
    let line: f64 = (1..=i).map(|k| slope(k) * 0.5).sum();
    grid(i, j) + share * (grid(i, j + 1) - grid(i, j)) + line + bank(i) * v
}

/// The road as a file of a format; `hole` has no height.
fn crg(format: &str, head: &str, hole: Option<(usize, usize)>) -> Vec<u8> {
    let mut file = format!(
        "$CT ! text\nA road with an umlaut: \u{fc}\n$ROAD_CRG ! parameters\nREFERENCE_LINE_START_U = 3.0\nreference_line_end_u = 7 ! end\nREFERENCE_LINE_INCREMENT = 0.5\n* a comment\n{head}\n$!****\n$KD_Definition\n#:{format} ! format\nU:reference line u,m,3,0.5\nD:reference line slope,m/m\nD:reference line banking,m/m\nD:long section at v = 1.5,m\nD:long section at v = -1.5,m\nD:long section at v = -0.500,m ! right\nD:long section at v = 0.25,m\n$!***\n$$$$$$$$10$$$$$$$$20\n"
    )
    .into_bytes();
    let mut flat = Vec::new();
    for i in 0..SECTIONS {
        // the channels stand in another order than the positions
        let record: Vec<f64> = [slope(i), bank(i)]
            .into_iter()
            .chain([3, 0, 1, 2].map(|j| if hole == Some((i, j)) { f64::NAN } else { grid(i, j) }))
            .collect();
        let width = if format.as_bytes()[1] == b'D' { 20 } else { 10 };
        if format.ends_with("FI") {
            let field = |x: &f64| match x.is_nan() {
                true => format!("{:*^width$}", "missing"),
                false if width == 20 => format!("{x:>20.13}"),
                false => format!("{x:>10.7}"),
            };
            let fields: Vec<String> = record.iter().map(field).collect();
            if format.starts_with('L') {
                for line in fields.chunks(80 / width) {
                    file.extend(line.concat().bytes());
                    file.extend(b"\r\n");
                }
            } else {
                flat.extend(fields);
            }
        } else {
            let before = file.len();
            for x in &record {
                match width {
                    20 => file.extend(x.to_be_bytes()),
                    _ => file.extend((*x as f32).to_be_bytes()),
                }
            }
            if format.starts_with('L') {
                let length = (file.len() - before).div_ceil(80) * 80;
                file.resize(before + length, b' ');
            }
        }
    }
    for line in flat.chunks(5) {
        file.extend(line.concat().bytes());
        file.push(b'\n');
    }
    file
}

const FORMATS: [&str; 8] = ["LRFI", "LDFI", "LRBI", "LDBI", "KRFI", "KDFI", "KRBI", "KDBI"];

#[test]
fn all_forms_of_opencrg_give_the_same_two_tracks() {
    let folder = Folder::new();
    for format in FORMATS {
        let lanes = Lanes { left: Some(0.75), right: Some(-0.875) };
        let road = folder.read("r.crg", crg(format, "", None), &lanes).unwrap();
        assert_eq!(road.left.len(), SECTIONS, "{format}");
        for (i, (left, right)) in road.left.iter().zip(road.right.as_ref().unwrap()).enumerate() {
            assert_eq!([left[0], right[0]], [0.5 * i as f64; 2]);
            assert!((left[1] - expected(i, 0.75)).abs() < 1e-15, "{format} {i} {left:?}");
            assert!((right[1] - expected(i, -0.875)).abs() < 1e-15, "{format} {i} {right:?}");
        }
        // y of the model is v of the file
        assert!((height(&road, 1.5, 0.75) - expected(3, 0.75)).abs() < 1e-12, "{format}");
        assert!((height(&road, 1.5, -0.875) - expected(3, -0.875)).abs() < 1e-12, "{format}");
        for word in ["banking", "$CT", "long sections"] {
            assert!(road.lost.iter().any(|lost| lost.contains(word)), "{word}: {:?}", road.lost);
        }
    }
}

/// Programs fill files of bytes up to blocks of 80 with NaN; positions may be given by a step only.
#[test]
fn what_fills_a_binary_file_is_no_road() {
    let folder = Folder::new();
    for count in [7, 10, 13, 20] {
        let mut file = "$ROAD_CRG\nREFERENCE_LINE_INCREMENT = 0.5\nLONG_SECTION_V_INCREMENT = 0.5\nLONG_SECTION_X = 1.0+e00\n$KD_Definition\n#:KRBI\nD:long section 1,m\nD:long section 2,m\nD:long section 3,m\n$$$$\n".as_bytes().to_vec();
        let start = file.len();
        for i in 0..count {
            for j in 0..3 {
                // the last section ends with a hole of its own
                let z = if i == count - 1 && j == 2 { f32::NAN } else { (i * 3 + j) as f32 };
                file.extend(z.to_be_bytes());
            }
        }
        while !(file.len() - start).is_multiple_of(80) {
            file.extend(0xffc0_0000u32.to_be_bytes());
        }
        let road = folder.read("r.crg", &file, &Lanes { left: Some(0.5), right: Some(-0.5) }).unwrap();
        assert_eq!(road.left.len(), count, "{count}");
        assert_eq!(road.left[count - 1][1], (count * 3 - 2) as f64);
        assert_eq!(road.right.unwrap()[count - 1][1], (count * 3 - 3) as f64);
        for word in ["taken to lie about", "is taken as 1"] {
            assert!(road.notes.iter().any(|note| note.contains(word)), "{word} {:?}", road.notes);
        }
    }
}

#[test]
fn heights_that_are_missing_are_filled_as_the_file_asks_and_said() {
    let folder = Folder::new();
    let read = |head: &str, v: f64, format: &str| {
        folder.read("r.crg", crg(format, head, Some((4, 1))), &Lanes { left: Some(v), right: None })
    };
    let line: f64 = (1..=4).map(|k| slope(k) * 0.5).sum();
    for format in FORMATS {
        let road = read("", -0.5, format).unwrap();
        assert!((road.left[4][1] - (grid(4, 0) + line)).abs() < 1e-15, "{format}");
        assert!(road.notes.iter().any(|note| note.contains("1 cross sections have no height (NaN)")));
        // where no track is, it does not matter
        assert!(read("", 1.0, format).unwrap().notes.iter().all(|note| !note.contains("NaN")));
    }
    let zero = read("$ROAD_CRG_MODS\nGRID_NAN_MODE = 1\nGRID_NAN_OFFSET = 0.25", -0.5, "LDFI").unwrap();
    assert!((zero.left[4][1] - (0.25 + line)).abs() < 1e-15);
    refused(read("$ROAD_CRG_MODS\nGRID_NAN_MODE = 0", -0.5, "LDFI"), &["cross section 5", "NaN"]);
}

#[test]
fn modifiers_change_heights_and_others_are_listed() {
    let head = "$ROAD_CRG_MODS\nSCALE_Z_GRID = 2\nSCALE_SLOPE = 3\nSCALE_BANKING = 4\nSCALE_LENGTH = 2\nSCALE_WIDTH = 0.5\nREFLINE_OFFSET_Z = 0.125\nREFPOINT_X = 7\n$ROAD_CRG_OPTS\nBORDER_MODE_U = 3";
    let lanes = Lanes { left: Some(0.125), right: None };
    let road = Folder::new().read("r.crg", crg("LDFI", head, None), &lanes).unwrap();
    // v = 0.125 of half the width is section 2
    let line: f64 = (1..=5).map(|k| 3.0 * slope(k) * 1.0).sum();
    assert_eq!(road.left[5][0], 5.0);
    assert!((road.left[5][1] - (2.0 * grid(5, 2) + line + 4.0 * bank(5) * 0.125 + 0.125)).abs() < 1e-14);
    for word in ["REFPOINT_X = 7", "BORDER_MODE_U = 3"] {
        assert!(road.lost.iter().any(|lost| lost.contains(word)), "{word}: {:?}", road.lost);
    }
}

/// u of a file is where its author counts from, x of a road where the wheel starts: who goes from one to the other is told.
#[test]
fn a_road_that_does_not_begin_at_0_is_told() {
    let folder = Folder::new();
    let lanes = Lanes { left: Some(0.0), right: None };
    let road = RoadProfile::of("r", vec![[-8.0, 0.0], [0.0, 0.0], [1.0, 0.01]]);
    let path = folder.0.path().join("r.crg");
    let lost = write(&path, &road, &Writing::default()).unwrap();
    assert!(
        lost.iter().any(|lost| lost.contains("x = -8 m") && lost.contains("8 m farther ahead")),
        "{lost:?}"
    );
    let back = read(&path, &lanes).unwrap();
    assert_eq!(back.left.last(), Some(&[9.0, 0.01]));
    assert!(back.notes.iter().any(|note| note.contains("u = -8 m of the file is x = 0")), "{:?}", back.notes);
    let at_0 = RoadProfile::of("r", vec![[0.0, 0.0], [1.0, 0.01]]);
    assert!(write(&path, &at_0, &Writing::default()).unwrap().is_empty());
    // only the line for viewers says it
    let text = String::from_utf8_lossy(&crg("LDFI", "", None)).into_owned();
    let text = changed(
        &changed(&text, "REFERENCE_LINE_START_U = 3.0\n", ""),
        "reference_line_end_u = 7",
        "reference_line_end_u = 4",
    );
    let notes = folder.read("u.crg", text, &lanes).unwrap().notes;
    assert!(notes.iter().any(|note| note.contains("begins at 3 m")), "{notes:?}");
}

#[test]
fn a_file_may_refer_to_another_one() {
    let folder = Folder::new();
    folder.file("data.crg", crg("KRBI", "", None));
    let refer = "$ROAD_CRG_FILE ! where\n* a comment\n  data\n .crg\n$ROAD_CRG_MODS\nSCALE_Z_GRID = 2\n";
    let lanes = Lanes { left: Some(-1.5), right: None };
    let road = folder.read("refer.crg", refer, &lanes).unwrap();
    assert!((road.left[0][1] - 2.0 * grid(0, 0)).abs() < 1e-15);
    refused(folder.read("self.crg", "$ROAD_CRG_FILE\nself.crg\n", &lanes), &["more than 5 files"]);
    refused(folder.read("gone.crg", "$ROAD_CRG_FILE\nnowhere.crg\n", &lanes), &["gone.crg:2", "nowhere.crg"]);
    refused(folder.read("home.crg", "$ROAD_CRG_FILE\n$HOME/r.crg\n", &lanes), &["environment variable"]);
}

#[test]
fn faults_of_opencrg_are_named() {
    let folder = Folder::new();
    let lanes = Lanes { left: Some(0.0), right: None };
    let text = String::from_utf8_lossy(&crg("LDFI", "", None)).into_owned();
    let first = format!("{:>20.13}", slope(1));
    for (from, to, words) in [
        ("#:LDFI", "#:LDFX", &["r.crg:11", "$KD_DEFINITION", "LDFX"][..]),
        ("slope,m/m", "slope,m", &["r.crg:13", "m/m"]),
        ("banking,m/m", "height,m/m", &["r.crg:14", "no channel"]),
        ("at v = 1.5,m", "at v = -1.5,m", &["r.crg", "rise"]),
        ("REFERENCE_LINE_INCREMENT = 0.5", "REFERENCE_LINE_INCREMENT = x", &["r.crg:6", "'x'"]),
        ("REFERENCE_LINE_INCREMENT = 0.5", "REFERENCE_LINE_INCREMENT", &["r.crg:6", "no assignment"]),
        ("reference_line_end_u = 7", "reference_line_end_u = 70", &["9 cross sections", "cut off"]),
        ("$$$$$$$$10$$$$$$$$20", "*", &["no line $$$$"]),
        (&first, "              1,0000", &["r.crg:22", "channel 6", "'1,0000'"]),
    ] {
        let new = text.replacen(from, to, 1);
        assert_ne!(new, text, "{from}");
        refused(folder.read("r.crg", new, &lanes), words);
    }
    for format in FORMATS {
        let whole = crg(format, "", None);
        let cut = &whole[..whole.len() - 30];
        refused(folder.read("r.crg", cut, &lanes), &["cut off"]);
    }
    for (lanes, words) in [
        (Lanes { left: Some(1.6), right: None }, &["v = 1.6", "-1.5", "--left"][..]),
        (Lanes { left: Some(-1.0), right: Some(1.0) }, &["to the left of"]),
        (Lanes { left: Some(f64::NAN), right: None }, &["NaN"]),
    ] {
        refused(folder.read("r.crg", &text, &lanes), words);
    }
    refused(folder.read("r.crg", "", &lanes), &["no OpenCRG file"]);
    refused(folder.read("r.csv", "x [m],z [m]\n0,0\n1,0\n", &lanes), &["only an OpenCRG road"]);
}

// ---- between formats

#[test]
fn too_many_points_are_told_and_straight_ones_left_out() {
    let n = MAX_POINTS + 5;
    let rough = |i: usize| if i.is_multiple_of(2) { 0.0 } else { 0.001 };
    let road = RoadProfile::of("r.csv", (0..n).map(|i| [i as f64 * 0.1, rough(i)]).collect());
    let message = road.settings().unwrap_err().to_string();
    assert!(
        message.contains("r.csv") && message.contains("20005 points") && message.contains("--tolerance"),
        "{message}"
    );
    // straight: two points are left, and the height is the same
    let mut straight = RoadProfile::of("r.csv", (0..n).map(|i| [i as f64 * 0.5, i as f64 * 0.25]).collect());
    assert_eq!(straight.thin(), n - 2);
    straight.settings().unwrap();
    // an edge stays, also between level pieces
    let mut edge = RoadProfile::of("r.csv", vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.1], [2.0, 0.1], [3.0, 0.1]]);
    assert_eq!((edge.thin(), edge.left.len()), (1, 4));
}

/// Points of a track: places that rise, edges here and there.
fn points() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec((1u32..400, -500i32..500, prop::bool::weighted(0.2)), 2..30).prop_map(|steps| {
        let (mut x, mut all) = (-1.0, Vec::new());
        for (step, z, edge) in steps {
            x += f64::from(step) * 0.003;
            all.push([x, f64::from(z) * 1e-4]);
            if edge {
                all.push([x, f64::from(z) * 1e-4 + 0.01]);
            }
        }
        all
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 4, ..ProptestConfig::default() })]

    #[test]
    fn points_survive_every_format(left in points(), right in prop::option::of(points()), adams in any::<bool>()) {
        let folder = Folder::new();
        let mut road = RoadProfile::of("r", left);
        road.right = right;
        for ending in ["csv", "rdf", "toml"] {
            let path = folder.0.path().join(format!("r.{ending}"));
            let done = write(&path, &road, &Writing { adams: adams && ending == "rdf", ..Writing::default() });
            if ending == "rdf" && !adams && road.right.is_none() && road.left.windows(2).any(|pair| pair[0][0] == pair[1][0]) {
                prop_assert!(done.unwrap_err().to_string().contains("vertical edges"));
                continue;
            }
            done.unwrap();
            let back = read(&path, &Lanes::default()).unwrap();
            if road.right.is_none() && !(ending == "rdf" && adams) && ending != "toml" {
                prop_assert_eq!(&back.left, &road.left);
            }
            for i in 0..200 {
                let x = -1.5 + 0.1 * f64::from(i) + 1e-4;
                for y in [1.0, -1.0] {
                    prop_assert!((height(&back, x, y) - height(&road, x, y)).abs() < 1e-12, "{} {} {}", ending, x, y);
                }
            }
        }
    }

    /// On a grid nothing but the edges is lost; what is off is said.
    #[test]
    fn a_road_on_a_grid_survives_opencrg(z in prop::collection::vec(-0.1f64..0.1, 2..40), w in prop::collection::vec(-0.1f64..0.1, 2..40)) {
        let folder = Folder::new();
        let track = |z: &[f64]| -> Vec<[f64; 2]> { z.iter().enumerate().map(|(i, z)| [0.25 * i as f64, *z]).collect() };
        let mut road = RoadProfile::of("r", track(&z));
        road.right = Some(track(&w));
        let path = folder.0.path().join("r.crg");
        let lost = write(&path, &road, &Writing::default()).unwrap();
        let back = read(&path, &Lanes { left: Some(0.75), right: Some(-0.75) }).unwrap();
        let most = road.left.iter().zip(&back.left).map(|(a, b)| (a[1] - b[1]).abs()).fold(0.0, f64::max);
        prop_assert!(most < 1e-15, "{} {:?}", most, lost);
        prop_assert_eq!(back.left[0][0], 0.0);
    }

    #[test]
    fn a_tolerance_is_kept(left in points(), tolerance in 1e-4f64..0.05) {
        let road = RoadProfile::of("r", left);
        let mut less = road.clone();
        less.simplify(tolerance);
        for ([x, z], mut walk) in road.left.iter().zip(std::iter::repeat_with(|| super::profile::Walk::new(&less.left))) {
            let (before, behind) = walk.heights_at(*x);
            prop_assert!((before - z).abs() <= tolerance + 1e-12 || (behind - z).abs() <= tolerance + 1e-12, "{} {} {} {}", x, z, before, behind);
        }
        prop_assert_eq!(less.left.last(), road.left.last());
    }

    /// `PROPTEST_CASES=80000` for a longer look.
    #[test]
    fn any_bytes_are_a_road_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..300), at in 0usize..2000, which in 0usize..10) {
        let folder = Folder::new();
        // noise in the place of a piece of a file that is whole
        let mut file = match FORMATS.get(which) {
            Some(format) => crg(format, "", None),
            None => CLEAT.into(),
        };
        let name = if which < FORMATS.len() { "r.crg" } else { "r.rdf" };
        let at = at.min(file.len());
        let to = (at + bytes.len()).min(file.len());
        file.splice(at..to, bytes);
        match folder.read(name, &file, &Lanes::default()) {
            Ok(road) => { let _ = road.settings(); }
            Err(error) => prop_assert!(error.to_string().len() < 2000),
        }
    }
}
