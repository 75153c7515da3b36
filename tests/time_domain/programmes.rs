//! Random programmes of a rig.

use crate::common::{flat_track, get, set};
use crate::{TICK, check_sanity};
use latsch::model::Slave;
use proptest::prelude::*;

type Commands = (f64, f64, f64, f64, f64, f64);

/// Six pieces of 50 ms each with commands within these sizes.
fn programme(size: f64) -> impl Strategy<Value = Vec<Commands>> {
    let piece = (
        -size..size,
        -0.02..0.04f64,
        -60.0 * size..60.0 * size,
        -0.3 * size..0.3 * size,
        -1.5..3.0f64,
        -size..size,
    );
    proptest::collection::vec(piece, 6)
}

fn switches() -> impl Strategy<Value = [f64; 3]> {
    proptest::array::uniform3(prop_oneof![Just(0.0), Just(1.0)])
}

/// Steps up to the largest there is \[s\].
fn steps() -> impl Strategy<Value = f64> {
    prop_oneof![Just(5e-4), Just(1e-3)]
}

fn drive(programme: &[Commands], frequency: f64, step: f64, switches: [f64; 3]) -> latsch::Result<()> {
    let mut rig = flat_track(&[
        ("actuator_frequency", frequency),
        ("step_size", step),
        ("limit_pressure_tilt", switches[0]),
        ("even_stripes", switches[1]),
        ("antisymmetric_coupling", switches[2]),
    ]);
    let mut distance = 0.0;
    for (k, (steer, deflection, speed, camber, slip, angle)) in programme.iter().enumerate() {
        set(
            &mut rig,
            &[
                ("steer", *steer),
                ("deflection", *deflection),
                ("path_speed", *speed),
                ("camber", *camber),
                ("slip", *slip),
                ("slip_angle", *angle),
            ],
        );
        for tick in 50 * k..50 * (k + 1) {
            rig.step(tick as f64 * TICK, TICK)?;
            check_sanity(&mut rig);
            let slid = get(&mut rig, "sliding_distance");
            assert!(slid >= distance);
            distance = slid;
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any programme that a rig could drive.
    #[test]
    fn random_programmes(programme in programme(0.3), step in steps(), switches in switches()) {
        drive(&programme, 20.0, step, switches).unwrap();
    }

    /// Programmes that none could, with hundreds of g at the rim: right, or an end with a reason.
    #[test]
    fn impossible_programmes(programme in programme(1.5), step in steps(), switches in switches()) {
        if let Err(error) = drive(&programme, 200.0, step, switches) {
            prop_assert_eq!(error.kind(), latsch::ErrorKind::Numeric);
        }
    }
}
