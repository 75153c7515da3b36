//! The road files of the source and of Adams.

use super::*;

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
