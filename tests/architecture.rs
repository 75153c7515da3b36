//! Arrows point down: no folder of src/ uses one that stands above it.
//!
//! The sources are read as they are written: `use` in all its forms, with lists and over several lines, and paths in
//! expressions. A name that a module re-exports leads on to where it is from. Tests may look anywhere.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The folders and files of src/ in the order of ARCHITECTURE.md, the lowest first: each with those that it may use
/// beside the [`GROUND`], all of which stand before it. What is not named belongs to the folder that it is in.
///
/// An arrow that is new is a decision: it is written here, or the code goes where it needs none.
const ORDER: &[(&str, &str)] = &[
    ("shown", ""),
    ("error", ""),
    ("bounded", ""),
    ("fmi/signal", ""), // system calls stand under fmi, the only place of unsafe
    ("temporary", "fmi/signal"),
    ("file", ""),
    ("page", ""),
    ("solver", ""),
    ("stats", ""),
    ("model", ""),
    ("road", "model solver stats"),
    ("mechanics", "model solver"),
    ("tire", "model solver road mechanics"),
    ("tir", "model tire"),
    ("rig", "model solver road mechanics tire"),
    ("control", "model solver"),
    ("effect", "model"),
    ("fmi/c", ""),
    ("fmi/float", ""),
    ("fmi/state", "fmi/c"),
    ("fmi/log", "fmi/c fmi/float"),
    ("fmi/entry", "model"),
    ("fmi/resources", ""),
    ("fmi/import", "model fmi/c"),
    ("fmi/make", "model effect fmi/entry fmi/import"),
    ("fmi/instance", "model fmi/c fmi/state fmi/log fmi/entry fmi/resources fmi/import fmi/make"),
    ("fmi/panics", ""),
    ("fmi/pointers", "fmi/c"),
    ("fmi/export", "fmi/c fmi/float fmi/state fmi/log fmi/entry fmi/instance fmi/panics fmi/pointers"),
    ("fmi/export3", "fmi/c fmi/state fmi/log fmi/entry fmi/export"),
    ("fmi/symbols", "fmi/c fmi/state fmi/entry fmi/export fmi/export3"),
    ("fmi", "fmi/c fmi/entry fmi/state"), // what its mod.rs passes on
    ("fmi/platform", "fmi/c"),
    ("fmi/description", "model fmi/log fmi/import"),
    ("fmi/description3", "model fmi/instance fmi/import fmi/description"),
    ("fmi/documentation", "page model fmi/c fmi/state fmi/log fmi/import fmi/platform fmi/description"),
    (
        "fmi/archive",
        "model fmi/c fmi/entry fmi/import fmi/make fmi/export fmi/platform fmi/description fmi/description3 fmi/documentation",
    ),
    (
        "fmi/corrected",
        "page model effect fmi/c fmi/entry fmi/import fmi/make fmi/description fmi/documentation fmi/archive",
    ),
    ("fmi/check", "model fmi/c fmi/import"),
    ("shipped", "tire rig control fmi fmi/entry"),
    ("recording", "stats model road"),
    ("road_file", "model road tir recording"),
    ("tire_function", "model road mechanics tire tir rig road_file"),
    ("fmi/tire_function", "tire_function fmi/float fmi/panics fmi/pointers"),
    ("simulate", "stats model recording"),
    (
        "cosimulate",
        "stats model effect fmi fmi/entry fmi/import fmi/archive fmi/corrected shipped recording simulate",
    ),
    ("fit", "stats model effect"),
    ("characteristic", "stats model recording fit"),
    ("curves", "model recording"),
    ("comparison", "stats recording characteristic"),
    ("loads", "stats model recording"),
    ("lint", "model recording cosimulate"),
    ("causes", "stats model recording cosimulate fit loads"),
    ("freeze", "model fmi/import cosimulate"),
    ("manoeuvre", "stats model recording cosimulate"),
    ("identify", "stats model rig recording"),
    (
        "diagnose",
        "page stats model effect fmi fmi/entry fmi/import shipped recording simulate cosimulate fit",
    ),
    (
        "report",
        "page stats model tire rig recording characteristic curves comparison loads causes identify diagnose",
    ),
    (
        "cli",
        "page stats model tire tir road_file rig control effect fmi fmi/c fmi/entry fmi/import fmi/archive fmi/corrected fmi/check shipped \
         recording simulate cosimulate characteristic curves comparison loads lint causes freeze manoeuvre identify diagnose report",
    ),
];

/// The files of fmi/check, the lowest first: the processes know cases only as what they are given, and nothing below
/// its `mod.rs` knows that.
const CHECK: &[&str] = &[
    "fmi/check/rules",
    "fmi/check/finding",
    "fmi/check/tree",
    "fmi/check/report",
    "fmi/check/schema",
    "fmi/check/archive",
    "fmi/check/description",
    "fmi/check/reporter",
    "fmi/check/memory",
    "fmi/check/float_mode",
    "fmi/check/system",
    "fmi/check/unit",
    "fmi/check/lab",
    "fmi/check/parent",
    "fmi/check/child",
    "fmi/check/cases",
    "fmi/check",
];

/// What all may use that stand above it: messages, files, limits of what is read.
const GROUND: &[&str] = &["shown", "error", "bounded", "temporary", "file"];

/// Arrows that go up today: from, to, and why. One that is mended is taken out here.
const EXCEPTIONS: &[(&str, &str, &str)] = &[];

// ---- words

/// Words and signs of Rust, `::` as one; comments are gone, texts and characters are one sign each.
fn words(source: &str) -> Vec<String> {
    let c: Vec<char> = source.chars().collect();
    let at = |i: usize| c.get(i).copied().unwrap_or('\0');
    let is_word = |x: char| x.is_alphanumeric() || x == '_';
    let (mut words, mut i) = (Vec::new(), 0);
    while i < c.len() {
        let raw = |mut i: usize| {
            let first = i;
            while at(i) == '#' {
                i += 1;
            }
            (at(i) == '"').then_some((i, i - first))
        };
        if at(i) == '/' && at(i + 1) == '/' {
            while i < c.len() && at(i) != '\n' {
                i += 1;
            }
        } else if at(i) == '/' && at(i + 1) == '*' {
            let mut depth = 0;
            loop {
                match (at(i), at(i + 1)) {
                    ('/', '*') => (depth, i) = (depth + 1, i + 2),
                    ('*', '/') => (depth, i) = (depth - 1, i + 2),
                    _ => i += 1,
                }
                if depth == 0 || i >= c.len() {
                    break;
                }
            }
        } else if at(i) == '"' {
            i += 1;
            while i < c.len() && at(i) != '"' {
                i += if at(i) == '\\' { 2 } else { 1 };
            }
            i += 1;
            words.push("\"".into());
        } else if at(i) == '\'' {
            // a character or a lifetime
            let end = match (at(i + 1), at(i + 2)) {
                ('\\', _) => (i + 3..c.len()).find(|k| at(*k) == '\'').map(|k| k + 1),
                (_, '\'') => Some(i + 3),
                _ => None,
            };
            i = end.unwrap_or(i + 1);
            words.push("'".into());
        } else if is_word(at(i)) {
            let first = i;
            while is_word(at(i)) {
                i += 1;
            }
            let word: String = c[first..i].iter().collect();
            match raw(i) {
                Some((quote, hashes)) if matches!(word.as_str(), "r" | "br" | "cr") => {
                    let ends = |k: &usize| at(*k) == '"' && (1..=hashes).all(|h| at(k + h) == '#');
                    i = (quote + 1..c.len()).find(ends).map_or(c.len(), |k| k + 1 + hashes);
                    words.push("\"".into());
                }
                _ => words.push(word),
            }
        } else if at(i) == ':' && at(i + 1) == ':' {
            words.push("::".into());
            i += 2;
        } else {
            if !at(i).is_whitespace() {
                words.push(at(i).into());
            }
            i += 1;
        }
    }
    words
}

/// The place behind the bracket that closes the one at `open`.
fn behind(words: &[String], open: usize) -> usize {
    let mut depth = 0;
    for (i, word) in words.iter().enumerate().skip(open) {
        match word.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return i + 1;
        }
    }
    words.len()
}

// ---- modules

type Names = Vec<String>;

/// What is in the sources. A module is the names on the way to it from the root.
#[derive(Default)]
struct House {
    modules: BTreeSet<Names>,
    /// Modules that are only there in tests.
    tests: BTreeSet<Names>,
    /// Names that a module has from elsewhere: what they stand for.
    imported: BTreeMap<(Names, String), Names>,
    /// Macros, which all stand at the root: where they are from.
    macros: BTreeMap<String, Names>,
    /// Paths in the sources: module, path from the root, and where that is.
    paths: Vec<(Names, Names, PathBuf)>,
}

impl House {
    /// Reads what of a file stands between two places, as part of a module.
    fn read(&mut self, words: &[String], module: &Names, file: &Path) {
        let word = |i: usize| words.get(i).map_or("", String::as_str);
        let mut i = 0;
        let mut exported = false;
        while i < words.len() {
            match word(i) {
                "#" if word(i + 1) == "[" => {
                    let end = behind(words, i + 1);
                    let said: Vec<&str> = words[i + 2..end - 1].iter().map(String::as_str).collect();
                    exported |= said == ["macro_export"];
                    let tested =
                        said.first() == Some(&"cfg") && said.contains(&"test") && !said.contains(&"not");
                    i = if tested || said == ["test"] { self.skip_item(words, end, module) } else { end };
                }
                "mod" if word(i + 2) == "{" => {
                    let inner = [module.clone(), vec![word(i + 1).into()]].concat();
                    self.modules.insert(inner.clone());
                    let end = behind(words, i + 2);
                    self.read(&words[i + 3..end - 1], &inner, file);
                    i = end;
                }
                "macro_rules" if exported => {
                    self.macros.insert(word(i + 2).into(), module.clone());
                    exported = false;
                    i += 3;
                }
                "use" => {
                    let end = (i..words.len()).find(|k| word(*k) == ";").unwrap_or(words.len());
                    self.read_use(&words[i + 1..end], &Vec::new(), module, file);
                    i = end;
                }
                // pub(in crate::a) says who may use this, and uses nothing
                "pub" if word(i + 1) == "(" => i = behind(words, i + 1),
                first if word(i + 1) == "::" && (i == 0 || word(i - 1) != "::") => {
                    let mut path: Names = vec![first.into()];
                    while word(i + 1) == "::"
                        && word(i + 2).starts_with(|c: char| c.is_alphabetic() || c == '_')
                    {
                        path.push(word(i + 2).into());
                        i += 2;
                    }
                    self.paths.push((module.clone(), path, file.into()));
                    i += 1;
                }
                _ => i += 1,
            }
        }
    }

    /// The place behind an item that is only there in tests.
    fn skip_item(&mut self, words: &[String], mut i: usize, module: &Names) -> usize {
        while i < words.len() {
            match words[i].as_str() {
                "#" => i = behind(words, i + 1),
                "mod" => {
                    self.tests.insert([module.clone(), vec![words[i + 1].clone()]].concat());
                    i += 2;
                }
                "use" => return words[i..].iter().position(|w| w == ";").map_or(words.len(), |n| i + n + 1),
                "(" | "[" => i = behind(words, i),
                "{" => return behind(words, i),
                ";" => return i + 1,
                _ => i += 1,
            }
        }
        i
    }

    /// One branch of a tree of names behind `use`.
    fn read_use(&mut self, words: &[String], before: &Names, module: &Names, file: &Path) {
        let mut path = before.clone();
        let mut i = 0;
        while i < words.len() {
            match words[i].as_str() {
                "::" => {}
                "{" => {
                    let inside = &words[i + 1..behind(words, i) - 1];
                    let mut first = 0;
                    while first < inside.len() {
                        let mut end = first;
                        while end < inside.len() && inside[end] != "," {
                            end = if inside[end] == "{" { behind(inside, end) } else { end + 1 };
                        }
                        self.read_use(&inside[first..end], &path, module, file);
                        first = end + 1;
                    }
                    return;
                }
                "*" => {
                    self.paths.push((module.clone(), path, file.into()));
                    return;
                }
                "as" => {
                    self.import(words[i + 1].clone(), path, module, file);
                    return;
                }
                name => path.push(name.into()),
            }
            i += 1;
        }
        if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        if let Some(last) = path.last().cloned() {
            self.import(last, path, module, file);
        }
    }

    fn import(&mut self, name: String, path: Names, module: &Names, file: &Path) {
        self.paths.push((module.clone(), path.clone(), file.into()));
        self.imported.insert((module.clone(), name), path);
    }

    /// A path of a module from the root; `None` if it leads out of the sources.
    fn rooted(&self, module: &Names, path: &[String]) -> Option<Names> {
        let mut place: Names = Vec::new();
        let mut rest = path;
        match path.first()?.as_str() {
            // the program calls the library so
            "crate" | "latsch" => rest = &path[1..],
            "self" | "super" => {
                place = module.clone();
                while let Some(first) = rest.first().filter(|f| matches!(f.as_str(), "self" | "super")) {
                    if first == "super" {
                        place.pop();
                    }
                    rest = &rest[1..];
                }
            }
            first => {
                // a module in this one, or a name that this one has from elsewhere
                let child = [module.clone(), vec![first.to_owned()]].concat();
                let imported = self.imported.get(&(module.clone(), first.to_owned()));
                match imported.filter(|from| from[0] != first) {
                    Some(from) => place = self.rooted(module, from)?,
                    None if self.modules.contains(&child) => place = child,
                    None => return None,
                }
                rest = &path[1..];
            }
        }
        place.extend_from_slice(rest);
        Some(place)
    }

    /// The modules that a path uses: the one where its end is from, and those that pass it on.
    fn used(&self, module: &Names, path: &[String]) -> Vec<Names> {
        let mut used = Vec::new();
        let mut next = self.rooted(module, path);
        // a name that leads in a circle is none that compiles
        for _ in 0..9 {
            let Some(path) = next.take() else { break };
            let mut place: Names = Vec::new();
            for (k, name) in path.iter().enumerate() {
                let inner = [place.clone(), vec![name.clone()]].concat();
                if self.modules.contains(&inner) {
                    place = inner;
                    continue;
                }
                if let Some(passed) = self.imported.get(&(place.clone(), name.clone())) {
                    next = self.rooted(&place, passed).map(|p| [p, path[k + 1..].to_vec()].concat());
                } else if let (true, Some(from)) = (place.is_empty(), self.macros.get(name)) {
                    place = from.clone();
                }
                break;
            }
            used.push(place);
        }
        used
    }
}

/// The sources in a folder, by module.
fn read_folder(folder: &Path, module: &Names, found: &mut Vec<(Names, PathBuf)>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let inner = [module.clone(), vec![name.clone()]].concat();
        if path.is_dir() {
            read_folder(&path, &inner, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let is_own = matches!(name.as_str(), "mod" | "lib" | "main");
            found.push((if is_own { module.clone() } else { inner }, path));
        }
    }
}

fn read_house(sources: &[(Names, PathBuf, String)]) -> House {
    let mut house = House::default();
    house.modules.extend(sources.iter().map(|(module, ..)| module.clone()));
    for (module, file, text) in sources {
        house.read(&words(text), module, file);
    }
    house
}

/// The room that a module belongs to: the one with the longest name on the way to it. None for the root.
fn room<'a>(order: &[&'a str], module: &[String]) -> Option<&'a str> {
    (1..=module.len()).rev().find_map(|n| {
        let name = module[..n].join("/");
        order.iter().find(|room| **room == name).copied()
    })
}

/// What uses what: from room, to room, and a place where.
fn arrows<'a>(house: &House, order: &[&'a str]) -> BTreeMap<(&'a str, &'a str), String> {
    let mut arrows = BTreeMap::new();
    for (module, path, file) in &house.paths {
        let is_test = (1..=module.len()).any(|n| house.tests.contains(&module[..n]));
        let Some(from) = room(order, module).filter(|_| !is_test) else { continue };
        for to in house.used(module, path).iter().filter_map(|to| room(order, to)) {
            if from != to {
                let place = format!("{}: {}", file.display(), path.join("::"));
                arrows.entry((from, to)).or_insert(place);
            }
        }
    }
    arrows
}

/// The sources in src/.
fn sources() -> Vec<(Names, PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    read_folder(&root, &Vec::new(), &mut found);
    let read = |(module, file): (Names, PathBuf)| {
        let text = std::fs::read_to_string(&file).unwrap();
        (module, file.strip_prefix(&root).unwrap().to_owned(), text)
    };
    found.into_iter().map(read).collect()
}

#[test]
fn the_order_is_one() {
    let place = |room: &str| ORDER.iter().position(|(name, _)| *name == room);
    for (i, (name, uses)) in ORDER.iter().enumerate() {
        assert_eq!(place(name), Some(i), "{name} is there twice");
        for used in uses.split_whitespace() {
            let below =
                place(used).unwrap_or_else(|| panic!("{name} may use {used}, which is not in the order"));
            assert!(below < i, "{name} may not use {used}, which stands above it");
        }
    }
    assert!(GROUND.iter().all(|name| place(name).is_some()));
}

#[test]
fn no_folder_uses_one_above_it() {
    let order: Vec<&str> = ORDER.iter().map(|(name, _)| *name).collect();
    let house = read_house(&sources());
    for module in house.modules.iter().filter(|module| !module.is_empty()) {
        assert!(room(&order, module).is_some(), "src/{} is not in the order: add a line", module.join("/"));
    }
    let arrows = arrows(&house, &order);
    // the reader has read: what everybody knows is there
    for known in [("rig", "tire"), ("diagnose", "fit"), ("cli", "report"), ("fmi/make", "effect")] {
        assert!(arrows.contains_key(&known), "{known:?}");
    }
    let place = |room: &str| order.iter().position(|name| *name == room);
    let may = |from: &str, to: &str| {
        let listed =
            ORDER.iter().any(|(name, uses)| *name == from && uses.split_whitespace().any(|u| u == to));
        listed || (GROUND.contains(&to) && place(to) < place(from))
    };
    let is_exception = |from: &str, to: &str| EXCEPTIONS.iter().any(|(a, b, _)| (*a, *b) == (from, to));
    let wrong: Vec<String> = arrows
        .iter()
        .filter(|((from, to), _)| !may(from, to) && !is_exception(from, to))
        .map(|((from, to), place)| format!("{from} uses {to}, as in src/{place}"))
        .collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    for (from, to, _) in EXCEPTIONS {
        assert!(
            arrows.contains_key(&(from, to)),
            "{from} does not use {to} any more: no exception is needed"
        );
    }
}

#[test]
fn the_files_of_the_check_are_a_tree() {
    let arrows = arrows(&read_house(&sources()), CHECK);
    assert!(arrows.contains_key(&("fmi/check/cases", "fmi/check/lab")));
    let place = |room: &str| CHECK.iter().position(|name| *name == room);
    let up: Vec<_> = arrows.iter().filter(|((from, to), _)| place(to) > place(from)).collect();
    assert!(up.is_empty(), "{up:#?}");
}

#[test]
fn no_form_of_use_is_overlooked() {
    let order = ["low", "middle", "high", "macros"];
    let upwards = |text: &str| -> Vec<String> {
        let file = |module: &[&str], text: &str| {
            let names: Names = module.iter().map(|m| (*m).to_owned()).collect();
            (names, PathBuf::from(module.join("/")), text.to_owned())
        };
        let house = read_house(&[
            file(
                &[],
                "mod low; mod middle; mod high; mod macros; pub use high::Top; pub use crate::high::Top as Peak;",
            ),
            file(&["low"], text),
            file(&["low", "inner"], ""),
            file(
                &["middle"],
                "pub use crate::high::{deep::Thing, Other as Renamed}; pub use self::own::Own; mod own;",
            ),
            file(&["middle", "own"], "pub struct Own;"),
            file(&["high"], "pub struct Top; pub mod deep;"),
            file(&["high", "deep"], ""),
            file(&["macros"], "#[macro_export] macro_rules! made { () => {} }"),
        ]);
        let arrows = arrows(&house, &order);
        arrows.keys().filter(|(from, _)| *from == "low").map(|(_, to)| (*to).to_owned()).collect()
    };
    for (text, used) in [
        ("", &[][..]),
        ("use crate::high::Top;", &["high"]),
        (
            "use crate::{\n    low::inner,\n    high::{\n        deep::{self, Thing as T},\n    },\n};",
            &["high"],
        ),
        ("use super::high::*;", &["high"]),
        ("mod nested { use super::super::middle; }", &["middle"]),
        ("pub(crate) fn f() -> crate::high::Top { loop {} }", &["high"]),
        ("fn f(x: &'static str) -> char { let _: super::high::deep::Thing; 'x' }", &["high"]),
        ("fn f() { for x in crate::high::ALL { x(&crate::middle::Y) } }", &["high", "middle"]),
        // a name that is passed on is used where it is from, too
        ("use crate::Top;", &["high"]),
        ("fn f() { latsch::Peak::new() }", &["high"]),
        ("use crate::middle::Thing;", &["high", "middle"]),
        ("use crate::middle::Renamed;", &["high", "middle"]),
        ("use crate::middle::Own;", &["middle"]),
        ("use crate::middle as m; fn f() { m::Thing::new() }", &["high", "middle"]),
        ("crate::made!();", &["macros"]),
        // what is no use
        ("//! [`Top`](crate::high::Top)\n/* use crate::high::Top; /* */ */", &[]),
        ("const A: &str = \"use crate::high::Top;\"; const B: &str = r#\"\" crate::high::Top\"#;", &[]),
        ("const QUOTE: char = '\"'; pub(in crate::low) struct A; use self::inner::x; use std::high::x;", &[]),
        // tests may look anywhere, and what stands behind them is still seen
        ("#[cfg(test)]\nmod tests {\n    use crate::high::Top;\n    fn f() { {} }\n}", &[]),
        ("#[cfg(all(test, unix))] #[path = \"x\"] mod inner; use crate::middle::own;", &["middle"]),
        ("#[test] fn f() { crate::high::g([1; 2]) }\nfn g() { crate::middle::g() }", &["middle"]),
        ("#[cfg(test)] use crate::high::{Top, deep}; use crate::middle;", &["middle"]),
        ("#[cfg(not(test))] use crate::high::Top;", &["high"]),
        ("#[cfg_attr(test, allow(dead_code))] use crate::high::Top;", &["high"]),
    ] {
        assert_eq!(upwards(text), used, "{text}");
    }
}
