//! The checked-in `modelDescription/` is what the models export: a change of an interface shows in a
//! review. `UPDATE_DESCRIPTIONS=1 cargo test --test model_description` writes the files anew.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use latsch::fmi::archive::{ModelLibrary, description_of, page_of};
use latsch::model::unit::Unit;
use latsch::model::{Causality, Settings};
use latsch::report::escape;
use latsch::shipped::MODELS;
use quick_xml::events::Event;
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn checked_in_descriptions_are_current() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("modelDescription");
    for entry in MODELS {
        let path = folder.join(format!("{}.xml", entry.name));
        let current = description_of(&(entry.table)(), &Settings::default()).unwrap();
        if std::env::var_os("UPDATE_DESCRIPTIONS").is_some() {
            std::fs::write(&path, &current).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        if kept != current {
            let line = kept.lines().zip(current.lines()).position(|(a, b)| a != b);
            panic!(
                "{} differs from line {:?} on: an interface changed; if that is meant, run the test with UPDATE_DESCRIPTIONS=1",
                path.display(),
                line.map(|l| l + 1)
            );
        }
    }
}

#[test]
fn shipped_library_has_the_shipped_models() {
    // it refuses a library with other tables by itself
    let library = ModelLibrary::shipped(MODELS).unwrap();
    let names: Vec<&str> = library.models.iter().map(|m| m.name.as_str()).collect();
    let shipped: Vec<&str> = MODELS.iter().map(|m| m.name).collect();
    assert_eq!(names, shipped);
    // a program with other models does not take it
    let mut other = MODELS.to_vec();
    other[0].table = other[1].table;
    let message = ModelLibrary::shipped(&other).unwrap_err().to_string();
    assert!(message.contains(&format!("its {} differs", other[0].name)), "{message}");
}

#[test]
fn archives_are_reproducible() {
    let library = ModelLibrary::shipped(MODELS).unwrap();
    let make = || library.fmu(MODELS[0].name, &Settings::default(), &[]).unwrap();
    assert!(make() == make());
}

#[test]
fn tables_are_well_formed() {
    for entry in MODELS {
        let table = (entry.table)();
        let mut names = BTreeSet::new();
        for v in &table.variables {
            assert!(names.insert(&v.name), "{} twice", v.name);
            // coefficients of tire property files keep the names that they have there; a dot stands behind a part of which there are
            // several
            let fits = |part: &str, case: fn(&char) -> bool| {
                part.chars().all(|c| case(&c) || c.is_ascii_digit() || c == '_')
            };
            let lower = |part: &str| fits(part, char::is_ascii_lowercase);
            let (parts, own) = v.name.rsplit_once('.').unwrap_or(("", &v.name));
            assert!(
                parts.split('.').all(lower) && (lower(own) || fits(own, char::is_ascii_uppercase)),
                "{}",
                v.name
            );
            assert!(
                v.description.len() > 3 && !v.description.ends_with('.'),
                "{}: {:?}",
                v.name,
                v.description
            );
            assert_eq!(v.is_real(), v.unit.is_some(), "{} and its unit", v.name);
            if let Some(unit) = &v.unit {
                let unit = Unit::parse(unit).unwrap();
                assert!(unit.factor == 1.0 && unit.offset == 0.0, "{} is not in SI units", v.name);
            }
            let given = matches!(v.causality, Causality::Parameter | Causality::Input);
            assert_eq!(given, v.start.is_some(), "{} and its start value", v.name);
            if let Some(start) = &v.start {
                v.accept(start).unwrap();
            }
        }
    }
}

#[test]
fn pages_have_every_variable_and_nothing_from_outside() {
    for entry in MODELS {
        let html = page_of(entry).unwrap();
        for v in &(entry.table)().variables {
            assert!(html.contains(&format!("<code>{}</code></td>", v.name)), "{}", v.name);
            assert!(html.contains(&escape(&v.description)), "{}", v.name);
        }
        for outside in ["http:", "https:", "url(", "@import", "src=", "<script", "<link"] {
            assert!(!html.contains(outside), "{outside}");
        }
        for topic in ["Equations", "Validity and limits", "Axes and signs", "Numerics", "License"] {
            let mut headings = html.split("<h2").filter_map(|part| part.split_once('>'));
            assert!(headings.any(|(_, text)| text.starts_with(topic)), "{}: {topic}", entry.name);
        }
    }
}

#[test]
fn markup_in_an_authors_text_is_well_formed() {
    let drawing = include_str!("../src/rig/axes.svg").to_owned();
    for text in MODELS.iter().map(|entry| entry.documentation.concat()).chain([drawing]) {
        let mut reader = quick_xml::Reader::from_str(&text);
        let mut open: Vec<String> = Vec::new();
        loop {
            match reader.read_event().unwrap() {
                Event::Start(tag) => open.push(tag.name().as_ref().to_string()),
                Event::End(tag) => assert_eq!(open.pop().as_deref(), Some(tag.name().as_ref())),
                Event::Eof => break,
                _ => {}
            }
        }
        assert!(open.is_empty());
    }
}

#[test]
fn wheels_that_steer_and_lean_have_a_drawing_of_their_axes() {
    for (name, count) in [("flat-track", 1), ("wheel", 1), ("tire", 1), ("drum", 1), ("hydropulse", 0)] {
        let entry = MODELS.iter().find(|entry| entry.name == format!("ring-brush-{name}")).unwrap();
        let html = page_of(entry).unwrap();
        assert_eq!(html.matches("Axes and signs of a wheel from above").count(), count, "{name}");
        assert!(!html.contains("<!-- axes"), "{name}");
    }
}
