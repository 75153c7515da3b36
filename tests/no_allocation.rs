//! A step does not touch the heap, on the grid and between grid points, nor does saving into an
//! existing snapshot.
#![allow(missing_docs, clippy::unwrap_used)]

mod common;

use common::flat_track;
use latsch::model::Slave;

#[test]
fn steps_and_repeated_saves_do_not_allocate() {
    let mut rig = flat_track(&[("slip", 0.05), ("slip_angle", 0.03), ("camber", 0.02)]);
    let deflection = rig.find("deflection").unwrap();
    let force = rig.find("force_z").unwrap();
    let mut snapshot = rig.save().unwrap();
    let mut time = 0.0;
    let info = allocation_counter::measure(|| {
        // off the grid of 1e-4 s every time but the tenth
        for k in 0..200 {
            rig.set(deflection, 0.02 + 1e-5 * f64::from(k % 10)).unwrap();
            rig.set_rate(deflection, 0.01).unwrap();
            rig.step(time, 1.3e-4).unwrap();
            time += 1.3e-4;
            assert!(rig.get(force).unwrap() > 0.0);
            rig.save_into(&mut snapshot).unwrap();
            if k == 150 {
                rig.restore(&snapshot).unwrap();
            }
        }
    });
    assert_eq!(info.count_total, 0, "{info:?}");
}
