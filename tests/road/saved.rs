//! What is wrong in parameters is named; saved roads and windows are whole.

use super::*;

#[test]
fn what_is_wrong_is_named() {
    let refuse = |p: RoadParameters, words: &[&str]| {
        let message = Road::new(&p).unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "{word:?} is not in {message:?}");
        }
    };
    let profile = |text: &str| RoadParameters { profile: text.into(), ..parameters(8) };
    refuse(profile(" "), &["road_profile", "needs points"]);
    refuse(profile("0 0; 1 0,5; 2 0"), &["road_profile", "pair 2", "\"1 0,5\"", "\"0,5\" is not a number"]);
    refuse(profile("0 0; 1; 2 0"), &["pair 2", "two numbers"]);
    refuse(profile("0 0; 1 2 3"), &["pair 2", "two numbers"]);
    refuse(profile("0 0;; 1 2"), &["pair 2", "two numbers"]);
    refuse(profile("0 NaN"), &["pair 1", "finite"]);
    refuse(profile("0 0; 1 0; 0.5 0"), &["pair 3", "0.5 m comes after 1 m"]);
    refuse(profile("0 0; 0 1; 0 2"), &["pair 3", "third"]);
    refuse(profile("0 0; 1e-7 1"), &["pair 2", "same x"]);
    refuse(profile(&"0 0;".repeat(20_001)), &["20001 points"]);
    let friction = |text: &str| RoadParameters { friction: text.into(), ..parameters(1) };
    refuse(friction("0 1; 5 -0.1"), &["road_friction", "pair 2", "negative"]);
    refuse(friction("0 1; 0 0.1"), &["pair 2", "increase"]);
    refuse(parameters(0), &["road_kind = 0", "1 flat", "8 profile"]);
    for length in [-0.1, 1e-4, f64::NAN, f64::INFINITY] {
        let message = road(&parameters(1)).window(length).unwrap_err().to_string();
        assert!(message.contains("road_filter_length") && message.contains("0.001"), "{message}");
    }
    refuse(RoadParameters { height: f64::NAN, ..parameters(2) }, &["road_height = NaN"]);
    refuse(RoadParameters { length: 0.0, ..parameters(5) }, &["road_length = 0 m"]);
    refuse(RoadParameters { roughness: -1.0, ..parameters(6) }, &["road_roughness"]);
    refuse(RoadParameters { bevel: 0.02, ..parameters(4) }, &["road_bevel = 0.02 m", "0.01 m"]);
    refuse(RoadParameters { bevel: 0.01, length: 0.015, ..parameters(4) }, &["do not fit", "0.015 m"]);
    refuse(RoadParameters { spacing: 0.05, ..parameters(4) }, &["road_spacing = 0.05 m", "0.1 m"]);
    refuse(RoadParameters { spacing: 1.0, ..parameters(3) }, &["road_spacing", "0.01 m above", "to 0"]);
    refuse(RoadParameters { spacing: -1.0, ..profile("0 1") }, &["road_spacing = -1 m", "at least"]);
    // what is seldom met by a point is met often by a window
    let close = RoadParameters { length: 1e-3, spacing: 1e-3, ..parameters(4) };
    let varied =
        RoadParameters { friction_deviation: 0.1, friction_correlation_length: 1e-3, ..parameters(1) };
    for (p, name) in [(close, "road_spacing"), (varied, "road_friction_correlation_length")] {
        let road = road(&p);
        assert!(road.window(0.1).is_ok() && road.window(0.0).is_ok());
        let message = road.window(0.11).unwrap_err().to_string();
        for word in ["road_filter_length = 0.11 m", "100 times", "0.001 m", name] {
            assert!(message.contains(word), "{word:?} is not in {message:?}");
        }
    }
    let right = |text: &str| RoadParameters { profile_right: text.into(), ..profile("0 0; 1 0") };
    refuse(right("0 0; 1 0,5; 2 0"), &["road_profile_right", "pair 2", "\"0,5\" is not a number"]);
    refuse(right(";"), &["road_profile_right", "needs points"]);
    refuse(RoadParameters { spacing: 1.0, ..right("0 0; 1 0.5") }, &["road_spacing = 1 m", "0.5 m above"]);
    refuse(RoadParameters { tracks: 2, ..right("0 0; 1 0.5") }, &["road_profile_right", "road_tracks = 2"]);
    let friction_right = |text: &str| RoadParameters { friction_right: text.into(), ..parameters(1) };
    refuse(friction_right("0 1; 5 -0.1"), &["road_friction_right", "pair 2", "negative"]);
    refuse(RoadParameters { tracks: 4, ..parameters(1) }, &["road_tracks = 4", "1 both", "3 right"]);
    refuse(RoadParameters { track_width: 0.0, ..parameters(1) }, &["road_track_width = 0 m", "0.001"]);
    refuse(RoadParameters { track_width: f64::INFINITY, ..parameters(1) }, &["road_track_width", "finite"]);
    let coherence = |coherence_length| RoadParameters { coherence_length, ..parameters(6) };
    refuse(coherence(-1.0), &["road_coherence_length = -1 m", "negative"]);
    refuse(
        RoadParameters { tracks: 3, ..coherence(1.0) },
        &["road_coherence_length = 1 m", "road_tracks = 3"],
    );
    let deviation = |friction_deviation| RoadParameters { friction_deviation, ..parameters(1) };
    refuse(deviation(0.48), &["road_friction_deviation = 0.48", "0.47"]);
    refuse(deviation(-0.1), &["road_friction_deviation = -0.1", "from 0"]);
    refuse(
        RoadParameters { friction_correlation_length: 0.0, ..deviation(0.1) },
        &["road_friction_correlation_length = 0 m", "0.001"],
    );
}

#[test]
fn saved_roads_are_the_same_and_damage_is_found() {
    let two = |p: RoadParameters| RoadParameters {
        profile_right: "0 0; 1 2; 2 1".into(),
        friction_right: "2 0.1; 3 0.2".into(),
        coherence_length: 3.0,
        friction_deviation: 0.2,
        ..p
    };
    for kind in 1..=8 {
        let p =
            RoadParameters { profile: "0 0; 0 1; 2 1".into(), friction: "1 0.5".into(), ..parameters(kind) };
        for p in [two(p.clone()), RoadParameters { tracks: 3, ..p.clone() }, p] {
            let (road, window) = with_window(&p);
            let bytes = postcard::to_stdvec(&(&road, &window)).unwrap();
            let (same_road, same_window) = postcard::from_bytes::<(Road, Window)>(&bytes).unwrap();
            assert_eq!((&same_road, &same_window), (&road, &window));
            let (mut copy, mut copied_window) = (road.clone(), window.clone());
            let counts = allocation_counter::measure(|| {
                copy.clone_from(&road);
                copied_window.clone_from(&window);
                std::hint::black_box((copy.at(5.0, 0.1), copy.mean(&copied_window, 5.0, 0.1)));
            });
            assert_eq!(counts.count_total, 0);
            assert_eq!((&copy, &copied_window), (&road, &window));
        }
    }
    let p = RoadParameters { friction: "1 0.5".into(), spacing: 0.2, ..parameters(4) };
    let p = RoadParameters { tracks: 2, friction_right: "1 0.5".into(), friction_deviation: 0.1, ..p };
    let (road_, window) = with_window(&p);
    let value = serde_json::to_value(&road_).unwrap();
    for (path, number) in [
        ("/along/0", 2.0),
        ("/half_width", 0.0),
        ("/left/polyline/kinks/1/at", -1.0),
        ("/left/polyline/period", 0.01),
        ("/friction/left/steps/0/factor", -0.5),
        ("/friction/right/steps/0/factor", -0.5),
        ("/friction/variation/amplitude", 1.5),
        ("/friction/variation/spacing", 0.0),
        ("/friction/variation/offset", 1.0),
    ] {
        let mut value = value.clone();
        *value.pointer_mut(path).unwrap() = number.into();
        let damaged: Road = serde_json::from_value(value).unwrap();
        assert!(damaged.check().is_err(), "{path}");
    }
    let value = serde_json::to_value(&window).unwrap();
    for (path, number) in
        [("/length", 0.0), ("/length", 21.0), ("/left/phases/1/0", 2.0), ("/left/wave", 2.0)]
    {
        let mut value = value.clone();
        *value.pointer_mut(path).unwrap() = number.into();
        let damaged: Window = serde_json::from_value(value).unwrap();
        assert!(damaged.check(&road_).is_err(), "{path}");
    }
    for path in ["/left/phases", "/left/lines", "/right/phases", "/right/lines"] {
        let irregular = RoadParameters { coherence_length: 1.0, ..parameters(6) };
        let profiles = RoadParameters {
            profile: "0 0; 1 2; 2 1".into(),
            profile_right: "0 1; 1 0".into(),
            ..parameters(8)
        };
        let (road, window) = with_window(if path.contains("lines") { &irregular } else { &profiles });
        let mut value = serde_json::to_value(&window).unwrap();
        value.pointer_mut(path).unwrap().as_array_mut().unwrap().pop();
        assert!(serde_json::from_value::<Window>(value).unwrap().check(&road).is_err(), "{path}");
    }
    let mut value = serde_json::to_value(road(&parameters(6))).unwrap();
    value.pointer_mut("/left/irregular/octaves").unwrap().as_array_mut().unwrap().pop();
    assert!(serde_json::from_value::<Road>(value).unwrap().check().is_err());
}

#[test]
fn a_window_of_another_road_is_found_and_is_no_panic() {
    let roads = [
        RoadParameters { spacing: 0.2, ..parameters(4) },
        RoadParameters { profile: "0 0; 1 1".into(), profile_right: "0 0; 1 1; 2 0".into(), ..parameters(8) },
        RoadParameters { coherence_length: 1.0, ..parameters(6) },
        parameters(1),
    ];
    for (i, one) in roads.iter().enumerate() {
        let (road, _) = with_window(one);
        Window::point().check(&road).unwrap();
        for (j, other) in roads.iter().enumerate() {
            let (_, window) = with_window(other);
            assert_eq!(window.check(&road).is_ok(), i == j, "{i} {j}");
            for place in [-1e300, 4.95, 5.0, 5.01, 6.0, 20.0, 1e300, f64::INFINITY, f64::NAN] {
                std::hint::black_box((road.mean(&window, place, 0.3), road.at(place, place)));
            }
        }
    }
}
