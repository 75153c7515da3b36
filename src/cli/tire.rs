//! `latsch tire`: tire property files.

use super::given::over;
use super::{check_outputs, print, warn};
use latsch::fmi::Entry;
use latsch::model::Settings;
use latsch::recording::read_settings;
use latsch::shipped::MODELS;
use latsch::tir::{Document, Kind, TireFile, change, settings};
use latsch::{Error, Result, ending, write_file};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Check, convert and change a tire property file (.tir) of the Magic Formula 5.2 or of the super-elastic tire (TYR501)
///
/// Without --output it says what the models make of the file. With an output that ends in .toml it writes the
/// parameters of the models with this tire (magic-formula-wheel, super-elastic-wheel and others), for --parameters; with one that
/// ends in .tir, the file with the values of --parameters in place of its own and nothing else changed.
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
    let TireFile { kind, settings: tire, notes } = settings(&args.file)?;
    for note in &notes {
        warn(note);
    }
    let own = read_settings(args.parameters.as_deref())?;
    let Some(output) = &args.output else {
        let used = tire.values.len() - 1;
        let what = match kind {
            Kind::MagicFormula => "coefficients",
            Kind::SuperElastic => "parameters",
        };
        return print(&format!("{}: a {}, {used} {what} are used", args.file.display(), kind.title()));
    };
    let read_files: Vec<&Path> =
        std::iter::once(&args.file).chain(&args.parameters).map(PathBuf::as_path).collect();
    check_outputs(&[output], &read_files)?;
    match ending(output).as_str() {
        "toml" => write_file(output, as_toml(&over(tire, own), kind).as_bytes())?,
        "tir" => {
            let mut document = Document::open(&args.file)?;
            let (changed, lost) = change(&mut document, &own)?;
            lost.iter().for_each(|lost| warn(&format!("{} does not have {lost}", output.display())));
            write_file(output, document.bytes())?;
            let differ = if changed == 1 { "value differs" } else { "values differ" };
            print(&format!("{changed} {differ} from {}", args.file.display()))?;
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

/// Parameters as a file, each with its meaning and unit.
pub(super) fn as_toml(settings: &Settings, kind: Kind) -> String {
    let table = Entry::find(MODELS, &format!("{}-tire", kind.name())).map(|entry| (entry.table)());
    let mut text = String::from("[parameters]\n");
    for setting in &settings.values {
        let variable = table.iter().flat_map(|table| &table.variables).find(|v| v.name == setting.name);
        let about = variable.map(|v| match &v.unit {
            Some(unit) => format!(" # {} [{unit}]", v.description),
            None => format!(" # {}", v.description),
        });
        let value = setting.value.to_toml();
        let _ = writeln!(text, "{} = {value}{}", setting.name, about.unwrap_or_default());
    }
    text
}
