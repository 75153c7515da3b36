//! `latsch tire`: tire property files.

use super::{check_outputs, print, warn};
use latsch::model::{Settings, Value};
use latsch::recording::read_settings;
use latsch::tir::{Document, read, settings, write};
use latsch::tire::magic_formula::{Field, field};
use latsch::{Error, Result, write_file};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Check, convert and change a tire property file (.tir) of the Magic Formula 5.2
///
/// Without --output it says what the models make of the file. With an output that ends in .toml it writes the
/// parameters of the models with this tire (magic-formula-wheel and others), for --parameters; with one that ends in .tir, the
/// file with the values of --parameters in place of its own and nothing else changed.
#[derive(clap::Args)]
pub struct Args {
    /// The tire property file
    #[arg(value_name = "F.tir")]
    file: PathBuf,
    /// Values that replace the file's: TOML with [parameters], such as the fitted.toml of a diagnosis
    #[arg(long, value_name = "F.toml")]
    parameters: Option<PathBuf>,
    /// The file to write: .toml or .tir
    #[arg(long, short, value_name = "F.toml|F.tir")]
    output: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<()> {
    let (tire, notes) = settings(&args.file)?;
    for note in &notes {
        warn(note);
    }
    let own = read_settings(args.parameters.as_deref())?;
    let Some(output) = &args.output else {
        let used = tire.values.len() - 1;
        return print(&format!(
            "{}: a Magic Formula tire, {used} coefficients are used",
            args.file.display()
        ));
    };
    let read_files: Vec<&Path> =
        std::iter::once(&args.file).chain(&args.parameters).map(PathBuf::as_path).collect();
    check_outputs(&[output], &read_files)?;
    let ending = output.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "toml" => write_file(output, as_toml(&over(tire, own)).as_bytes())?,
        "tir" => {
            let mut document = Document::open(&args.file)?;
            let changed = change(&mut document, &own)?;
            write_file(output, document.bytes())?;
            print(&format!("{changed} values differ from {}", args.file.display()))?;
        }
        _ => {
            return Err(Error::call(format!(
                "{}: the output ends in .toml (parameters for models) or .tir (a tire property file)",
                output.display()
            )));
        }
    }
    print(&format!("{}: written", output.display()))
}

/// The parameters of a tire, with those of a file of the user's in place of them.
pub(super) fn over(tire: Settings, mut own: Settings) -> Settings {
    let kept = tire.values.into_iter().filter(|t| !own.values.iter().any(|o| o.name == t.name));
    let mut values: Vec<_> = kept.collect();
    values.append(&mut own.values);
    Settings { values, ..own }
}

/// The coefficient that a setting is for.
fn coefficient(name: &str) -> Option<&'static Field> {
    field(name).filter(|field| field.name == name)
}

/// Writes coefficients into a document; returns how many differ from what was there. Other parameters of a model are none of
/// its business.
fn change(document: &mut Document, own: &Settings) -> Result<usize> {
    let mut coefficients = read(document)?.coefficients;
    for setting in &own.values {
        let Some(field) = coefficient(&setting.name) else { continue };
        let value = match &setting.value {
            Value::Real(value) => *value,
            Value::Integer(value) => f64::from(*value),
            Value::Text(text) => {
                latsch::model::unit::quantity(text, field.unit).map_err(|e| e.at(&setting.place))?
            }
            Value::Boolean(_) => {
                return Err(Error::file(format!("{}: {} is a number", setting.place, setting.name)));
            }
        };
        (field.set)(&mut coefficients, value);
    }
    write(&coefficients, document)
}

fn as_toml(settings: &Settings) -> String {
    let mut text = String::from("[parameters]\n");
    for setting in &settings.values {
        let value = match &setting.value {
            Value::Text(text) => toml::Value::String(text.clone()).to_string(),
            other => other.to_string(),
        };
        let about = coefficient(&setting.name)
            .map(|field| format!(" # {} [{}]", field.description, field.unit))
            .unwrap_or_default();
        let _ = writeln!(text, "{} = {value}{about}", setting.name);
    }
    text
}
