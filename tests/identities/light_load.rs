//! Light loads, where the printed pressure distribution has no physical answer.

use super::*;

/// Sum of the bristles' normal forces, which is what it should be where each counts as a whole.
fn carried(rig: &common::FlatTrack) -> f64 {
    let (state, p) = (&rig.model().tire().state, &rig.model().tire().parameters);
    let (pressure, share) = (&state.bristles.pressure, &state.bristles.share);
    pressure.iter().zip(share).map(|(p, share)| p * share).sum::<f64>() * p.cell_area()
}

fn run(rig: &mut common::FlatTrack, mut each: impl FnMut(&mut common::FlatTrack)) {
    for k in 0..200 {
        rig.step(f64::from(k) * 1e-3, 1e-3).unwrap();
        each(rig);
    }
}

#[test]
fn printed_distribution_pulls_at_one_end() {
    let mut rig = flat_track(&[
        ("deflection", 0.002),
        ("slip_angle", -0.02),
        ("whole_step_entry", 1.0),
        common::PRINTED_PRESSURE,
    ]);
    let mut most: f64 = 0.0;
    run(&mut rig, |rig| {
        let (share, normal) = (get(rig, "negative_pressure_share"), get(rig, "patch_force_z"));
        assert_eq!(get(rig, "pressure_state"), if share > 0.0 { 3.0 } else { 2.0 });
        assert_close("carried", carried(rig), normal, 1e-10);
        let horizontal = get(rig, "patch_force_x").hypot(get(rig, "patch_force_y"));
        // pulled bristles carry no friction, the others carry that much more
        assert!(horizontal <= 1.5 * normal * (1.0 + share), "{horizontal} {normal} {share}");
        most = most.max(share);
    });
    assert!(most > 0.01, "{most}");
}

#[test]
fn limited_tilt_never_pulls() {
    let mut rig = flat_track(&[
        ("deflection", 0.002),
        ("slip_angle", -0.02),
        ("limit_pressure_tilt", 1.0),
        ("whole_step_entry", 1.0),
    ]);
    let mut limited = 0;
    run(&mut rig, |rig| {
        assert_eq!(get(rig, "negative_pressure_share"), 0.0);
        limited += i32::from(get(rig, "pressure_state") == 4.0);
        assert!(rig.model().tire().state.bristles.pressure.iter().all(|p| *p >= 0.0));
        assert_close("carried", carried(rig), get(rig, "patch_force_z"), 1e-10);
    });
    assert!(limited > 100, "{limited}");
}

/// Bristles that are longer than the patch: one x in contact, or none.
#[test]
fn few_bristles() {
    let mut rig = flat_track(&[("deflection", 0.01), ("bristles_per_stripe", 2.0), ("bristle_length", 0.2)]);
    let (mut singular, mut between) = (0, 0);
    run(&mut rig, |rig| {
        let normal = get(rig, "patch_force_z");
        assert!(normal > 0.0 && get(rig, "force_z").is_finite());
        match get(rig, "pressure_state") {
            5.0 => {
                singular += 1;
                assert_close("carried", carried(rig), normal, 1e-10);
            }
            6.0 => {
                between += 1;
                assert_eq!(carried(rig), 0.0);
                assert_eq!(get(rig, "patch_force_x"), 0.0);
            }
            other => panic!("pressure_state {other}"),
        }
    });
    assert!(singular > 20 && between > 20, "{singular} {between}");
}

/// Just touching: the belt's lowest line lies between two stripes and no stripe reaches the road.
#[test]
fn belt_between_stripes() {
    let mut rig = flat_track(&[("deflection", 0.0002)]);
    run(&mut rig, |rig| {
        assert_eq!(get(rig, "pressure_state"), 6.0);
        assert!(get(rig, "patch_force_z") > 0.0 && carried(rig) == 0.0);
        assert_eq!(get(rig, "sliding_share"), 0.0);
    });
}
