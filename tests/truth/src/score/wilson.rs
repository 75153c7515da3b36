//! Intervals of shares.

/// Successes of a number of trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Share {
    /// How often it was so.
    pub hits: usize,
    /// Of how many.
    pub of: usize,
}

impl Share {
    /// Counts the trials that are so.
    pub fn of(trials: impl IntoIterator<Item = bool>) -> Self {
        trials
            .into_iter()
            .fold(Self::default(), |s, hit| Self { hits: s.hits + usize::from(hit), of: s.of + 1 })
    }

    /// The share in percent; none of nothing.
    #[must_use]
    #[allow(clippy::cast_precision_loss)] // hundreds
    pub fn percent(self) -> Option<f64> {
        (self.of > 0).then(|| 100.0 * self.hits as f64 / self.of as f64)
    }

    /// The 95 % interval of Wilson (1927) in percent.
    #[must_use]
    #[allow(clippy::cast_precision_loss)] // hundreds
    pub fn interval(self) -> Option<(f64, f64)> {
        if self.of == 0 {
            return None;
        }
        const Z: f64 = 1.959_963_984_540_054;
        let (n, p) = (self.of as f64, self.hits as f64 / self.of as f64);
        let middle = p + Z * Z / (2.0 * n);
        let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        let scale = 100.0 / (1.0 + Z * Z / n);
        Some((((middle - half) * scale).max(0.0), ((middle + half) * scale).min(100.0)))
    }

    /// `54 of 60`, `90 %`, `80 to 95 %`, as cells of a table.
    #[must_use]
    pub fn cells(self) -> String {
        let percent = self.percent().map_or("-".into(), |p| format!("{p:.0} %"));
        let interval = self.interval().map_or("-".into(), |(low, high)| format!("{low:.0} to {high:.0} %"));
        format!("{percent} | {} of {} | {interval}", self.hits, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_the_published_examples() {
        // Newcombe (1998), table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29
        for (hits, of, low, high) in
            [(81, 263, 25.53, 36.62), (15, 148, 6.24, 16.05), (0, 20, 0.0, 16.11), (1, 29, 0.61, 17.18)]
        {
            let (l, h) = Share { hits, of }.interval().unwrap();
            assert!((l - low).abs() < 0.006 && (h - high).abs() < 0.006, "{l} {h}");
        }
        assert_eq!(Share::default().interval(), None);
        assert_eq!(Share::of([true, false, true]).cells(), "67 % | 2 of 3 | 21 to 94 %");
    }
}
