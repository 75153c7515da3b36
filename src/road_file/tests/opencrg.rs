//! OpenCRG: its forms, what is missing in them, what modifies them.

use super::*;

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
pub(super) fn crg(format: &str, head: &str, hole: Option<(usize, usize)>) -> Vec<u8> {
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

pub(super) const FORMATS: [&str; 8] = ["LRFI", "LDFI", "LRBI", "LDBI", "KRFI", "KDFI", "KRBI", "KDBI"];

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
