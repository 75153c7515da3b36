//! Texts for constants that depend on a type.

/// Texts one behind the other, at most `N` bytes: [`Model::NAME`](super::Model::NAME) of a model that is generic.
///
/// ```
/// # use latsch::model::{Joined, join};
/// trait Part { const NAME: &'static str; }
/// struct Machine<P>(P);
/// impl<P: Part> Machine<P> {
///     const NAME: &'static str = const { &join::<32>(&[P::NAME, "-machine"]) }.as_str();
/// }
/// struct Pump;
/// impl Part for Pump { const NAME: &'static str = "pump"; }
/// assert_eq!(Machine::<Pump>::NAME, "pump-machine");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Joined<const N: usize> {
    bytes: [u8; N],
    length: usize,
}

/// Joins texts. Where they are longer than `N` bytes, the program does not compile.
pub const fn join<const N: usize>(parts: &[&str]) -> Joined<N> {
    let (mut bytes, mut length, mut part) = ([0; N], 0, 0);
    while part < parts.len() {
        let (text, mut i) = (parts[part].as_bytes(), 0);
        while i < text.len() {
            bytes[length] = text[i];
            length += 1;
            i += 1;
        }
        part += 1;
    }
    Joined { bytes, length }
}

impl<const N: usize> Joined<N> {
    /// The text.
    pub const fn as_str(&'static self) -> &'static str {
        match std::str::from_utf8(self.bytes.split_at(self.length).0) {
            Ok(text) => text,
            // texts one behind the other are a text
            Err(_) => "",
        }
    }
}
