//! Files written by hand after the grammar, in columns and not, with all that real files have; and there and back.

use super::*;
use crate::recording::{Channel, Recording};
use proptest::prelude::*;

/// In columns, with comments, a stray line, a constant that is an input, channels of other axes.
const RIG: &str = "\
!# a line before the file begins
**HEADER
!---------!-----------------------------!---------!---------!
RELEASE   Release of TYDEX-Format                 1.3
MEASID    Measurement id                          SWEEP_07
**COMMENTS
! New tyre
run in for 20 km
**CONSTANTS
w!--------!-----------------------------!---------!---------!
LOCATION  Location                                Prüfhalle
INFLPRES  inflation pressure            bar       2.4
INCLANGL  inclination angle             deg       -2
SLIPANGL  slip angle                    deg       SWEEP
**MEASURCHANNELS
MEASNUMB  measurement number            -         1         0         0
RUNTIME   running time                  ms        1         0         0
SLIPANGL  slip angle                    deg       0.5       0         0
TRAJVELW  trajectory velocity           km/h
FZH       vertical force, cell 3        kN        0.001     -20       0.5
FYW       lateral force                 N         1
LTFCCOEF  lateral force coefficient mean-         1         0         0
TRDTEMP   tread surface temperature     deg C     1         0         0
WHROTSPD  wheel rotation speed          1/min     1         0         0
TRCKTEMP  temperature of track          deg C     1         0         0
**MEASURDATA
1         0         2         36        4020      -150.25   -0.037    31.5      300       NOTAVAIL
2         5         -2        36.5      3.98e3    150       0.037     31.6      301.5     NOTAVAIL

3         12.5      0         36.25     0         1E-3      +.5       31.7      302       NOTAVAIL
**END
";

fn read(text: &str) -> Recording {
    parse_tydex(text, "rig.tdx").unwrap()
}

fn values<'a>(recording: &'a Recording, name: &str, unit: &str) -> &'a [f64] {
    let channel = recording.channel(name).unwrap();
    assert_eq!(channel.unit, unit, "{name}");
    &channel.values
}

#[track_caller]
fn refuse(text: &str, words: &[&str]) {
    let message = parse_tydex(text, "rig.tdx").unwrap_err().to_string();
    for word in words {
        assert!(message.contains(word), "{word:?} is not in {message:?}");
    }
}

/// A file with these channels and rows.
fn file(channels: &str, rows: &str) -> String {
    format!("**HEADER\n**MEASURCHANNELS\n{channels}\n**MEASURDATA\n{rows}\n**END\n")
}

#[test]
fn reads_names_units_and_numbers() {
    let recording = read(RIG);
    assert_eq!(recording.source, "rig.tdx");
    assert_eq!(recording.time, [0.0, 0.005, 0.0125]);
    assert_eq!(values(&recording, "slip_angle", "deg"), [1.0, -1.0, 0.0]);
    assert_eq!(values(&recording, "path_speed", "km/h"), [36.0, 36.5, 36.25]);
    assert_eq!(values(&recording, "force_z", "kN"), [4.5, 0.001 * 3960.0 + 0.5, 0.001 * -20.0 + 0.5]);
    assert_eq!(values(&recording, "wheel_speed", "rpm"), [300.0, 301.5, 302.0]);
    assert_eq!(values(&recording, "trdtemp", "degC"), [31.5, 31.6, 31.7]);
    assert_eq!(values(&recording, "ltfccoef", "-"), [-0.037, 0.037, 0.5]);
    // a force of W axes is no force of H axes
    assert_eq!(values(&recording, "fyw", "N"), [-150.25, 150.0, 0.001]);
    assert!(!recording.has("force_y"));
    // what the rig held and no channel tells
    assert_eq!(values(&recording, "camber", "deg"), [-2.0; 3]);
    // without any value
    assert!(!recording.has("trcktemp"));
    let names: Vec<&str> = recording.channels.iter().map(|c| c.name.as_str()).collect();
    let expected = "measnumb slip_angle path_speed force_z fyw ltfccoef trdtemp wheel_speed camber";
    assert_eq!(names.join(" "), expected);
}

#[test]
fn every_usual_form_gives_the_same() {
    let plain = read(&file("RUNTIME time s 1 0 0\nFXH force N 1 0 0", "0 1.5\n1 -2"));
    assert_eq!(values(&plain, "force_x", "N"), [1.5, -2.0]);
    for text in [
        file("RUNTIME   s\nFXH\tN", "0\t1.5\n1\t-2"),
        file("runtime time s 1\nfxh longitudinal force 2 N 1 0", "0 1.5\n1 -2").replace('\n', "\r\n"),
        file("RUNTIME time s 1 0 0\nFXH force N 1 0 0", "! none\n\n  0   1.5 \n1 -2.0  \n")
            .replace('\n', "\r"),
        format!("\u{feff}{}\u{1a}", file("RUNTIME time s\nFXH force N", "0 1.5\n1 -2")),
        file("RUNTIME time s\nFXH force N", "0 1.5\n1 -2").replace("**MEASURDATA", "**MeasurData  2"),
        // all characters of the fields in use, nothing between them
        file(
            "RUNTIME   time in a comment of thirty ..s         1.00000000+0.0000000-0.0000000\n\
             FXH       force                         N         1.00000000         0         0",
            "0.00000000+1.5000000\n1.00000000-2.0000000",
        ),
        file(
            "RUNTIME   time                          s                   0\n\
             FXH       Kraft für Messung in Längsrichtung 3 N 1 0 0",
            "         0       1.5\n         1        -2",
        ),
    ] {
        assert_eq!(read(&text), plain, "{text:?}");
    }
}

#[test]
fn conversions_are_what_their_names_say() {
    // factor, shift of the measured value in its own unit, shift of the physical one
    let text = file("RUNTIME - s\nFXH force N 2 10 -5\nFYH force N -1", "0 1 -0\n1 -10 3");
    let recording = read(&text);
    assert_eq!(values(&recording, "force_x", "N"), [17.0, -5.0]);
    assert_eq!(values(&recording, "force_y", "N"), [0.0, -3.0]);
    refuse(&file("RUNTIME - s\nFXH force N 0", "0 1\n1 1"), &["rig.tdx:4:FXH", "factor is 0"]);
    refuse(
        &file("RUNTIME - s\nFXH force N 1e300", "0 1\n1 1e300"),
        &["rig.tdx:7:FXH (channel 2)", "\"1e300\", converted", "not a finite"],
    );
}

#[test]
fn of_several_axis_systems_one_is_the_channel() {
    let recording = read(&file(
        "RUNTIME - s\nFX - N\nFXW - N\nFXH - N\nMXC - Nm\nMXW - Nm\nFZW - N\nFZC - N",
        "0 1 2 3 4 5 6 7\n1 1 2 3 4 5 6 7",
    ));
    for (name, value) in [
        ("force_x", 3.0),
        ("fx", 1.0),
        ("fxw", 2.0),
        ("moment_x", 4.0),
        ("mxw", 5.0),
        ("fzw", 6.0),
        ("fzc", 7.0),
    ] {
        assert_eq!(recording.channel(name).unwrap().values, [value; 2], "{name}");
    }
    assert_eq!(recording.channels.len(), 7);
    let alone = read(&file("RUNTIME - s\nFX - N", "0 1\n1 2"));
    assert_eq!(values(&alone, "force_x", "N"), [1.0, 2.0]);
}

#[test]
fn the_speed_in_the_heading_is_that_along_the_path_times_a_cosine() {
    let both = read(&file("RUNTIME - s\nLONGVEL - m/s\nSLIPANGL - deg", "0 10 0\n1 10 -60"));
    let speed = values(&both, "path_speed", "m/s");
    assert!(speed[0] == 10.0 && (speed[1] - 20.0).abs() < 1e-12, "{speed:?}");
    assert!(!both.has("longvel"));
    // the speed along the path is taken before
    let path = read(&file("RUNTIME - s\nLONGVEL - m/s\nTRAJVELW - m/s", "0 10 11\n1 10 12"));
    assert_eq!(values(&path, "path_speed", "m/s"), [11.0, 12.0]);
    assert_eq!(values(&path, "longvel", "m/s"), [10.0, 10.0]);
    let held =
        file("RUNTIME - s\nFXH - N", "0 1\n1 1").replacen("**M", "**CONSTANTS\nLONGVEL - km/h 80\n**M", 1);
    assert_eq!(values(&read(&held), "path_speed", "km/h"), [80.0, 80.0]);
    refuse(
        &file("RUNTIME - s\nLONGVEL - m/s\nSLIPANGL - deg", "0 10 0\n2 0 -90"),
        &["rig.tdx", "at 2 s", "TRAJVELW is needed"],
    );
}

#[test]
fn constants_are_for_what_no_channel_tells() {
    let with = |constants: &str| {
        let channels = "RUNTIME - s\nSLIPANGL - deg\nFYH - N";
        file(channels, "0 1 2\n1 2 3").replacen("**M", &format!("**CONSTANTS\n{constants}\n**M"), 1)
    };
    let recording = read(&with(
        "SLIPANGL slip angle deg 5\nFZH load kN 4\nFZW load kN 5\nFXH force N 6\nTRAJVELW speed km/h 90\nLONGVEL speed km/h 80",
    ));
    assert_eq!(values(&recording, "load", "kN"), [4.0; 2]);
    assert_eq!(values(&recording, "path_speed", "km/h"), [90.0; 2]);
    assert_eq!(values(&recording, "slip_angle", "deg"), [1.0, 2.0]);
    // a force that a rig gives is none that it holds
    assert_eq!(recording.channels.len(), 4);
    assert_eq!(read(&with("INCLANGL angle deg NOTAVAIL")).channels.len(), 2);
    refuse(&with("INCLANGL angle deg 1\nINCLANGL angle deg 2"), &["rig.tdx:4:INCLANGL", "twice"]);
    refuse(&with("INCLANGL angle deg zero"), &["rig.tdx:3:INCLANGL", "zero"]);
    refuse(&with("INCLANGL  angle                         deg"), &["rig.tdx:3:INCLANGL", "no number"]);
    refuse(&with("INCLANGL  angle                                   2"), &["rig.tdx:3:INCLANGL", "no unit"]);
    refuse(&with("INCLANGL angle N 2"), &["rig.tdx:3:INCLANGL", "\"N\" does not convert to \"rad\""]);
}

#[test]
fn files_that_are_no_measurements_are_refused() {
    refuse("", &["rig.tdx", "no TYDEX file", "**HEADER"]);
    refuse("time [s],a [N]\n0,1\n", &["rig.tdx:1", "no TYDEX file", "**HEADER"]);
    refuse("**CONSTANTS\n**END\n", &["rig.tdx", "**HEADER"]);
    refuse("**HEADER\n**END\n", &["rig.tdx", "no **MEASURCHANNELS"]);
    refuse("**HEADER\n**MEASURCHANNELS\nRUNTIME - s\n**END\n", &["rig.tdx", "no **MEASURDATA"]);
    let good = file("RUNTIME - s\nFXH - N", "0 1\n1 2");
    refuse(&good.replace("**END", ""), &["rig.tdx", "**END", "cut off"]);
    refuse(&good.replace("**END", "**END\n\n5 6"), &["rig.tdx:10", "behind **END"]);
    refuse(&format!("{good}{good}"), &["rig.tdx:9", "**HEADER stands in line 1", "one measurement"]);
    refuse(&good.replace("**MEASURDATA", "**DATA"), &["rig.tdx:5", "**DATA", "MEASURDATA"]);
    refuse(&good.replace("DATA", "DATA 3"), &["rig.tdx:5", "3 lines follow, but 2 do"]);
    refuse(&good.replace("CHANNELS", "CHANNELS 1"), &["rig.tdx:2", "1 lines follow, but 2 do"]);
    refuse(&file("RUNTIME - s\nFXH - N", "0 1"), &["rig.tdx", "1 row of", "at least 2"]);
    refuse(&file("FZH - N\nFXH - N", "0 1\n1 2"), &["rig.tdx", "no channel RUNTIME", "characteristic"]);
}

#[test]
fn channel_errors_say_where_and_what_to_write() {
    let with = |line: &str| file(&format!("RUNTIME - s\n{line}"), "0 1\n1 2");
    refuse(&with("FXH force"), &["rig.tdx:4", "\"force\" is not known", "write -"]);
    refuse(&with("FXH"), &["rig.tdx:4", "a unit is needed"]);
    refuse(&with("FXH force furlong 1 0 0"), &["rig.tdx:4", "furlong"]);
    refuse(&with("FXH       force                         furlong   1"), &["rig.tdx:4", "furlong"]);
    refuse(
        &with("FXH force Nm"),
        &["rig.tdx:4:FXH", "longitudinal force", "\"Nm\" does not convert to \"N\""],
    );
    refuse(&with("FXH       force                                   1"), &["rig.tdx:4:FXH", "no unit"]);
    refuse(&with("FXH       force                         N         nan"), &["rig.tdx:4", "nan"]);
    refuse(&with("w!--------!---------!"), &["rig.tdx:4", "is no name"]);
    refuse(&with("RUNTIME again s"), &["rig.tdx:4:RUNTIME", "line 3", "unique"]);
    refuse(&with("TIME other s"), &["rig.tdx:4:TIME", "the time", "leave one"]);
    refuse(&file("RUNTIME - m\nFXH - N", "0 1\n1 2"), &["rig.tdx:3:RUNTIME", "no unit of time"]);
    refuse(
        &file("RUNTIME - s\nLONGSLIP - %\nSLIP - -", "0 1 1\n1 2 2"),
        &["rig.tdx:5:SLIP", "this is slip, but so is LONGSLIP"],
    );
}

#[test]
fn number_errors_say_where() {
    let with = |row: &str| file("RUNTIME - s\nFXH - N\nFYH - N", &format!("0 1 2\n{row}\n5 6 7"));
    for (row, words) in [
        ("1 x 2", ["rig.tdx:8:FXH (channel 2)", "\"x\" is not a number"]),
        ("1 2 NaN", ["rig.tdx:8:FYH (channel 3)", "finite"]),
        ("1 -inf 2", ["rig.tdx:8:FXH", "finite"]),
        ("1 1e400 2", ["rig.tdx:8:FXH", "finite"]),
        ("1 2,5 2", ["rig.tdx:8:FXH", "decimal point"]),
        ("1 2", ["rig.tdx:8: there are 3 channels", "this row has 2"]),
        ("1 2 3 4", ["rig.tdx:8: there are 3 channels", "this row has 4"]),
        ("1 NOTAVAIL 3", ["rig.tdx:8:FXH (channel 2): NOTAVAIL", "leave out"]),
        ("NOTAVAIL 2 3", ["rig.tdx:8:RUNTIME (channel 1): NOTAVAIL", "leave out"]),
        ("1 2 ü", ["rig.tdx:8:FYH", "not a number"]),
    ] {
        refuse(&with(row), &words);
    }
    for (time, shown) in [("0.25", "0.25 s comes after 0.5 s"), ("0.5", "0.5 s comes after 0.5 s")] {
        let text = file("FXH - N\nRUNTIME - s", &format!("0 0\n0 0.5\n0 {time}"));
        refuse(&text, &["rig.tdx:8:RUNTIME (channel 2)", shown]);
    }
    // numbers without blanks between them, and one that is none: the columns go further
    refuse(
        &file("RUNTIME - s\nFXH - N", "0.00000000-12345.6789\n0.10000000-12345.678x"),
        &["rig.tdx:6", "2 channels", "has 1"],
    );
    refuse(
        &file("RUNTIME - s\nFXH - N", "0.00000000-12345.678\n0.10000000-12345.67x"),
        &["rig.tdx:7:FXH (channel 2)", "\"-12345.67x\""],
    );
}

#[test]
fn text_that_is_not_utf_8_is_latin() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("latin.tdx");
    let text = file("RUNTIME - s\nFXH Kraft für N", "0 1\n1 2");
    std::fs::write(&path, text.chars().map(|c| c as u8).collect::<Vec<u8>>()).unwrap();
    assert_eq!(values(&read_tydex(&path).unwrap(), "force_x", "N"), [1.0, 2.0]);
    let missing = folder.path().join("none").join("run.tdx");
    let message = read_tydex(&missing).unwrap_err().to_string();
    assert!(message.contains("run.tdx cannot be read"), "{message}");
    let message = write_tydex(&missing, &Recording::default()).unwrap_err().to_string();
    assert!(message.contains("run.tdx cannot be written"), "{message}");
}

#[test]
fn what_is_written_is_a_file_after_the_grammar() {
    let channel = |name: &str, unit: &str, values: [f64; 2]| Channel {
        name: name.into(),
        unit: unit.into(),
        values: values.into(),
    };
    let recording = Recording {
        time: vec![0.0, 0.01],
        channels: vec![
            channel("slip_angle", "rad", [0.1, -0.05]),
            channel("force_z", "N", [4012.5, 4013.123456789]),
            channel("load", "N", [4000.0, 4000.0]),
            channel("contact_length_center", "m", [0.1, 0.1]),
            channel("fyw", "N.m.s2/rad", [-1.0, 1.0]),
            channel("fzw", "N", [-1.0, 1.0]),
            channel("camber", "m", [0.0, 0.0]),
            channel("longvel", "m/s", [0.0, 0.0]),
        ],
        source: "ring-brush-flat-track".into(),
    };
    let text = to_tydex(&recording).unwrap();
    let expected = format!(
        "\
**HEADER
RELEASE   Release of TYDEX-Format                 1.3
MEASID    Measurement id                          ring-brush-flat-track
SUPPLIER  Data supplier                           latsch {}
**COMMENTS
latsch: CHN00004 = \"contact_length_center\"
latsch: CHN00008 = \"longvel\"
**CONSTANTS
**MEASURCHANNELS
RUNTIME   running time                  s         1         0         0
SLIPANGL  slip angle                    rad       1         0         0
FZH       vertical force                N         1         0         0
LOAD      load                          N         1         0         0
CHN00004  contact_length_center         m         1         0         0
FYW       fyw                           N.m.s2/rad 1         0         0
FZW       fzw                           N         1         0         0
CAMBER    camber                        m         1         0         0
CHN00008  longvel                       m/s       1         0         0
**MEASURDATA
0         0.1       4012.5    4000      0.1       -1        -1        0         0
0.01      -0.05     4013.123456789 4000      0.1       1         1         0         0
**END
",
        crate::VERSION
    );
    assert_eq!(text, expected);
    assert_eq!(parse_tydex(&text, "ring-brush-flat-track").unwrap(), recording);
    refuse(&text.replace("= \"longvel\"", "= longvel"), &["rig.tdx:7", "quotation marks"]);

    let odd = Recording { channels: vec![channel("a", "furlong", [0.0; 2])], ..recording.clone() };
    let message = to_tydex(&odd).unwrap_err().to_string();
    assert!(message.contains("channel \"a\"") && message.contains("furlong"), "{message}");
    let short = Recording { time: vec![0.0], ..recording };
    assert!(to_tydex(&short).unwrap_err().to_string().contains("2 values for 1 times"));
}

#[test]
fn files_go_round() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.TDX");
    let mut recording = read(RIG);
    crate::recording::write_recording(&path, &recording).unwrap();
    recording.source = path.display().to_string();
    assert_eq!(crate::recording::read_recording(&path).unwrap(), recording);
    assert!(std::fs::read_to_string(&path).unwrap().starts_with("**HEADER\n"));
}

fn any_recording() -> impl Strategy<Value = Recording> {
    let unit = prop::sample::select(vec![
        "N",
        "m/s",
        "1",
        "-",
        "%",
        "deg",
        "N.m/rad",
        "°",
        "N.m.s2/rad3",
        "rpm",
        "1/min",
    ]);
    let known = prop::sample::select(vec![
        "slip",
        "slip_angle",
        "camber",
        "force_x",
        "force_z",
        "wheel_speed",
        "path_speed",
        "longvel",
        "fx",
        "runtime",
        "chn00001",
        "CHN00002",
        "load",
        "notavail",
        "end",
        "Fxh",
    ]);
    let name = prop_oneof![
        known.prop_map(str::to_owned),
        "[a-z][a-z0-9_]{0,9}",
        "[a-zA-Zµ;,\"\\[(!*][a-zA-Z0-9 _;,\"\t\n\r\u{2028}\u{202e}\\[\\].()\\\\-]{0,40}",
    ];
    let number = || {
        prop_oneof![
            prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
            -1e3..1e3,
            (-100..100_i32).prop_map(f64::from)
        ]
    };
    (prop::collection::btree_set(name, 0..9), 2..12_usize)
        .prop_flat_map(move |(names, rows)| {
            let channel = (prop::collection::vec(number(), rows), unit.clone());
            let times = prop::collection::btree_set(-1_000_000..1_000_000_i32, rows);
            (Just(names), times, prop::collection::vec(channel, 9), 1e-7..1e-1)
        })
        .prop_map(|(names, times, channels, step)| Recording {
            time: times.into_iter().map(|n| f64::from(n) * step).collect(),
            channels: names
                .into_iter()
                .filter(|name| name != "time")
                .zip(channels)
                .map(|(name, (values, unit))| Channel { name, unit: unit.into(), values })
                .collect(),
            source: "rig.tdx".into(),
        })
}

proptest! {
    #[test]
    fn what_is_written_is_read_back(recording in any_recording()) {
        let text = to_tydex(&recording).unwrap();
        let back = parse_tydex(&text, "rig.tdx").unwrap();
        prop_assert_eq!(&back, &recording);
        // == does not see the sign of zero
        for (a, b) in back.channels.iter().zip(&recording.channels) {
            for (a, b) in a.values.iter().zip(&b.values) {
                prop_assert_eq!(a.to_bits(), b.to_bits());
            }
        }
    }
}
