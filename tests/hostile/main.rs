//! Bytes that nobody wrote in good faith: saved states, recordings, settings, descriptions, archives.
//! Whatever comes in, there is a result or an error, soon: no panic, no hang. `sizes` has files that are long in one way,
//! `files` such that reach out of their place, `ends` what is left when the program is told to end.
//!
//! `HOSTILE_CASES=1000000 cargo test --release --test hostile` makes a long run of it; counts are in
//! docs/hostile-input.md. The calls of the C interface have a driver of their own, in
//! src/fmi/hostile.rs.
#![cfg(feature = "host")]
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../common/mod.rs"]
mod common;
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod ends;
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod files;
#[cfg(target_os = "linux")]
mod sizes;

use common::FlatTrack;
use latsch::fmi::import::{Archive, Description};
use latsch::model::{Settings, Slave};
use latsch::recording::{Channel, Recording, parse_csv, parse_rpc, parse_tydex, to_rpc};
use latsch::write_file;
use proptest::prelude::*;
use proptest::sample::Index;
use std::io::{Cursor, Write};
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use uuid::Uuid;

/// Longer than this for one case counts as hanging.
const LIMIT: Duration = Duration::from_secs(10);

/// Few enough for every day, or as many as the environment asks for.
fn config(few: u32) -> ProptestConfig {
    let cases = std::env::var("HOSTILE_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(few);
    ProptestConfig { cases, failure_persistence: None, max_shrink_time: 60_000, ..ProptestConfig::default() }
}

/// One damage to bytes.
#[derive(Debug, Clone)]
enum Damage {
    Bit(Index, u8),
    Byte(Index, u8),
    Number(Index, f64),
    Insert(Index, Vec<u8>),
    Remove(Index, usize),
    Repeat(Index, usize),
    Cut(Index),
}

fn damage(words: &'static [&'static str]) -> impl Strategy<Value = Vec<Damage>> {
    let number = prop_oneof![
        Just(0.0),
        Just(-0.0),
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(1e300),
        Just(-1e300),
        Just(5e-324),
        Just(1e-4),
        any::<f64>()
    ];
    let piece = prop_oneof![
        proptest::collection::vec(any::<u8>(), 0..12),
        proptest::sample::select(words).prop_map(|w| w.as_bytes().to_vec()),
    ];
    let one = prop_oneof![
        (any::<Index>(), 0..8_u8).prop_map(|(i, b)| Damage::Bit(i, b)),
        (any::<Index>(), any::<u8>()).prop_map(|(i, b)| Damage::Byte(i, b)),
        (any::<Index>(), number).prop_map(|(i, n)| Damage::Number(i, n)),
        (any::<Index>(), piece).prop_map(|(i, p)| Damage::Insert(i, p)),
        (any::<Index>(), 1..40_usize).prop_map(|(i, n)| Damage::Remove(i, n)),
        (any::<Index>(), 1..400_usize).prop_map(|(i, n)| Damage::Repeat(i, n)),
        any::<Index>().prop_map(Damage::Cut),
    ];
    proptest::collection::vec(one, 1..5)
}

fn apply(mut bytes: Vec<u8>, damages: &[Damage]) -> Vec<u8> {
    for damage in damages {
        let length = bytes.len();
        let at = |i: &Index| i.index(length + 1);
        match damage {
            Damage::Bit(i, bit) if length > 0 => bytes[i.index(length)] ^= 1 << bit,
            Damage::Byte(i, byte) if length > 0 => bytes[i.index(length)] = *byte,
            Damage::Number(i, number) if length >= 8 => {
                bytes[i.index(length - 7)..][..8].copy_from_slice(&number.to_le_bytes());
            }
            Damage::Insert(i, piece) => drop(bytes.splice(at(i)..at(i), piece.iter().copied())),
            Damage::Remove(i, n) => drop(bytes.drain(at(i)..(at(i) + n).min(length))),
            Damage::Repeat(i, n) => {
                let piece = bytes[at(i)..(at(i) + n).min(length)].to_vec();
                drop(bytes.splice(at(i)..at(i), piece));
            }
            Damage::Cut(i) => bytes.truncate(at(i)),
            _ => {}
        }
    }
    bytes
}

/// A tire that is quick to start.
fn rig() -> FlatTrack {
    let mut rig = FlatTrack::new(&Settings::default()).unwrap();
    common::set(
        &mut rig,
        &[("stripes", 2.0), ("bristles_per_stripe", 24.0), ("slip", 0.05), ("slip_angle", 0.02)],
    );
    rig
}

/// Saved states before, during and after initialization, between grid points, and after an error.
fn states() -> &'static [Vec<u8>] {
    static STATES: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    STATES.get_or_init(|| {
        let mut states = Vec::new();
        let mut rig = rig();
        let mut save = |rig: &mut FlatTrack| {
            let snapshot = rig.save().unwrap();
            let bytes = rig.serialize(&snapshot).unwrap();
            // what a run leads to is accepted, and is what it was
            let copy = rig.deserialize(&bytes).unwrap();
            assert_eq!(rig.serialize(&copy).unwrap(), bytes);
            states.push(bytes);
        };
        save(&mut rig);
        rig.start(0.0, None).unwrap();
        save(&mut rig);
        common::get(&mut rig, "force_z");
        save(&mut rig);
        common::set(&mut rig, &[("stripes", 3.0)]);
        save(&mut rig);
        rig.finish_start().unwrap();
        save(&mut rig);
        rig.step(0.0, 1e-3).unwrap();
        save(&mut rig);
        rig.step(1e-3, 1.3e-4).unwrap();
        save(&mut rig);
        common::set(&mut rig, &[("deflection", 0.1)]);
        assert!(rig.step(1.13e-3, 0.1).is_err());
        save(&mut rig);
        states
    })
}

/// Goes on from a state, if it is taken for one.
fn continue_from(bytes: &[u8]) -> bool {
    let mut rig = rig();
    let Ok(snapshot) = rig.deserialize(bytes) else { return false };
    rig.restore(&snapshot).unwrap();
    let _ = rig.start(0.0, None);
    let _ = rig.finish_start();
    for _ in 0..3 {
        let time = rig.time();
        let _ = rig.step(time, 1.3e-3);
        for index in 0..rig.interface().variables.len() {
            let _ = rig.get(index);
            let _ = rig.text(index);
        }
    }
    let snapshot = rig.save().unwrap();
    rig.serialize(&snapshot).unwrap();
    rig.reset().unwrap();
    true
}

fn in_time<T>(body: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = body();
    assert!(start.elapsed() < LIMIT, "took {:?}", start.elapsed());
    result
}

const CSV: &str =
    "# a comment\ntime [s],slip_angle [deg],deflection [mm]\n0,0.5,20\n0.1,\"1,5\",21\n\n0.2,-1e-3,22\n";
const CSV_WORDS: &[&str] = &[
    "\n", "\r\n", ",", ";", "\t", "\"", "NaN", "inf", "-1e999", " [", "]", "[km/h]", "time [s]", "\u{feff}",
    "é", "\0",
];
const TYDEX: &str = "**HEADER
RELEASE   Release of TYDEX-Format                 1.3
**COMMENTS
latsch: CHN00002 = \"contact_length_left\"
**CONSTANTS
LONGVEL   longitudinal velocity         km/h      80
**MEASURCHANNELS
RUNTIME   running time                  s         1         0         0
SLIPANGL  slip angle                    deg       0.5       1         -2
CHN00002  contact_length_left           m         1         0         0
**MEASURDATA
0         1.5       0.1
1.00000000-1.2345678+0.1000000
**END
";
const TYDEX_WORDS: &[&str] = &[
    "\n",
    "\r",
    "**",
    "!",
    "\t",
    " ",
    "          ",
    "NaN",
    "inf",
    "-1e999",
    "NOTAVAIL",
    "\"",
    "\\u",
    "**END\n",
    "90",
    "é",
    "\0",
];
const RPC_WORDS: &[&str] = &[
    "0",
    "-1",
    "9007199254740992",
    "18446744073709551615",
    "1e300",
    "nan",
    "0.5",
    "FLOATING_POINT\0",
    "FREQUENCY",
    "PTS_PER_GROUP\0",
    "SAMPLES\0",
    "DESC.CHAN_2\0",
    "\0",
    "\u{7f}",
];
const TOML_WORDS: &[&str] = &[
    "[parameters]",
    "[inputs]",
    "= nan",
    "inf",
    "\"",
    "'''",
    "{",
    "}",
    "[[",
    "]]",
    ".",
    "#",
    "\n",
    "slip",
    "1979-05-27",
    "\0",
];
const XML_WORDS: &[&str] = &[
    "<",
    ">",
    "</",
    "/>",
    "&amp;",
    "&#x0;",
    "&x;",
    "<!DOCTYPE a [<!ENTITY x \"y\">]>",
    "<![CDATA[",
    "]]>",
    "<!--",
    "\"",
    "valueReference=\"4294967296\"",
    "start=\"NaN\"",
    "min=\"1e999\"",
    "<Real/>",
    "<ScalarVariable>",
    "\0",
    "é",
];

/// Two channels, of which the last frame is not full.
fn rpc() -> &'static [u8] {
    static FILE: OnceLock<Vec<u8>> = OnceLock::new();
    FILE.get_or_init(|| {
        let time: Vec<f64> = (0..1100).map(|k| f64::from(k) * 1e-3).collect();
        let channels = [("force_z", 4000.0), ("rest", 0.0)].map(|(name, most)| Channel {
            name: name.into(),
            unit: "N".into(),
            values: time.iter().map(|t| most * t).collect(),
        });
        to_rpc(&Recording { time, channels: channels.into(), source: String::new() }).unwrap()
    })
}

/// Where the numbers are that the length of what is read comes from: the header's entries.
fn in_header(length: usize, damages: &[Damage]) -> Vec<u8> {
    let (header, samples) = rpc().split_at(length);
    let mut header = apply(header.to_vec(), damages);
    header.resize(length, 0);
    [&header, samples].concat()
}

fn toml() -> String {
    Settings::default().to_file(&FlatTrack::table()).unwrap()
}

fn xml() -> &'static str {
    include_str!("../../modelDescription/ring-brush-flat-track.xml")
}

fn archive() -> &'static [u8] {
    static ARCHIVE: OnceLock<Vec<u8>> = OnceLock::new();
    ARCHIVE.get_or_init(|| {
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default();
        for (name, content) in [
            ("modelDescription.xml", xml()),
            ("resources/model.toml", &toml()),
            ("binaries/linux64/ring_brush_flat_track.so", "no library"),
        ] {
            zip.start_file(name, options).unwrap();
            zip.write_all(content.as_bytes()).unwrap();
        }
        zip.finish().unwrap().into_inner()
    })
}

proptest! {
    #![proptest_config(config(300))]

    #[test]
    fn random_bytes_are_no_state(bytes in proptest::collection::vec(any::<u8>(), 0..4000)) {
        assert!(!in_time(|| continue_from(&bytes)));
    }

    #[test]
    fn damaged_states_are_refused(which in any::<Index>(), damages in damage(&["\0"])) {
        let state = which.get(states());
        let bytes = apply(state.clone(), &damages);
        assert!(&bytes == state || !in_time(|| continue_from(&bytes)));
    }

    #[test]
    fn forged_states_are_refused_or_run(which in any::<Index>(), damages in damage(&["\0", "\u{7f}"])) {
        let state = which.get(states());
        let fingerprint = Uuid::from_slice(&state[..16]).unwrap();
        let payload = apply(state[32..].to_vec(), &damages);
        let digest = Uuid::new_v5(&fingerprint, &payload);
        let bytes = [fingerprint.as_bytes(), digest.as_bytes(), payload.as_slice()].concat();
        in_time(|| continue_from(&bytes));
    }

    #[test]
    fn recordings(damages in damage(CSV_WORDS)) {
        let bytes = apply(CSV.into(), &damages);
        let _ = in_time(|| parse_csv(&String::from_utf8_lossy(&bytes), "hostile.csv"));
    }

    #[test]
    fn tydex_recordings(damages in damage(TYDEX_WORDS)) {
        let bytes = apply(TYDEX.into(), &damages);
        let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
        for text in [&text, &*String::from_utf8_lossy(&bytes)] {
            let _ = in_time(|| parse_tydex(text, "hostile.tdx"));
        }
    }

    #[test]
    fn rpc_recordings(damages in damage(RPC_WORDS), everywhere in any::<bool>()) {
        let header = 512 * 8;
        let bytes = if everywhere { apply(rpc().to_vec(), &damages) } else { in_header(header, &damages) };
        let read = in_time(|| parse_rpc(&bytes, "hostile.rsp"));
        if let Ok(recording) = read {
            // what is accepted is a recording that can be written
            assert!(recording.channels.iter().all(|c| c.values.len() == recording.time.len()));
        }
    }

    /// Any number in an entry that says how much there is.
    #[test]
    fn rpc_recordings_with_other_numbers(
        entry in proptest::sample::select(&["NUM_HEADER_BLOCKS", "NUM_PARAMS", "CHANNELS", "PTS_PER_FRAME", "PTS_PER_GROUP", "FRAMES", "SAMPLES", "DELTA_T"][..]),
        number in prop_oneof![any::<u64>().prop_map(|n| n.to_string()), any::<f64>().prop_map(|x| x.to_string()), (0..3000_u32).prop_map(|n| n.to_string())],
    ) {
        let mut bytes = rpc().to_vec();
        let place = bytes.chunks_exact(128).position(|chunk| chunk[..32].starts_with(entry.as_bytes()) && chunk[entry.len()] == 0).unwrap();
        let value = &mut bytes[place * 128 + 32..(place + 1) * 128];
        value.fill(0);
        for (to, from) in value.iter_mut().zip(number.bytes().take(95)) {
            *to = from;
        }
        let _ = in_time(|| parse_rpc(&bytes, "hostile.rsp"));
    }

    #[test]
    fn settings(damages in damage(TOML_WORDS)) {
        let text = String::from_utf8_lossy(&apply(toml().into(), &damages)).into_owned();
        in_time(|| {
            if let Ok(settings) = Settings::parse(&text, "hostile.toml") && settings.check(&FlatTrack::table()).is_ok() {
                // What is accepted is written so that it is read again.
                let file = settings.to_file(&FlatTrack::table()).unwrap();
                let again = Settings::parse(&file, "again.toml").unwrap();
                assert_eq!(again.to_file(&FlatTrack::table()).unwrap(), file);
                FlatTrack::new(&settings).unwrap();
            }
        });
    }

    #[test]
    fn descriptions(damages in damage(XML_WORDS)) {
        let bytes = apply(xml().into(), &damages);
        let _ = in_time(|| Description::parse(&bytes));
    }

    #[test]
    fn archives(damages in damage(&["PK\u{3}\u{4}", "PK\u{1}\u{2}", "PK\u{5}\u{6}", "../", "/"])) {
        let bytes = apply(archive().to_vec(), &damages);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hostile.fmu");
        write_file(&path, &bytes).unwrap();
        in_time(|| {
            if let Ok(mut archive) = Archive::open(&path) {
                if let Ok(Some(description)) = archive.read("modelDescription.xml", 1 << 20) {
                    let _ = Description::parse(&description);
                }
                let _ = archive.unpack();
            }
        });
        // nothing was written beside it
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
