//! Curves against closed forms, and the ways to a state against each other.

use super::rig::Rig;
use super::*;
use crate::fmi::Entry;
use crate::model::Settings;
use crate::recording::Names;
use crate::rig::FlatTrack;
use crate::tire::classic::{FialaTire, UaTire};
use crate::tire::magic_formula::MagicFormula;
use crate::tire::ring_brush::RingBrush;

/// Not all that are shipped, which would be compiled for these tests once more.
const MODELS: &[Entry] = &[
    Entry::of::<FlatTrack<FialaTire>>(),
    Entry::of::<FlatTrack<UaTire>>(),
    Entry::of::<FlatTrack<MagicFormula>>(),
    Entry::of::<FlatTrack<RingBrush>>(),
];

const LOADS: [f64; 2] = [2000.0, 5000.0];

fn rig(model: &str) -> Rig {
    let slave = Entry::find(MODELS, model).unwrap().slave(&Settings::default()).unwrap();
    Rig::new(slave, &[], &Names::new()).unwrap()
}

fn programme() -> Programme {
    let angle = 12_f64.to_radians();
    Programme {
        loads: LOADS.to_vec(),
        speeds: vec![10.0],
        frictions: vec![1.0],
        slip_angle: angle,
        slip: 0.5,
        camber: 0.1,
    }
}

/// Fiala's tire as docs/classic-tires.md has it, with its default parameters.
#[test]
fn readings_of_a_brush_tire_are_its_parameters() {
    let (stiffness, along, width, vertical) = (40e3_f64, 60e3_f64, 0.152_f64, 500e3_f64);
    let friction = |slip: f64| 0.94 - 0.09 * slip;
    let tire = measure("fiala", &mut rig("fiala-flat-track"), &programme(), &|| ()).unwrap();
    assert!(tire.notes.is_empty(), "{:?}", tire.notes);
    for load in LOADS {
        let near = |measure: Measure, expected: f64, share: f64| {
            let value = tire.reading(measure, load).unwrap();
            assert!((value / expected - 1.0).abs() < share, "{measure:?} at {load}: {value} for {expected}");
        };
        let per_degree = 1_f64.to_radians();
        near(Measure::CorneringStiffness, stiffness * per_degree, 1e-5);
        near(Measure::AligningStiffness, stiffness * width / 3.0 * per_degree, 1e-4);
        near(Measure::PneumaticTrail, 1e3 * width / 3.0, 1e-4);
        near(Measure::SlipStiffness, 0.01 * along, 1e-9);
        let most = friction(1.0) * load;
        near(Measure::Locked, (most - most * most / (4.0 * along)) / load, 1e-9);
        near(Measure::Deflection, 1e3 * load / vertical, 1e-9);
        near(Measure::VerticalStiffness, 1e-3 * vertical, 1e-9);
        near(Measure::RollingResistance, 0.015, 0.06);

        let force = |slip: f64| {
            let most = friction(slip) * load;
            most * (1.0 - (1.0 - stiffness * slip / (3.0 * most)).max(0.0).powi(3))
        };
        // the peak is a little before the tire slides as a whole, because friction falls with the slip
        let slips = (0..25_000).map(|k| 1e-5 * f64::from(k));
        let top = slips.max_by(|a, b| force(*a).total_cmp(&force(*b))).unwrap();
        near(Measure::LateralPeak, force(top.min(12_f64.to_radians().tan())) / load, 1e-4);
        let peak = tire.reading(Measure::LateralPeakAngle, load).unwrap();
        if top < 11_f64.to_radians().tan() {
            assert!((peak.to_radians().tan() / top - 1.0).abs() < 0.01, "{peak}");
        } else {
            assert!(peak.is_nan());
        }

        // behind a lag of the slip angle over a way, the force has its share when the angle has that for which it is
        let angle = 0.5_f64.to_radians().tan();
        let share = (1.0 - (-1_f64).exp()) * force(angle);
        let (mut low, mut high) = (0.0, angle);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if force(middle) < share { low = middle } else { high = middle }
        }
        near(Measure::RelaxationLength, -stiffness / 200e3 * (1.0 - low / angle).ln(), 0.01);
    }
}

/// What a rig of somebody else does: it says of no start that it is stationary, and has no load to hold.
#[test]
fn a_rig_that_settles_and_one_that_is_pushed_tell_the_same() {
    let condition =
        Condition { load: 3500.0, speed: 12.0, friction: 0.9, slip_angle: 0.06, slip: -0.03, camber: 0.03 };
    let names = Names::from([("load".to_owned(), "wanted".to_owned())]);
    assert!(Rig::new(slave("ua-flat-track"), &[], &names).is_err());
    for model in ["magic-formula-flat-track", "ring-brush-flat-track"] {
        let known = rig(model).point(&condition).unwrap();
        let mut pushed = Rig::new(slave(model), &[], &Names::new()).unwrap().silent(true);
        let mut settled = Rig::new(slave(model), &[], &Names::new()).unwrap().silent(false);
        for other in [&mut pushed, &mut settled] {
            let found = other.point(&condition).unwrap();
            for i in 0..3 {
                let [force, moment] = [found.force[i] - known.force[i], found.moment[i] - known.moment[i]];
                assert!(force.abs() < 4e-3 * condition.load, "{model}: {found:?} {known:?}");
                assert!(moment.abs() < 4e-4 * condition.load, "{model}: {found:?} {known:?}");
            }
        }
        let straight = Condition { slip_angle: 0.0, slip: 0.0, camber: 0.0, ..condition };
        let [known, found] =
            [&mut rig(model), &mut settled].map(|rig| rig.relaxation_length(&straight).unwrap());
        assert!((found / known - 1.0).abs() < 0.03, "{model}: {found} {known}");
    }
}

fn slave(model: &str) -> Box<dyn crate::model::Slave> {
    Entry::find(MODELS, model).unwrap().slave(&Settings::default()).unwrap()
}

/// A force at the contact alone has no moment about it.
#[test]
fn moments_move_to_where_the_wheel_meets_the_road() {
    let (height, camber) = (0.31, 0.08_f64);
    let (place, [x, y, z]) = ([0.0, height * camber.tan(), -height], [300.0, -1200.0, 4000.0]);
    let moment = [place[1] * z - place[2] * y, place[2] * x - place[0] * z, place[0] * y - place[1] * x];
    let point = Point { force: [x, y, z], moment, height: Some(height), deflection: None };
    assert!(point.contact_moment(camber).unwrap().iter().all(|m| m.abs() < 1e-9));
    assert_eq!(Point { height: None, ..point }.contact_moment(camber), None);
}

#[test]
fn what_cannot_be_held_is_left_out_and_said() {
    let high = Programme { loads: vec![2000.0, 2e5], ..programme() };
    let tire = measure("fiala", &mut rig("fiala-flat-track"), &high, &|| ()).unwrap();
    assert!(
        tire.notes.iter().any(|note| note.contains("left out") && note.contains("200000 N")),
        "{:?}",
        tire.notes
    );
    assert!(tire.reading(Measure::CorneringStiffness, 2000.0).is_some());
    assert!(tire.reading(Measure::CorneringStiffness, 2e5).is_none());
    let falls = Programme { loads: vec![3000.0, 2000.0], ..programme() };
    assert!(measure("fiala", &mut rig("fiala-flat-track"), &falls, &|| ()).is_err());
}

#[test]
fn curves_are_read_back_from_tydex() {
    use crate::recording::{parse_tydex, to_tydex};
    let programme = Programme { frictions: vec![1.0, 0.5], ..programme() };
    let tire = measure("a, b", &mut rig("fiala-flat-track"), &programme, &|| ()).unwrap();
    let all = recordings(&tire);
    let names: std::collections::BTreeSet<&String> = all.iter().map(|(name, _)| name).collect();
    assert_eq!(names.len(), all.len(), "{names:?}");
    assert!(names.iter().any(|name| *name == "a__b-cornering-5000N-friction0.5"), "{names:?}");
    for (name, recording) in &all {
        let read = parse_tydex(&to_tydex(recording).unwrap(), name).unwrap();
        for channel in ["slip_angle", "slip", "deflection", "force_y", "force_z", "moment_z"] {
            assert_eq!(read.channel(channel).unwrap().values, recording.channel(channel).unwrap().values);
        }
    }
    let csv = curves_csv(&[tire]);
    assert!(csv.lines().nth(1).unwrap().starts_with("\"a, b\",cornering,2000,10,1,-0.2"), "{csv}");
    let columns = csv.lines().next().unwrap().split(',').count();
    assert!(csv.lines().skip(1).all(|line| line.split(',').count() == columns + 1));
}
