//! Statistics: means, quantiles, lines, spectra, resampling, probabilities of chance, random numbers.
//!
//! Each is written once, here. Where two definitions of one thing are in use their names say how they differ:
//! [`mean`] and [`mean_or_zero`], [`quantile`] and [`quantile_below`].

#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
mod blocks;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub(crate) mod chance;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
mod interpolate;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
mod lines;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
mod moments;
// roads are made of random numbers in FMUs, too
mod random;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
mod robust;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
mod spectrum;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(feature = "host")]
#[allow(clippy::disallowed_methods)] // host only
pub(crate) mod welch;

#[cfg(feature = "host")]
pub use blocks::{bootstrap_shares, product, redundancy, sign_flip};
#[cfg(feature = "host")]
pub(crate) use interpolate::within;
#[cfg(feature = "host")]
pub use interpolate::{interpolate, median_interval, slope};
#[cfg(feature = "host")]
pub use lines::{Line, about_line, even_line};
#[cfg(feature = "host")]
pub use moments::{about_mean, correlation, deviation, mean, mean_or_zero, root_mean_square};
pub use random::SplitMix64;
#[cfg(feature = "host")]
pub use robust::{amplitude, extent, median, noise, quantile, quantile_below, spread};
#[cfg(feature = "host")]
pub use spectrum::{Spectrum, over_angle, over_time, spectrum};
