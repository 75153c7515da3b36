//! Makes FMUs: description, documentation, resources and binary in a zip archive.

use super::c::Fmi;
use super::description::{capabilities_of, model_description, model_identifier};
use super::description3;
use super::documentation;
use super::entry::{Entry, guid, no_model};
use super::export::Sink;
use super::import::library::{Handle, Names};
use super::make::{MAX_ABOUT, ORIGINAL_DESCRIPTION};
use super::platform::{PLATFORM, PLATFORMS, Platform, folder_of};
use crate::bounded::MAX_TEXT;
use crate::model::{Interface, Settings};
use crate::{Error, Result};
use std::ffi::c_void;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// A binary for another machine or another C library than this one.
#[derive(Debug, Clone)]
pub struct Binary {
    platform: &'static str,
    content: Content,
}

/// What goes into an archive as a binary.
#[derive(Debug, Clone)]
enum Content {
    File(PathBuf),
    /// What this program carries.
    Inside(&'static [u8]),
}

/// The library of the shipped models, where build.rs put it into this program.
const INSIDE: Option<&[u8]> = {
    #[cfg(library_inside)]
    {
        Some(include_bytes!(env!("LATSCH_LIBRARY_FILE")))
    }
    #[cfg(not(library_inside))]
    {
        None
    }
};

impl std::str::FromStr for Binary {
    type Err = String;

    /// From `platform=path`.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let (platform, path) = text.split_once('=').ok_or("PLATFORM=FILE is needed")?;
        match PLATFORMS.iter().find(|p| p.name == platform) {
            Some(known) => Ok(Self { platform: known.name, content: Content::File(path.into()) }),
            None => Err(format!(
                "there is no platform {platform:?}; there is {}",
                PLATFORMS.map(|p| p.name).join(", ")
            )),
        }
    }
}

impl Binary {
    /// Name in the archive and content.
    fn read(&self, identifier: &str, fmi: Fmi) -> Result<(String, Vec<u8>)> {
        let (content, path) = match &self.content {
            Content::File(path) => {
                let content = std::fs::read(path);
                (
                    content.map_err(|e| Error::fmu(format!("{}: {e}", path.display())))?,
                    path.display().to_string(),
                )
            }
            Content::Inside(content) => (content.to_vec(), "the library in this program".into()),
        };
        let known = PLATFORMS.iter().find(|p| p.name == self.platform);
        let Some(Platform { suffix, .. }) = known.filter(|p| content.starts_with(p.start)) else {
            return Err(Error::fmu(format!("{path}: it is no library for {}", self.platform)));
        };
        Ok((format!("binaries/{}/{identifier}{suffix}", folder_of(self.platform, fmi)), content))
    }
}

/// A binary made with [`export_fmus!`](crate::export_fmus), and the interfaces of its models.
#[derive(Debug, Clone)]
pub struct ModelLibrary {
    content: Content,
    /// Interfaces with the start values of the models' tables.
    pub models: Vec<Interface>,
    /// [`Model::DOCUMENTATION`](crate::model::Model::DOCUMENTATION) of each.
    documentation: Vec<String>,
}

/// Name of the library of the shipped models.
pub fn library_file() -> String {
    format!("{}latsch_fmu{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

/// Names the library of the shipped models where it is not in its usual places.
const LIBRARY_VARIABLE: &str = "LATSCH_LIBRARY";
/// The checkout that this program was built in.
const CHECKOUT: &str = env!("CARGO_MANIFEST_DIR");

/// Where the library of the shipped models may be for a program at this path. Not in the folders of the checkout:
/// what cargo left there may be of other sources with the same tables, which nobody would notice.
fn places(program: &Path) -> [PathBuf; 2] {
    let beside = program.parent().unwrap_or(Path::new("."));
    // tests and benchmarks run one folder below the library
    [beside, beside.parent().unwrap_or(beside)].map(|folder| folder.join(library_file()))
}

/// What to do where a program at this path has no library.
fn remedy(program: &Path) -> String {
    // what cargo builds is beside the program already, once it is built
    if program.starts_with(Path::new(CHECKOUT).join("target")) {
        return "\"cargo build --release\" builds it".into();
    }
    let folder = program.parent().and_then(Path::parent).unwrap_or(Path::new("/usr/local"));
    format!(
        "in a checkout, \"LATSCH_LIBRARY_INSIDE=1 cargo install --locked --path . --root {}\" makes a program that carries it",
        folder.display()
    )
}

impl ModelLibrary {
    /// The library of the shipped models that belongs to the running program, which has these `models`
    /// ([`MODELS`](crate::shipped::MODELS)): the one that the environment variable `LATSCH_LIBRARY` names, or the first
    /// that fits beside the program or one folder up. A program that was built with its library inside has that one.
    ///
    /// # Errors
    /// It is nowhere, or was not built together with this program. The message lists the places and says what to
    /// do.
    pub fn shipped(models: &[Entry]) -> Result<Self> {
        if let Some(path) = std::env::var_os(LIBRARY_VARIABLE).filter(|path| !path.is_empty()) {
            let library = Self::fitting(Path::new(&path), models);
            return library.map_err(|e| e.at(LIBRARY_VARIABLE));
        }
        if let Some(content) = INSIDE {
            return Ok(Self::inside(content, models));
        }
        let program =
            std::env::current_exe().map_err(|e| Error::fmu(format!("where is this program? {e}")))?;
        Self::among(&places(&program), &program, models)
    }

    /// The library in this program, which was built of the same sources: its models are those of the program.
    fn inside(content: &'static [u8], models: &[Entry]) -> Self {
        let (models, documentation) =
            models.iter().map(|entry| ((entry.table)(), entry.documentation.concat())).unzip();
        Self { content: Content::Inside(content), models, documentation }
    }

    /// The first library that fits this program, which was started as `program`.
    fn among(places: &[PathBuf], program: &Path, models: &[Entry]) -> Result<Self> {
        let mut tried = Vec::new();
        for path in places {
            let reason = match path.is_file() {
                true => match Self::fitting(path, models) {
                    Ok(library) => return Ok(library),
                    Err(error) => error.to_string(),
                },
                false => format!("{}: not there", path.display()),
            };
            tried.push(reason);
        }
        Err(Error::fmu(format!(
            "the library {}, which goes into FMUs, is needed beside this program: {}; or name one with --library or \
            {LIBRARY_VARIABLE}. It was looked for here: {}",
            library_file(),
            remedy(program),
            tried.join("; ")
        )))
    }

    /// The library at `path`, if it has these models of this program as they are here.
    fn fitting(path: &Path, models: &[Entry]) -> Result<Self> {
        let library = Self::open(path)?;
        for entry in models {
            let own = (entry.table)();
            if library.models.iter().find(|m| m.name == entry.name) != Some(&own) {
                return Err(Error::fmu(format!(
                    "{}: not built together with this program, its {} differs",
                    path.display(),
                    entry.name
                )));
            }
        }
        Ok(library)
    }

    /// The library at `path`, which is loaded to ask it for its models.
    ///
    /// # Errors
    /// Not a library, not one of this kind, or of another version.
    pub fn open(path: &Path) -> Result<Self> {
        let fail = |what: String| Error::fmu(format!("{}: {what}", path.display()));
        let bytes = describe(path).map_err(fail)?;
        let (version, rest) = postcard::take_from_bytes::<String>(&bytes)
            .map_err(|_| fail("the library's answer cannot be read".into()))?;
        if version != crate::VERSION {
            return Err(fail(format!(
                "the library is of version {version}, this program of version {}; build both from the same sources",
                crate::VERSION
            )));
        }
        let models: Vec<(Interface, String)> = postcard::from_bytes(rest).map_err(|_| {
            fail(
                "the library has this program's version but was built from other sources; build both anew"
                    .into(),
            )
        })?;
        let (models, documentation) = models.into_iter().unzip();
        Ok(Self { content: Content::File(path.into()), models, documentation })
    }

    /// The interface of the model called `name`.
    ///
    /// # Errors
    /// None; the message has the most similar one.
    pub fn model(&self, name: &str) -> Result<&Interface> {
        self.find(name).map(|(table, _)| table)
    }

    /// Its interface and documentation.
    pub(super) fn find(&self, name: &str) -> Result<(&Interface, &str)> {
        let mut models = self.models.iter().zip(self.documentation.iter().map(String::as_str));
        models
            .find(|(table, _)| table.name == name)
            .ok_or_else(|| no_model(name, self.models.iter().map(|m| m.name.as_str())))
    }

    /// The page about a model that its FMUs carry, with the model's start values.
    ///
    /// # Errors
    /// No such model.
    pub fn page(&self, model: &str) -> Result<String> {
        let (table, text) = self.find(model)?;
        page_of_table(table, text)
    }

    /// An FMU of a model with these settings, as the bytes of its archive, for FMI 2.0. The same arguments give
    /// the same bytes. With `binaries`, it has those instead of this library.
    ///
    /// # Errors
    /// No such model, settings that it does not accept, a binary that cannot be read, two for one
    /// platform.
    pub fn fmu(&self, model: &str, settings: &Settings, binaries: &[Binary]) -> Result<Vec<u8>> {
        self.fmu_of(Fmi::Two, model, settings, binaries)
    }

    /// The same for any version of the standard.
    ///
    /// # Errors
    /// As [`fmu`](Self::fmu).
    pub fn fmu_of(&self, fmi: Fmi, model: &str, settings: &Settings, binaries: &[Binary]) -> Result<Vec<u8>> {
        let (table, text) = self.find(model)?;
        let resources = settings.to_file(table)?;
        let interface = with_settings(table, settings)?;
        let guid = guid(table, &resources);
        let description = match fmi {
            Fmi::Two => model_description(&interface, &guid)?,
            Fmi::Three => description3::model_description(&interface, &guid, &capabilities_of(&interface))?,
        };
        let page = documentation::page(table, &interface, &guid, text, fmi);
        let mut files: Vec<(String, Vec<u8>)> = vec![
            ("modelDescription.xml".into(), description.into_bytes()),
            ("resources/model.toml".into(), resources.into_bytes()),
        ];
        files.extend(self.binaries(&model_identifier(model), binaries, fmi)?);
        files.extend(documents(page));
        pack(files)
    }

    /// The binaries of an FMU, by name in the archive: those named, or else this library.
    pub(super) fn binaries(
        &self,
        identifier: &str,
        named: &[Binary],
        fmi: Fmi,
    ) -> Result<Vec<(String, Vec<u8>)>> {
        let own = [Binary { platform: PLATFORM, content: self.content.clone() }];
        let mut files: Vec<(String, Vec<u8>)> = Vec::new();
        for binary in if named.is_empty() { &own } else { named } {
            let (name, content) = binary.read(identifier, fmi)?;
            if files.iter().any(|(other, _)| *other == name) {
                return Err(Error::fmu(format!("there are two binaries for {}", binary.platform)));
            }
            files.push((name, content));
        }
        Ok(files)
    }
}

/// The page about a model that its FMUs carry, with the model's start values.
///
/// # Errors
/// None that a model which can be exported has.
pub fn page_of(entry: &Entry) -> Result<String> {
    page_of_table(&(entry.table)(), &entry.documentation.concat())
}

fn page_of_table(table: &Interface, text: &str) -> Result<String> {
    let resources = Settings::default().to_file(table)?;
    Ok(documentation::page(table, table, &guid(table, &resources), text, Fmi::Two))
}

/// The files of `documentation/`.
pub(super) fn documents(page: String) -> Vec<(String, Vec<u8>)> {
    let licenses = documentation::LICENSES
        .map(|(name, text)| (format!("documentation/licenses/{name}"), text.as_bytes().to_vec()));
    let mut files = vec![("documentation/index.html".into(), page.into_bytes())];
    files.extend(licenses);
    files
}

/// An archive with these files.
///
/// # Errors
/// Resources that an instance would refuse to read.
pub(super) fn pack(files: Vec<(String, Vec<u8>)>) -> Result<Vec<u8>> {
    let about = format!("resources/{ORIGINAL_DESCRIPTION}");
    for (name, most) in [("resources/model.toml", MAX_TEXT), (about.as_str(), MAX_ABOUT)] {
        if let Some((_, content)) = files.iter().find(|(n, content)| n == name && content.len() as u64 > most)
        {
            return Err(Error::fmu(format!(
                "{name} would have {} bytes, and an FMU reads no more than {most}: shorten the texts among the parameters",
                content.len()
            )));
        }
    }
    let broken = |e: &dyn std::fmt::Display| Error::fmu(format!("the archive cannot be written: {e}"));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        // fast: nobody waits for the last few percent
        .compression_level(Some(1))
        .last_modified_time(DateTime::default());
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        // Binaries are stored as they are: to inflate one takes three times as long as all else of loading an FMU, and
        // deflating would only halve it.
        let options = match name.starts_with("binaries/") {
            true => options
                .unix_permissions(0o755)
                .compression_method(CompressionMethod::Stored)
                .compression_level(None),
            false => options.unix_permissions(0o644),
        };
        archive.start_file(name, options).map_err(|e| broken(&e))?;
        archive.write_all(&content).map_err(|e| broken(&e))?;
    }
    Ok(archive.finish().map_err(|e| broken(&e))?.into_inner())
}

/// The interface of a model with settings as start values.
pub(super) fn with_settings(table: &Interface, settings: &Settings) -> Result<Interface> {
    let mut interface = table.clone();
    for (index, value) in settings.check(table)? {
        interface.variables[index].start = Some(value);
    }
    Ok(interface)
}

/// The description of a model as its FMU has it.
///
/// # Errors
/// Settings that the model does not accept.
pub fn description_of(table: &Interface, settings: &Settings) -> Result<String> {
    model_description(&with_settings(table, settings)?, &guid(table, &settings.to_file(table)?))
}

/// Loads a library and takes what its `latsch_models` tells.
fn describe(path: &Path) -> std::result::Result<Vec<u8>, String> {
    unsafe extern "C" fn collect(context: *mut c_void, start: *const u8, length: usize) {
        if context.is_null() || start.is_null() {
            return;
        }
        // SAFETY: the context is the vector passed below, the bytes live during the call.
        unsafe { (*context.cast::<Vec<u8>>()).extend_from_slice(std::slice::from_raw_parts(start, length)) };
    }

    let absolute = std::path::absolute(path).map_err(|e| e.to_string())?;
    let library = Handle::open(&absolute, Names::Usual).map_err(|e| e.to_string())?;
    let mut bytes = Vec::new();
    // SAFETY: the symbol has the type that export_fmus! gives it, and the library is open while it runs.
    let models: Option<unsafe extern "C" fn(Sink, *mut c_void)> =
        unsafe { library.function(c"latsch_models") };
    let models = models.ok_or("it was not made with export_fmus!")?;
    // SAFETY: the sink takes the vector that it is given.
    unsafe { models(collect, (&raw mut bytes).cast()) };
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use zip::ZipArchive;

    #[test]
    fn binaries_are_stored_and_texts_deflated() {
        let names = ["modelDescription.xml", "resources/model.toml", "binaries/linux64/unit.so"];
        let files = names.map(|name| (name.to_string(), vec![b'x'; 10_000])).into();
        let mut zip = ZipArchive::new(Cursor::new(pack(files).unwrap())).unwrap();
        let methods = names.map(|name| zip.by_name(name).unwrap().compression());
        let (stored, deflated) = (CompressionMethod::Stored, CompressionMethod::Deflated);
        assert_eq!(methods, [deflated, deflated, stored]);
    }
}
