//! Text from outside in what people read: messages, findings, pages.
//!
//! Names and texts of a file may hold anything: escape sequences that a terminal obeys, line breaks that forge further
//! messages, marks that turn the direction of writing, megabytes. [`Error`](crate::Error) and the command line pass what
//! they show through here, so that no place that builds a message has to think of it.

use std::borrow::Cow;
use std::fmt::{Display, Write};

/// Messages of more bytes than this are shortened: some 25 lines of a terminal, more than any message of our own.
const LONGEST: usize = 2000;
/// What is kept of a longer one at its end, where it says what to do. The rest is its beginning, which says where.
const END: usize = 600;
/// What stands for the part that was left out.
const LEFT_OUT: &str = " [... shortened ...] ";

/// True for characters that are not seen but do something: control characters, and those that join, split or turn text
/// (the default-ignorable ones of Unicode's general punctuation, and tags).
fn acts(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// The text with all characters that do something written as `\u{1b}`; line breaks and tabs stay.
pub fn printable(text: &str) -> Cow<'_, str> {
    let breaks = |c| matches!(c, '\n' | '\t');
    if !text.chars().any(|c| acts(c) && !breaks(c)) {
        return text.into();
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            c if breaks(c) || !acts(c) => shown.push(c),
            c => {
                let _ = write!(shown, "\\u{{{:x}}}", u32::from(c));
            }
        }
    }
    shown.into()
}

/// JSON with such characters escaped in its texts; it says the same. A serializer leaves those beyond ASCII as they are.
pub fn printable_json(json: &str) -> Cow<'_, str> {
    if !json.chars().any(|c| !c.is_ascii() && acts(c)) {
        return json.into();
    }
    let mut shown = String::with_capacity(json.len() + 16);
    for c in json.chars() {
        if c.is_ascii() || !acts(c) {
            shown.push(c);
            continue;
        }
        for unit in c.encode_utf16(&mut [0; 2]) {
            let _ = write!(shown, "\\u{unit:04x}");
        }
    }
    shown.into()
}

/// The character as one that is seen and as wide as another, for what has to stay in columns.
#[cfg(feature = "host")]
pub(crate) fn visible(c: char) -> char {
    match c {
        '\t' => ' ',
        c if acts(c) => '\u{fffd}',
        c => c,
    }
}

/// A number and its unit as people read them: the unit 1 is not said.
pub fn with_unit(number: impl Display, unit: &str) -> String {
    match unit {
        "1" => number.to_string(),
        unit => format!("{number} {unit}"),
    }
}

/// The text as one line of a message: shortened, and with nothing in it that does something.
pub fn one_line(text: &str) -> String {
    let text = shortened(text);
    let breaks = |c| matches!(c, '\n' | '\r' | '\t');
    match text.contains(breaks) {
        true => {
            let parts: Vec<&str> = text.split(breaks).filter(|part| !part.is_empty()).collect();
            printable(&parts.join(" ")).into_owned()
        }
        false => printable(&text).into_owned(),
    }
}

/// The text without its middle if it is too long to be read.
pub(crate) fn shortened(text: &str) -> Cow<'_, str> {
    if text.len() <= LONGEST {
        return text.into();
    }
    let mut head = LONGEST - END - LEFT_OUT.len();
    while !text.is_char_boundary(head) {
        head -= 1;
    }
    let mut tail = text.len() - END;
    while !text.is_char_boundary(tail) {
        tail += 1;
    }
    format!("{}{LEFT_OUT}{}", &text[..head], &text[tail..]).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_acts_is_left() {
        let text = "a\u{1b}[31m\u{9b}2J\u{202e}b\u{2066}\u{0}\r\n\tc\u{7f}\u{e0041}ä µ °";
        assert_eq!(one_line(text), "a\\u{1b}[31m\\u{9b}2J\\u{202e}b\\u{2066}\\u{0} c\\u{7f}\\u{e0041}ä µ °");
        assert_eq!(printable("two\nlines\tä"), "two\nlines\tä");
        assert_eq!(printable("\u{1b}]0;x\u{7}\n"), "\\u{1b}]0;x\\u{7}\n");
        assert!(!one_line(text).chars().any(acts));
    }

    #[test]
    fn json_says_the_same() {
        let value = serde_json::json!({ "a\u{9b}\u{202e}": "\u{1b}\u{e0041}ä\n" });
        let text = serde_json::to_string(&value).unwrap();
        let shown = printable_json(&text);
        assert!(!shown.chars().any(acts), "{shown}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&shown).unwrap(), value);
    }

    #[test]
    fn long_texts_keep_both_ends() {
        for filling in ["x", "ä", "\u{1f600}"] {
            let long = format!("file:3: {}; do this", filling.repeat(5_000_000));
            let shown = one_line(&long);
            assert!(shown.len() <= LONGEST, "{}", shown.len());
            assert!(shown.starts_with("file:3: ") && shown.ends_with("; do this"), "{shown}");
            assert_eq!(shown.matches("shortened").count(), 1);
            // a place in front shortens it again, and still says so once
            let again = one_line(&format!("{}: {shown}", "p".repeat(300)));
            assert!(again.len() <= LONGEST && again.matches("shortened").count() == 1, "{again}");
        }
        assert_eq!(one_line(&"x".repeat(LONGEST)).len(), LONGEST);
    }
}
