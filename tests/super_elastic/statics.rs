//! A wheel that stands.

use super::{FLAT, rim, settled, single, tire};
use latsch::road::Road;
use latsch::tire::{Plane, Tire, Vertical};

/// Check 24: 663 kg on elements of 151.105 N/mm with one contact point.
#[test]
fn the_wheel_under_663_kg_stands_where_the_table_says() {
    let (tire, rim) = settled(&tire(single(151_105.0)), 663.0);
    let deflection = 1e3 * (0.2265 - rim.position.z);
    let sums = &tire.state.sums;
    // the table's program settled in time, at 1.05 1/s: after ten seconds 3e-4 mm of ten are left
    assert!((deflection - 12.9286).abs() < 3e-4, "{deflection}");
    assert!((sums.contact[1] - 6504.0).abs() < 0.1);
    assert!((sums.radial[1] - 6243.1).abs() < 0.1);
    assert_eq!(sums.touching, 5);
    assert!((1e3 * sums.penetration - 0.2173).abs() < 1e-4);
}

/// Check 25: the printed parameters with three contact points under a gap of one degree.
#[test]
fn the_printed_parameters_give_the_deflection_of_the_reading() {
    let standing = |stiffness: f64| {
        let (_, rim) = settled(
            &tire(|p| {
                p.rim_force = 2;
                p.stiffness = stiffness;
            }),
            663.0,
        );
        1e3 * (0.2265 - rim.position.z)
    };
    let [printed, forgotten] = [standing(122e3), standing(151_105.0)];
    assert!((printed - 12.67).abs() < 0.006, "{printed}");
    assert!((forgotten - 10.70).abs() < 0.006, "{forgotten}");
}

/// The elements are as many as one likes: 45, 75 and 105 with the stiffness that the identification gives each of them at 13 mm.
#[test]
fn the_deflection_hardly_depends_on_the_number_of_elements() {
    let standing = |elements: i32, stiffness: f64| {
        let change = single(stiffness);
        let (_, rim) = settled(
            &tire(|p| {
                change(p);
                p.elements = elements;
            }),
            663.0,
        );
        1e3 * (0.2265 - rim.position.z)
    };
    let all = [standing(45, 151_105.0), standing(75, 93_398.0), standing(105, 65_945.0)];
    let mean = all.iter().sum::<f64>() / 3.0;
    assert!(all.iter().all(|e| (e / mean - 1.0).abs() < 0.015), "{all:?}");
}

/// At rest the force on the rim is what the energy of rubber and contact changes by with the rim's height, with all couplings; each
/// makes the tire stiffer. One that is too stiff for a balance to be found says so.
#[test]
fn coupled_elements_carry_what_their_energy_says() {
    let mut last = 0.0;
    for coupling in [1, 2, 3] {
        let tire = tire(|p| {
            p.rim_force = 2;
            (p.coupling, p.coupling_stiffness, p.bending_stiffness) = (coupling, 1e6, 30.0);
        });
        let at = |height: f64| {
            let rim = rim(height, 0.0, 0.0);
            let rest = tire.stationary(&rim, Vertical::Height(height), 1.0).unwrap();
            let mut tire = tire.clone();
            tire.begin(&rest, &rim, &Plane::level(height, 1.0), &FLAT).unwrap();
            (tire.energy(&rim), rest.on_rim.force.z)
        };
        let (height, by) = (0.214, 1e-5);
        let slope = (at(height + by).0 - at(height - by).0) / (2.0 * by);
        let force = at(height).1;
        assert!((force + slope).abs() < 1e-3 * force, "{coupling}: {force} {slope}");
        assert!(force > 1.01 * last, "{coupling}: {force} {last}");
        last = force;
    }
    let mut printed = tire(|_| ());
    printed.parameters.coupling = 2;
    let message = printed.mount(&Road::default()).unwrap_err().to_string();
    assert!(message.contains("rim_force = exact"), "{message}");
    let stiff = tire(|p| {
        (p.elements, p.rim_force) = (300, 2);
        (p.coupling, p.coupling_stiffness, p.bending_stiffness) = (3, 1e10, 1e7);
    });
    let message = stiff.stationary(&rim(0.214, 0.0, 0.0), Vertical::Height(0.214), 1.0).unwrap_err();
    assert!(message.to_string().contains("coupling_stiffness"), "{message}");
}
