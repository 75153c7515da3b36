//! The blocks of an MDF file: each has a name, links to others, and data.

use quick_xml::XmlVersion;

/// What is read, or what is wrong with the file.
pub type Read<T> = Result<T, String>;

/// Before the links of a block: its name, its length and how many links it has.
const HEAD: usize = 24;

/// One block.
#[derive(Clone, Copy)]
pub struct Block<'a> {
    /// Two letters.
    pub name: [u8; 2],
    links: &'a [u8],
    /// What is behind the links.
    pub data: Fields<'a>,
}

/// Bytes in which numbers stand at fixed places, little-endian.
#[derive(Clone, Copy)]
pub struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    fn bytes<const N: usize>(&self, at: usize) -> Read<[u8; N]> {
        let bytes = at.checked_add(N).and_then(|end| self.0.get(at..end));
        let bytes = bytes.and_then(|bytes| bytes.try_into().ok());
        bytes.ok_or_else(|| format!("a block of {} bytes is too short", self.0.len()))
    }

    pub fn u8(&self, at: usize) -> Read<u8> {
        self.bytes(at).map(u8::from_le_bytes)
    }

    pub fn u16(&self, at: usize) -> Read<u16> {
        self.bytes(at).map(u16::from_le_bytes)
    }

    pub fn u32(&self, at: usize) -> Read<u32> {
        self.bytes(at).map(u32::from_le_bytes)
    }

    pub fn u64(&self, at: usize) -> Read<u64> {
        self.bytes(at).map(u64::from_le_bytes)
    }

    pub fn f64(&self, at: usize) -> Read<f64> {
        self.bytes(at).map(f64::from_le_bytes)
    }

    pub fn from(&self, at: usize) -> Read<&'a [u8]> {
        self.0.get(at..).ok_or_else(|| format!("a block of {} bytes is too short", self.0.len()))
    }
}

impl Block<'_> {
    /// Where link `k` leads to, if anywhere.
    pub fn link(&self, k: usize) -> Option<u64> {
        let link = Fields(self.links).u64(8 * k).ok()?;
        (link != 0).then_some(link)
    }

    /// How many links there are.
    pub fn links(&self) -> usize {
        self.links.len() / 8
    }
}

/// A file.
#[derive(Clone, Copy)]
pub struct Blocks<'a>(pub &'a [u8]);

impl<'a> Blocks<'a> {
    /// The block at a place, whatever it is.
    ///
    /// # Errors
    /// No block is there, or the file ends within it.
    pub fn any(&self, at: u64) -> Read<Block<'a>> {
        let wrong = |what: &str| format!("at byte {at}: {what}");
        let rest = usize::try_from(at).ok().and_then(|at| self.0.get(at..));
        let rest = rest.ok_or_else(|| wrong("the file ends before a block that it speaks of"))?;
        let head = Fields(rest);
        let [b'#', b'#', a, b] = head.bytes(0).map_err(|_| wrong("the file ends within a block"))? else {
            return Err(wrong("no block is where one should be"));
        };
        let (length, links) = (head.u64(8)?, head.u64(16)?);
        let behind = links.checked_mul(8).and_then(|links| links.checked_add(HEAD as u64));
        let (Some(behind), true) = (behind, length <= rest.len() as u64) else {
            return Err(wrong("the file ends within a block"));
        };
        if behind > length {
            return Err(wrong("a block is shorter than its links"));
        }
        // both are within the file
        let (behind, length) = (behind as usize, length as usize);
        Ok(Block { name: [a, b], links: &rest[HEAD..behind], data: Fields(&rest[behind..length]) })
    }

    /// The block at a place, which has to be one of that name.
    ///
    /// # Errors
    /// As [`Blocks::any`]; another block.
    pub fn block(&self, at: u64, name: &str) -> Read<Block<'a>> {
        let block = self.any(at)?;
        if block.name == name.as_bytes() {
            return Ok(block);
        }
        Err(format!(
            "at byte {at}: a block {} is where {name} should be",
            String::from_utf8_lossy(&block.name)
        ))
    }

    /// The blocks that follow one another by their first link.
    ///
    /// # Errors
    /// As [`Blocks::block`]; more of them than the file has room for, which means that they go round.
    pub fn chain(&self, first: Option<u64>, name: &str) -> Read<Vec<Block<'a>>> {
        let mut chain = Vec::new();
        let mut next = first;
        while let Some(at) = next {
            let block = self.block(at, name)?;
            if chain.len() > self.0.len() / HEAD {
                return Err(format!("blocks {name} follow one another in a ring"));
            }
            next = block.link(0);
            chain.push(block);
        }
        Ok(chain)
    }

    /// The text that a link leads to: as it is, or the element `TX` of a comment in XML. Nothing where there is none.
    ///
    /// # Errors
    /// As [`Blocks::any`].
    pub fn text(&self, link: Option<u64>) -> Read<String> {
        let Some(at) = link else { return Ok(String::new()) };
        let block = self.any(at)?;
        let bytes = block.data.0.split(|byte| *byte == 0).next().unwrap_or_default();
        let text = String::from_utf8_lossy(bytes);
        Ok(match &block.name {
            b"MD" => comment(&text),
            _ => text.into_owned(),
        }
        .trim()
        .to_owned())
    }
}

/// The first element `TX` of a comment.
fn comment(xml: &str) -> String {
    use quick_xml::events::Event;
    let mut reader = quick_xml::Reader::from_str(xml);
    let (mut text, mut is_within) = (String::new(), false);
    loop {
        match reader.read_event() {
            Ok(Event::Start(element)) if element.local_name().as_ref() == "TX" => is_within = true,
            Ok(Event::Text(piece)) if is_within => text += &piece.xml_content(XmlVersion::Implicit1_0),
            Ok(Event::GeneralRef(name)) if is_within => {
                let name = name.to_string();
                text += quick_xml::escape::resolve_predefined_entity(&name).unwrap_or_default();
            }
            Ok(Event::End(_)) if is_within => return text,
            Ok(Event::Eof) | Err(_) => return text,
            Ok(_) => {}
        }
    }
}
