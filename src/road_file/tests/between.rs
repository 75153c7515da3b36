//! From one format to another, as few points as may be, and bytes that are no road.

use super::opencrg::{FORMATS, crg};
use super::*;

#[test]
fn too_many_points_are_told_and_straight_ones_left_out() {
    let n = MAX_POINTS + 5;
    let rough = |i: usize| if i.is_multiple_of(2) { 0.0 } else { 0.001 };
    let road = RoadProfile::of("r.csv", (0..n).map(|i| [i as f64 * 0.1, rough(i)]).collect());
    let message = road.settings().unwrap_err().to_string();
    assert!(
        message.contains("r.csv") && message.contains("20005 points") && message.contains("--tolerance"),
        "{message}"
    );
    // straight: two points are left, and the height is the same
    let mut straight = RoadProfile::of("r.csv", (0..n).map(|i| [i as f64 * 0.5, i as f64 * 0.25]).collect());
    assert_eq!(straight.thin(), n - 2);
    straight.settings().unwrap();
    // an edge stays, also between level pieces
    let mut edge = RoadProfile::of("r.csv", vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.1], [2.0, 0.1], [3.0, 0.1]]);
    assert_eq!((edge.thin(), edge.left.len()), (1, 4));
}

/// Points of a track: places that rise, edges here and there.
fn points() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec((1u32..400, -500i32..500, prop::bool::weighted(0.2)), 2..30).prop_map(|steps| {
        let (mut x, mut all) = (-1.0, Vec::new());
        for (step, z, edge) in steps {
            x += f64::from(step) * 0.003;
            all.push([x, f64::from(z) * 1e-4]);
            if edge {
                all.push([x, f64::from(z) * 1e-4 + 0.01]);
            }
        }
        all
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 4, ..ProptestConfig::default() })]

    #[test]
    fn points_survive_every_format(left in points(), right in prop::option::of(points()), adams in any::<bool>()) {
        let folder = Folder::new();
        let mut road = RoadProfile::of("r", left);
        road.right = right;
        for ending in ["csv", "rdf", "toml"] {
            let path = folder.0.path().join(format!("r.{ending}"));
            let done = write(&path, &road, &Writing { adams: adams && ending == "rdf", ..Writing::default() });
            if ending == "rdf" && !adams && road.right.is_none() && road.left.windows(2).any(|pair| pair[0][0] == pair[1][0]) {
                prop_assert!(done.unwrap_err().to_string().contains("vertical edges"));
                continue;
            }
            done.unwrap();
            let back = read(&path, &Lanes::default()).unwrap();
            if road.right.is_none() && !(ending == "rdf" && adams) && ending != "toml" {
                prop_assert_eq!(&back.left, &road.left);
            }
            let (there, here) = (made(&back), made(&road));
            for i in 0..200 {
                let x = -1.5 + 0.1 * f64::from(i) + 1e-4;
                for y in [1.0, -1.0] {
                    prop_assert!((there.at(x, y).height - here.at(x, y).height).abs() < 1e-12, "{} {} {}", ending, x, y);
                }
            }
        }
    }

    /// On a grid nothing but the edges is lost; what is off is said.
    #[test]
    fn a_road_on_a_grid_survives_opencrg(z in prop::collection::vec(-0.1f64..0.1, 2..40), w in prop::collection::vec(-0.1f64..0.1, 2..40)) {
        let folder = Folder::new();
        let track = |z: &[f64]| -> Vec<[f64; 2]> { z.iter().enumerate().map(|(i, z)| [0.25 * i as f64, *z]).collect() };
        let mut road = RoadProfile::of("r", track(&z));
        road.right = Some(track(&w));
        let path = folder.0.path().join("r.crg");
        let lost = write(&path, &road, &Writing::default()).unwrap();
        let back = read(&path, &Lanes { left: Some(0.75), right: Some(-0.75) }).unwrap();
        let most = road.left.iter().zip(&back.left).map(|(a, b)| (a[1] - b[1]).abs()).fold(0.0, f64::max);
        prop_assert!(most < 1e-15, "{} {:?}", most, lost);
        prop_assert_eq!(back.left[0][0], 0.0);
    }

    #[test]
    fn a_tolerance_is_kept(left in points(), tolerance in 1e-4f64..0.05) {
        let road = RoadProfile::of("r", left);
        let mut less = road.clone();
        less.simplify(tolerance);
        for ([x, z], mut walk) in road.left.iter().zip(std::iter::repeat_with(|| crate::road_file::profile::Walk::new(&less.left))) {
            let (before, behind) = walk.heights_at(*x);
            prop_assert!((before - z).abs() <= tolerance + 1e-12 || (behind - z).abs() <= tolerance + 1e-12, "{} {} {} {}", x, z, before, behind);
        }
        prop_assert_eq!(less.left.last(), road.left.last());
    }

    /// `PROPTEST_CASES=80000` for a longer look.
    #[test]
    fn any_bytes_are_a_road_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..300), at in 0usize..2000, which in 0usize..10) {
        let folder = Folder::new();
        // noise in the place of a piece of a file that is whole
        let mut file = match FORMATS.get(which) {
            Some(format) => crg(format, "", None),
            None => CLEAT.into(),
        };
        let name = if which < FORMATS.len() { "r.crg" } else { "r.rdf" };
        let at = at.min(file.len());
        let to = (at + bytes.len()).min(file.len());
        file.splice(at..to, bytes);
        match folder.read(name, &file, &Lanes::default()) {
            Ok(road) => { let _ = road.settings(); }
            Err(error) => prop_assert!(error.to_string().len() < 2000),
        }
    }
}
