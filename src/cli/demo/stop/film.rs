//! The moving picture of a contact patch: frames in few characters, and the scales of all.

use latsch::report::{PULLING, PatchFrame, Picture, SLIDING, pressure_color};
use latsch::tire::Cell;
use serde_json::{Value, json};

/// Width of a picture beside which there is another.
const WIDTH: f64 = 560.0;
/// A number from 0 to 63 is one of these characters.
const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
/// The largest of two digits.
const PAIR: f64 = 4095.0;
/// Steps of pressure: two codes each, for sticking and sliding, after that for no contact and those of
/// negative pressure.
const LEVELS: f64 = 29.0;
const FIRST_LEVEL: u8 = 3;

/// What the pictures of a page have in common.
pub struct Film {
    picture: Picture,
    /// Centres of the stripes across the patch \[m\].
    stripes: Vec<f64>,
    cell: [f64; 2],
}

impl Film {
    /// The scales for these frames; `patches` are the names of several in each frame with their places \[m\].
    pub fn new(frames: &[&PatchFrame], patches: Vec<(String, [f64; 2])>) -> Self {
        let mut stripes: Vec<f64> = frames.iter().flat_map(|f| &f.cells).map(|c| c.y).collect();
        stripes.sort_by(f64::total_cmp);
        stripes.dedup();
        let first = frames.iter().flat_map(|f| &f.cells).next().copied().unwrap_or_default();
        Self { picture: Picture::new(frames, WIDTH, patches), stripes, cell: [first.length, first.width] }
    }

    /// A frame as a picture whose cells the script replaces.
    pub fn drawing(&self, frame: &PatchFrame) -> String {
        self.picture.drawing(frame)
    }

    /// What the marks mean.
    pub fn explanation(&self) -> String {
        self.picture.explanation()
    }

    /// What the script needs to draw frames.
    pub fn scales(&self) -> Value {
        let p = &self.picture;
        let colors: Vec<String> =
            (0..=LEVELS as u32).map(|i| pressure_color(f64::from(i) / LEVELS)).collect();
        json!({
            "digits": String::from_utf8_lossy(DIGITS),
            "firstLevel": FIRST_LEVEL,
            "half": p.half[0],
            "scale": p.scale,
            "origin": p.place(0.0, 0.0),
            "arrow": p.arrow,
            "cell": self.cell,
            "stripes": self.stripes,
            "colors": colors,
            "pulling": PULLING,
            "sliding": SLIDING,
        })
    }

    /// A frame as text: for every x in contact two characters for the place, then for every stripe one for
    /// contact, sliding and pressure and, in contact, two for the deflection.
    pub fn encode(&self, frame: &PatchFrame) -> String {
        let mut places: Vec<f64> = frame.cells.iter().map(|c| c.x).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let mut text = String::new();
        for x in places {
            let share = 0.5 + 0.5 * x / self.picture.half[0];
            let place = (share * PAIR).round().clamp(0.0, PAIR) as u16;
            text.push(digit((place / 64) as u8));
            text.push(digit((place % 64) as u8));
            for y in &self.stripes {
                match frame.cells.iter().find(|c| c.x == x && c.y == *y) {
                    None => text.push(digit(0)),
                    Some(cell) => self.push(cell, &mut text),
                }
            }
        }
        text
    }

    fn push(&self, cell: &Cell, text: &mut String) {
        let level = (cell.pressure / self.picture.pressure * LEVELS).round().clamp(0.0, LEVELS) as u8;
        let slides = u8::from(cell.sliding);
        text.push(digit(if cell.pressure < 0.0 { 1 + slides } else { FIRST_LEVEL + 2 * level + slides }));
        for deflection in cell.deflection {
            // in the middle of the 63 used: exactly none
            let step = (31.0 * deflection / self.picture.deflection).round().clamp(-31.0, 31.0);
            text.push(digit((31.0 + step) as u8));
        }
    }
}

fn digit(value: u8) -> char {
    char::from(DIGITS[usize::from(value.min(63))])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_has_all_its_cells() {
        let cell = |x, y, pressure, sliding, deflection| Cell {
            x,
            y,
            length: 0.02,
            width: 0.04,
            pressure,
            sliding,
            deflection,
        };
        let frame = PatchFrame {
            cells: vec![
                cell(-0.05, -0.1, 2e5, false, [1e-3, 0.0]),
                cell(0.05, -0.1, 4e5, true, [-1e-3, 0.0]),
                cell(0.05, 0.1, -1e4, true, [0.0, -1e-3]),
            ],
            ..PatchFrame::default()
        };
        let film = Film::new(&[&frame], Vec::new());
        let values: Vec<usize> =
            film.encode(&frame).bytes().map(|b| DIGITS.iter().position(|d| *d == b).unwrap()).collect();
        let half = 0.06 * 1.04;
        let place = |hi: usize, lo: usize| ((64 * hi + lo) as f64 / 4095.0 * 2.0 - 1.0) * half;
        assert!((place(values[0], values[1]) + 0.05).abs() < 2e-5);
        // half of the largest pressure, sticking, the longest arrow forward; no second stripe
        assert!((14..=15).contains(&((values[2] - 3) / 2)) && (values[2] - 3).is_multiple_of(2));
        assert_eq!(values[3..6], [62, 31, 0]);
        assert!((place(values[6], values[7]) - 0.05).abs() < 2e-5);
        // the largest pressure, sliding, backward; then negative and sliding, to the right
        assert_eq!(values[8..], [3 + 2 * 29 + 1, 0, 31, 2, 31, 0]);
    }
}
