//! A look at a library's headers before the system loads it. The loader maps what the headers say; where the file is
//! shorter than that, touching the memory kills the process (SIGBUS), which no error can report afterwards.
//!
//! Layout: System V ABI, "Object Files" and "Program Loading".

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

const CLASS: u8 = if cfg!(target_pointer_width = "64") { 2 } else { 1 };
/// EM_X86_64, EM_386, EM_AARCH64; elsewhere the loader judges.
const MACHINE: Option<u16> = if cfg!(target_arch = "x86_64") {
    Some(62)
} else if cfg!(target_arch = "x86") {
    Some(3)
} else if cfg!(target_arch = "aarch64") {
    Some(183)
} else {
    None
};
/// ET_DYN: a library.
const LIBRARY: u16 = 3;
/// PT_LOAD: a piece that is mapped.
const MAPPED: u32 = 1;
/// PT_DYNAMIC: what the loader reads first.
const DYNAMIC: u32 = 2;
/// DT_STRTAB and DT_SYMTAB: names and addresses of the functions.
const NAMES: u64 = 5;
const SYMBOLS: u64 = 6;
/// Bytes of an address.
const WORD: usize = size_of::<usize>();
/// Tables of headers are counted by 16 bits, and none of their entries has more than 64 bytes: no longer than this.
const MOST: u64 = 4 << 20;
/// SHT_NOBITS: a section without bytes in the file.
const WITHOUT_BYTES: u32 = 8;

/// Lengths of a file's header and of one entry of its tables.
struct Layout {
    header: usize,
    segment: usize,
    section: usize,
}

const LAYOUT: Layout = match CLASS {
    2 => Layout { header: 64, segment: 56, section: 64 },
    _ => Layout { header: 52, segment: 32, section: 40 },
};

/// Bytes of a header.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    /// A number of `size` bytes, little-endian; 0 beyond the end, which the callers' lengths exclude.
    fn number(&self, at: usize, size: usize) -> u64 {
        let bytes = self.0.get(at..at + size).unwrap_or_default();
        bytes.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte))
    }

    /// A number that is as long as an address.
    fn wide(&self, at64: usize, at32: usize) -> u64 {
        match CLASS {
            2 => self.number(at64, 8),
            _ => self.number(at32, 4),
        }
    }
}

/// Fails unless the file is a library for this machine, with all pieces that its headers name.
///
/// # Errors
/// What is wrong: a sentence without the file's name.
pub(in crate::fmi) fn check(path: &Path) -> Result<(), String> {
    let unreadable = |e: std::io::Error| format!("it cannot be read: {e}");
    let about = std::fs::metadata(path).map_err(unreadable)?;
    if !about.is_file() {
        return Err("it is no ordinary file".into());
    }
    let length = about.len();
    let mut file = File::open(path).map_err(unreadable)?;
    let cut = |what: &str, end: u64| {
        Err(format!(
            "it has {length} bytes, but its headers name {what} up to byte {end}: it was cut off or is damaged; make or download the FMU again"
        ))
    };
    if length < LAYOUT.header as u64 {
        return Err(format!("it has {length} bytes, too few for a library"));
    }
    let mut bytes = vec![0; LAYOUT.header];
    file.read_exact(&mut bytes).map_err(unreadable)?;
    if !bytes.starts_with(b"\x7fELF") {
        return Err("it is no library of this system (ELF)".into());
    }
    let header = Fields(&bytes);
    let (class, order) = (header.number(4, 1), header.number(5, 1));
    let machine = header.number(18, 2);
    if class != u64::from(CLASS) || order != 1 || MACHINE.is_some_and(|m| u64::from(m) != machine) {
        return Err(format!(
            "it is for another machine (ELF class {class}, byte order {order}, machine {machine}); here class {CLASS}, byte order 1, machine {} is needed",
            MACHINE.map_or("any".into(), |m| m.to_string())
        ));
    }
    let kind = header.number(16, 2);
    if kind != u64::from(LIBRARY) {
        return Err(format!("it is no library (ELF type {kind}, 3 is needed)"));
    }
    let mut piece = |at: u64, size: u64, what: &str| {
        let end = at.saturating_add(size);
        if end > length {
            return cut(what, end).map(|()| Vec::new());
        }
        if size > MOST {
            return Err(format!("its headers are damaged: {what} of {size} bytes"));
        }
        let mut bytes = vec![0; size as usize];
        file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(&mut bytes)).map_err(unreadable)?;
        Ok(bytes)
    };
    let mut table = |at: u64, size: u64, count: u64, needed: usize, what: &str| {
        if count > 0 && size != needed as u64 {
            return Err(format!("its headers are damaged: {what} of {size} bytes, {needed} are needed"));
        }
        piece(at, size * count, what)
    };

    let sizes = if CLASS == 2 { 54 } else { 42 };
    let count = |at: usize| (header.number(sizes + at, 2), header.number(sizes + at + 2, 2));
    let (size, number) = count(0);
    let segments = table(header.wide(32, 28), size, number, LAYOUT.segment, "program headers")?;
    // not needed for loading, but they lie at the end and show what was cut off
    let (size, number) = count(4);
    let sections = match header.wide(40, 32) {
        0 => Vec::new(),
        start => table(start, size, number, LAYOUT.section, "section headers")?,
    };
    let mut loaded = Vec::new();
    let mut dynamic = None;
    for segment in segments.chunks_exact(LAYOUT.segment).map(Fields) {
        let (start, bytes) = (segment.wide(8, 4), segment.wide(32, 16));
        let end = start.saturating_add(bytes);
        if bytes > 0 && end > length {
            return cut("a piece", end);
        }
        match segment.number(0, 4) as u32 {
            MAPPED if bytes > segment.wide(40, 20) => {
                return Err(
                    "its headers are damaged: a piece has more bytes in the file than in memory".into()
                );
            }
            MAPPED => loaded.push((segment.wide(16, 8), bytes)),
            DYNAMIC => dynamic = Some((start, bytes)),
            _ => {}
        }
    }
    for section in sections.chunks_exact(LAYOUT.section).map(Fields) {
        let kind = section.number(4, 4);
        let end = section.wide(24, 16).saturating_add(section.wide(32, 20));
        if kind != 0 && kind != u64::from(WITHOUT_BYTES) && end > length {
            return cut("a section", end);
        }
    }
    // where the names of the functions are: a file of the right length whose end was never written has none
    let Some((start, bytes)) = dynamic else {
        return Err("it has no dynamic section, so it is no library".into());
    };
    let dynamic = piece(start, bytes, "the dynamic section")?;
    for needed in [NAMES, SYMBOLS] {
        let found = dynamic.chunks_exact(2 * WORD).map(Fields).find(|entry| entry.number(0, WORD) == needed);
        let address = found.map_or(0, |entry| entry.number(WORD, WORD));
        if !loaded.iter().any(|(first, bytes)| address >= *first && address - first < *bytes && address > 0) {
            return Err(
                "its dynamic section is damaged: it does not say where the functions' names are".into()
            );
        }
    }
    Ok(())
}
