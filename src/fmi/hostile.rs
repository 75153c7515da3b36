//! A master out of its mind: any sequence of calls of the C interface, with any values, and saved
//! states from anywhere. Pointers are valid or null; that is all it keeps to.
//!
//! `HOSTILE_CASES=100000 cargo test --release --lib hostile` makes a long run of it.

use super::c::Fmi;
use super::c::{CallbackFunctions, Component, FmuState, Status, Text};
use super::entry::{Entry, guid};
use super::export;
use super::export3;
use super::state::Function;
use crate::model::Settings;
use crate::rig::RingBrushFlatTrack;
use proptest::prelude::*;
use proptest::sample::Index;
use std::ffi::{CString, c_char, c_int, c_void};
use std::path::Path;
use std::ptr::{null, null_mut};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

const MODELS: &[Entry] = &[Entry::of::<RingBrushFlatTrack>()];

/// Not variadic, unlike the type of a logger; our own never passes further arguments. The type of
/// messages is counted where `environment` points.
unsafe extern "C" fn logger(environment: *mut c_void, _: Text, status: c_int, _: Text, message: Text) {
    assert!(!message.is_null());
    // SAFETY: the environment is the counter that outlives the instance.
    let counts = unsafe { &mut *environment.cast::<[u32; 6]>() };
    counts[status as usize] += 1;
}

/// The same for FMI 3.0.
unsafe extern "C" fn logger3(environment: *mut c_void, status: c_int, category: Text, message: Text) {
    // SAFETY: the caller's promise.
    unsafe { logger(environment, null(), status, category, message) }
}

/// The resources of a tire that is quick to start, and its GUID.
fn fmu() -> &'static (tempfile::TempDir, CString, CString) {
    static FMU: OnceLock<(tempfile::TempDir, CString, CString)> = OnceLock::new();
    FMU.get_or_init(|| {
        let table = (MODELS[0].table)();
        let settings =
            Settings::parse("[parameters]\nstripes = 2\nbristles_per_stripe = 40", "test").unwrap();
        let text = settings.to_file(&table).unwrap();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("model.toml"), &text).unwrap();
        let location = |p: &Path| CString::new(crate::fmi::import::slave::file_uri(p)).unwrap();
        let location = location(folder.path());
        (folder, location, CString::new(guid(&table, &text)).unwrap())
    })
}

#[derive(Debug, Clone)]
enum Call {
    Setup(f64, Option<f64>, Option<f64>),
    Plain(u8),
    GetReal(Vec<u32>),
    GetInteger(Vec<u32>),
    GetBoolean(Vec<u32>),
    GetString(Vec<u32>),
    SetReal(Vec<(u32, f64)>),
    SetInteger(Vec<(u32, i32)>),
    SetBoolean(Vec<(u32, i32)>),
    SetString(u32, Option<CString>),
    Rates(Vec<(u32, i32, f64)>),
    /// From where the last step ended, or from anywhere.
    Step(Option<f64>, f64),
    Save(Index),
    Restore(Index),
    Free(Index),
    /// Through bytes, with too little room or not, one byte changed or not, and then a digest that fits or not.
    Serialize {
        slot: Index,
        at: Index,
        bits: u8,
        less: usize,
        forged: bool,
    },
    Deserialize(Index, Vec<u8>),
    Logging(c_int, Vec<CString>),
    Status(u8, c_int),
    NotOffered(u8),
    /// Arrays at null.
    Nulls(u8),
}

/// Value references, most of them of variables that there are.
fn reference() -> impl Strategy<Value = u32> {
    prop_oneof![8 => 0..90_u32, 1 => any::<u32>()]
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -0.1..0.1_f64, 2 => 0.0..30.0_f64, 1 => Just(0.0), 1 => Just(f64::NAN), 1 => Just(f64::INFINITY),
        1 => Just(1e300), 1 => any::<f64>()
    ]
}

fn length() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => Just(1e-3), 3 => Just(1e-4), 3 => 1e-6..2e-3_f64, 1 => Just(0.0), 1 => Just(-1e-3), 1 => Just(f64::NAN),
        1 => Just(1e-30), 1 => Just(f64::INFINITY), 1 => Just(1e9)
    ]
}

fn call() -> impl Strategy<Value = Call> {
    use proptest::collection::vec;
    let text = || {
        prop_oneof![Just("logAll"), Just("logEvents"), Just("%s%n#r1#"), Just("")]
            .prop_map(|t| CString::new(t).unwrap())
    };
    let slot = any::<Index>;
    prop_oneof![
        2 => (number(), proptest::option::of(number()), proptest::option::of(number())).prop_map(|(a, b, c)| Call::Setup(a, b, c)),
        2 => Just(Call::Setup(0.0, None, None)),
        8 => (0..5_u8).prop_map(Call::Plain),
        4 => vec(reference(), 0..5).prop_map(Call::GetReal),
        1 => vec(reference(), 0..3).prop_map(Call::GetInteger),
        1 => vec(reference(), 0..3).prop_map(Call::GetBoolean),
        1 => vec(reference(), 0..3).prop_map(Call::GetString),
        4 => vec((reference(), number()), 0..4).prop_map(Call::SetReal),
        1 => vec((reference(), -2..70_i32), 0..2).prop_map(Call::SetInteger),
        1 => vec((reference(), -1..3_i32), 0..2).prop_map(Call::SetBoolean),
        1 => (reference(), proptest::option::of(text())).prop_map(|(r, t)| Call::SetString(r, t)),
        2 => vec((reference(), 0..3_i32, number()), 0..3).prop_map(Call::Rates),
        12 => length().prop_map(|l| Call::Step(None, l)),
        1 => (number(), length()).prop_map(|(t, l)| Call::Step(Some(t), l)),
        4 => slot().prop_map(Call::Save),
        4 => slot().prop_map(Call::Restore),
        2 => slot().prop_map(Call::Free),
        6 => (slot(), slot(), prop_oneof![2 => Just(0_u8), 3 => any::<u8>()], prop_oneof![6 => Just(0_usize), 1 => 0..100_usize], any::<bool>())
            .prop_map(|(slot, at, bits, less, forged)| Call::Serialize { slot, at, bits, less, forged }),
        1 => (slot(), vec(any::<u8>(), 0..300)).prop_map(|(s, b)| Call::Deserialize(s, b)),
        1 => (0..3_i32, vec(text(), 0..3)).prop_map(|(on, c)| Call::Logging(on, c)),
        2 => (0..5_u8, -1..6_i32).prop_map(|(f, k)| Call::Status(f, k)),
        1 => (0..3_u8).prop_map(Call::NotOffered),
        1 => (0..12_u8).prop_map(Call::Nulls),
    ]
}

/// Replaces the digest by one that fits: header of the instance, fingerprint, digest, payload.
fn forge(bytes: &mut [c_char]) {
    let plain: Vec<u8> = bytes.iter().map(|b| *b as u8).collect();
    if let (Some(fingerprint), Some(payload)) = (plain.get(25..41), plain.get(57..)) {
        let digest = uuid::Uuid::new_v5(&uuid::Uuid::from_slice(fingerprint).unwrap(), payload);
        for (byte, new) in bytes[41..57].iter_mut().zip(digest.as_bytes()) {
            *byte = *new as c_char;
        }
    }
}

/// The states that a master holds.
type Slots = [FmuState; 3];

/// # Safety
/// `c` is an instance, `slots` its states or null.
unsafe fn make(fmi: Fmi, c: Component, call: &Call, slots: &mut Slots) -> Status {
    fn split<A: Copy, B: Copy>(pairs: &[(A, B)]) -> (Vec<A>, Vec<B>) {
        pairs.iter().copied().unzip()
    }
    // SAFETY: the pointers are null, or of arrays with the lengths that are passed, which outlive the call.
    unsafe {
        match call {
            Call::Setup(start, stop, tolerance) if fmi == Fmi::Three => export3::enter_initialization_mode(
                c,
                tolerance.is_some().into(),
                tolerance.unwrap_or(0.0),
                *start,
                stop.is_some().into(),
                stop.unwrap_or(0.0),
            ),
            Call::Setup(start, stop, tolerance) => export::setup_experiment(
                c,
                tolerance.is_some().into(),
                tolerance.unwrap_or(0.0),
                *start,
                stop.is_some().into(),
                stop.unwrap_or(0.0),
            ),
            Call::Plain(0 | 1) if fmi == Fmi::Three => {
                export3::enter_initialization_mode(c, 0, 0.0, 0.0, 0, 0.0)
            }
            Call::Plain(0 | 1) => export::enter_initialization_mode(c),
            Call::Plain(2) => export::exit_initialization_mode(c),
            Call::Plain(3) => export::terminate(c),
            Call::Plain(_) => export::reset(c),
            Call::GetReal(r) => {
                export::get_real(c, r.as_ptr(), r.len(), vec![0.0; r.len()].as_mut_ptr(), r.len())
            }
            Call::GetInteger(r) if fmi == Fmi::Three => {
                export::get_enumeration(c, r.as_ptr(), r.len(), vec![0; r.len()].as_mut_ptr(), r.len())
            }
            Call::GetInteger(r) => {
                export::get_integer(c, r.as_ptr(), r.len(), vec![0; r.len()].as_mut_ptr(), r.len())
            }
            Call::GetBoolean(r) if fmi == Fmi::Three => {
                export::get_byte_boolean(c, r.as_ptr(), r.len(), vec![0; r.len()].as_mut_ptr(), r.len())
            }
            Call::GetBoolean(r) => {
                export::get_boolean(c, r.as_ptr(), r.len(), vec![0; r.len()].as_mut_ptr(), r.len())
            }
            Call::GetString(r) => {
                export::get_string(c, r.as_ptr(), r.len(), vec![null(); r.len()].as_mut_ptr(), r.len())
            }
            Call::SetReal(pairs) => {
                let (r, v) = split(pairs);
                export::set_real(c, r.as_ptr(), r.len(), v.as_ptr(), v.len())
            }
            Call::SetInteger(pairs) => {
                let (r, v) = split(pairs);
                if fmi == Fmi::Three {
                    let v: Vec<i64> = v.iter().map(|v| (*v).into()).collect();
                    return export::set_enumeration(c, r.as_ptr(), r.len(), v.as_ptr(), v.len());
                }
                export::set_integer(c, r.as_ptr(), r.len(), v.as_ptr(), v.len())
            }
            Call::SetBoolean(pairs) => {
                let (r, v) = split(pairs);
                if fmi == Fmi::Three {
                    let v: Vec<u8> = v.iter().map(|v| *v as u8).collect();
                    return export::set_byte_boolean(c, r.as_ptr(), r.len(), v.as_ptr(), v.len());
                }
                export::set_boolean(c, r.as_ptr(), r.len(), v.as_ptr(), v.len())
            }
            Call::SetString(r, text) => {
                let text = text.as_ref().map_or(null(), |t| t.as_ptr());
                export::set_string(c, &raw const *r, 1, &raw const text, 1)
            }
            Call::Rates(rates) => {
                let references: Vec<_> = rates.iter().map(|r| r.0).collect();
                let orders: Vec<_> = rates.iter().map(|r| r.1).collect();
                let values: Vec<_> = rates.iter().map(|r| r.2).collect();
                export::set_real_input_derivatives(
                    c,
                    references.as_ptr(),
                    rates.len(),
                    orders.as_ptr(),
                    values.as_ptr(),
                )
            }
            Call::Step(time, length) => {
                let mut now = 0.0;
                if fmi == Fmi::Three {
                    let (mut flags, mut reached) = ([7_u8; 3], f64::NAN);
                    let flags_at = std::array::from_fn(|i| &raw mut flags[i]);
                    now = c
                        .cast::<super::instance::Instance>()
                        .as_ref()
                        .map_or(0.0, |i| i.last_successful_time());
                    let status =
                        export3::do_step(c, time.unwrap_or(now), *length, flags_at, &raw mut reached);
                    // what a step that was made has come to, and what one that was refused stands at
                    assert!(flags == [0; 3] && reached.is_finite() || status != Status::Ok);
                    return status;
                }
                export::get_real_status(c, 2, &raw mut now);
                export::do_step(c, time.unwrap_or(now), *length, 0)
            }
            Call::Save(slot) => export::get_fmu_state(c, &raw mut slots[slot.index(3)]),
            Call::Restore(slot) => export::set_fmu_state(c, slots[slot.index(3)]),
            Call::Free(slot) => export::free_fmu_state(c, &raw mut slots[slot.index(3)]),
            Call::Serialize { slot, at, bits, less, forged } => {
                let slot = &raw mut slots[slot.index(3)];
                let mut size = 0;
                let status = export::serialized_fmu_state_size(c, *slot, &raw mut size);
                if status != Status::Ok {
                    return status;
                }
                let mut bytes: Vec<c_char> = vec![0; size.saturating_sub(*less)];
                let status = export::serialize_fmu_state(c, *slot, bytes.as_mut_ptr(), bytes.len());
                if status != Status::Ok {
                    return status;
                }
                let at = at.index(bytes.len());
                bytes[at] ^= *bits as c_char;
                if *forged {
                    forge(&mut bytes);
                }
                export::deserialize_fmu_state(c, bytes.as_ptr(), bytes.len(), slot)
            }
            Call::Deserialize(slot, bytes) => export::deserialize_fmu_state(
                c,
                bytes.as_ptr().cast(),
                bytes.len(),
                &raw mut slots[slot.index(3)],
            ),
            Call::Logging(on, categories) => {
                let texts: Vec<Text> = categories.iter().map(|t| t.as_ptr()).collect();
                export::set_debug_logging(c, *on, texts.len(), texts.as_ptr())
            }
            Call::Status(0, _) => export::no_status(c, Function::GetStatus, &mut Status::Ok),
            Call::Status(1, kind) => export::get_real_status(c, *kind, &mut 0.0),
            Call::Status(2, kind) => export::get_boolean_status(c, *kind, &mut 0),
            Call::Status(3, _) => export::no_status(c, Function::GetStringStatus, &mut null::<i8>()),
            Call::Status(_, _) => export::no_status(c, Function::GetIntegerStatus, null_mut::<i32>()),
            Call::NotOffered(0) if fmi == Fmi::Three => export3::not_offered(c, "fmi3EnterEventMode"),
            Call::NotOffered(1) if fmi == Fmi::Three => export3::no_variables(c, "fmi3GetClock", 1),
            Call::NotOffered(0) => export::not_offered(c, Function::GetDirectionalDerivative),
            Call::NotOffered(1) => export::not_offered(c, Function::GetRealOutputDerivatives),
            Call::NotOffered(_) => export::not_offered(c, Function::CancelStep),
            Call::Nulls(0) => export::get_real(c, null(), 3, null_mut(), 3),
            Call::Nulls(1) => export::get_string(c, &0, 1, null_mut(), 1),
            Call::Nulls(2) => export::set_real(c, null(), usize::MAX, null(), usize::MAX),
            Call::Nulls(3) => export::set_string(c, &0, 1, &null(), 1),
            Call::Nulls(4) => export::set_real_input_derivatives(c, &0, 1, null(), null()),
            Call::Nulls(5) => export::get_fmu_state(c, null_mut()),
            Call::Nulls(6) => export::set_fmu_state(c, null_mut()),
            Call::Nulls(7) => export::free_fmu_state(c, null_mut()),
            Call::Nulls(8) => export::serialize_fmu_state(c, null_mut(), null_mut(), 10),
            Call::Nulls(9) => export::deserialize_fmu_state(c, null(), 10, null_mut()),
            Call::Nulls(10) => export::set_debug_logging(c, 1, 2, null()),
            // counts that do not fit
            Call::Nulls(11) if fmi == Fmi::Three => export::get_real(c, &0, 1, [0.0; 2].as_mut_ptr(), 2),
            Call::Nulls(_) => export::get_real_status(c, 2, null_mut()),
        }
    }
}

fn config() -> ProptestConfig {
    let cases = std::env::var("HOSTILE_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(200);
    ProptestConfig { cases, failure_persistence: None, max_shrink_time: 60_000, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_calls_in_any_order(three in any::<bool>(), calls in proptest::collection::vec(call(), 1..60)) {
        let fmi = if three { Fmi::Three } else { Fmi::Two };
        let (_, location, guid) = fmu();
        let mut counts = [0_u32; 6];
        // SAFETY: the types differ in that one is variadic; without further arguments the call is the same on
        // x86-64 and on ARM outside Apple's systems.
        let logger = unsafe {
            std::mem::transmute::<
                unsafe extern "C" fn(*mut c_void, Text, c_int, Text, Text),
                unsafe extern "C" fn(*mut c_void, Text, c_int, Text, Text, ...),
            >(logger)
        };
        let callbacks = CallbackFunctions {
            logger: Some(logger),
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: (&raw mut counts).cast(),
        };
        let start = Instant::now();
        // SAFETY: valid texts and callbacks; the instance and its states are freed once, below.
        unsafe {
            let name = c"hostile".as_ptr();
            let c = match fmi {
                Fmi::Two => export::instantiate(MODELS, name, 1, guid.as_ptr(), location.as_ptr(), &callbacks, 0, 0),
                Fmi::Three => export3::instantiate(
                    MODELS, name, guid.as_ptr(), location.as_ptr(), 0, 0, (&raw mut counts).cast(), Some(logger3),
                ),
            };
            assert!(!c.is_null());
            let mut slots = [null_mut(); 3];
            for call in &calls {
                let (before, errors) = (Instant::now(), counts[Status::Error as usize]);
                let status = make(fmi, c, call, &mut slots);
                let new = counts[Status::Error as usize] - errors;
                // a panic would be Fatal; an error has a message, what is done or discarded has none
                assert!(matches!(status, Status::Ok | Status::Discard | Status::Error), "{call:?}: {status:?}");
                assert!((status == Status::Error) == (new > 0) || matches!(call, Call::Step(..)), "{call:?}: {status:?}, {new} messages");
                assert!(before.elapsed() < Duration::from_secs(10), "{call:?} took {:?}", before.elapsed());
                // most errors are mended, or nothing but errors would follow
                if status == Status::Error && !matches!(call, Call::Nulls(_)) {
                    assert_eq!(export::reset(c), Status::Ok);
                    if matches!(call, Call::Step(..)) {
                        make(fmi, c, &Call::Setup(0.0, None, None), &mut slots);
                        if fmi == Fmi::Two {
                            export::enter_initialization_mode(c);
                        }
                        export::exit_initialization_mode(c);
                    }
                }
            }
            for slot in &mut slots {
                export::free_fmu_state(c, slot);
                assert!(slot.is_null());
            }
            export::free_instance(c);
        }
        assert_eq!(counts[Status::Fatal as usize], 0);
        assert!(start.elapsed() < Duration::from_secs(60));
    }
}
