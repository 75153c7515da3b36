//! The numbers that decide an answer, each with its meaning and its reason. What bounds effort (counts, sizes of problems, iterations)
//! stands where it is used, and what makes a single detector of faults in the raw data in `hygiene`.

// ---- chance

/// Probability of chance below which a difference counts: of a gain, shared by all that were tried; between two candidates; of a
/// refit. The usual one.
pub const LEVEL: f64 = 0.05;
/// The same for what signals foretell of what is left, of which many are asked.
pub const FORETOLD_LEVEL: f64 = 0.01;
/// And for signals that are only said to be likely: a hint, without which nothing would be said of where to look.
pub const LIKELY_LEVEL: f64 = 0.2;
/// And for what several channels share, which is an answer whether or not anything explains it.
pub const SHARED_LEVEL: f64 = 1e-3;

// ---- the smallest that is worth a word, as shares of squared errors

/// A gain on the check runs or on the fit runs below this is not worth a name: half a percent of the error.
pub const MIN_GAIN: f64 = 0.01;
/// What signals foretell counts from here on: found among thousands of functions, it is less sure than a gain.
pub const MIN_FORETOLD: f64 = 0.03;
/// An effect has to take away this share of the error of some channel,
pub const MIN_OF_A_CHANNEL: f64 = 0.05;
/// and this share of what that channel moves: the square of what is little.
pub const MIN_OF_ITS_MOTION: f64 = LITTLE * LITTLE;
/// An error of less than this share of what a channel moves is no error: a thousandth, below which nobody looks; half of what the best
/// sensors err by, which are those of class 0.2.
pub const LITTLE: f64 = 1e-3;
/// Nor is one of less than this share of the size of a channel: the distance of numbers in single precision, with which recorders and other
/// programs store.
pub const RESOLUTION: f64 = f32::EPSILON as f64;
/// A large share, where a small one says little: of what is foretold without being sure; of the residual of a band that has to be
/// shared, of all that is left in that band; what a signal has to make of the most important one's part to be mentioned.
pub const MUCH: f64 = 0.3;

// ---- comparing names

/// A rest that a function without a name explains, as a share of what the names explain, above which the names are not enough:
/// such a function bends to whatever is there.
pub const LEFT_OVER: f64 = 0.2;
/// The same where a channel errs by more than its noise allows: names that explain most of it are then mostly those of other
/// physics that looks alike (in seed 10 of the blind study four of six). In the real recordings, where names are right and the rest is
/// many times the noise, it is at most 0.04.
pub const LEFT_OVER_FAR: f64 = 0.05;
/// A rival that misses less than this share of what the best one takes away from the check runs is as good: both are then the same
/// to whoever uses them, however surely one is the better.
pub const CLOSE: f64 = 0.03;
/// What keeping to plausible parameters may cost of what an effect explains: more, and the name needs what it does not allow.
pub const AT_LITTLE_COST: f64 = 0.1;
/// A squared error of a channel that is so many times larger with an effect than without refutes it.
pub const SPOILT: f64 = 1.5;

// ---- confidence

/// About how often a name without a rival was right in the blind study: 0.97 in seeds 6 to 10 (PROOF.md), and other machines
/// are not easier.
pub const OFTEN_RIGHT: f64 = 0.94;
/// An alternative that is more likely than this leaves it open which one it is: beside a single one that is less, the first is 2.7 times as
/// likely.
pub const OPEN: f64 = 0.25;
/// The best by all blocks may win in few of the resampled ones; it is not less likely than this.
pub const LEAST_SHARE: f64 = 0.05;

/// Beside something without a name that is many times the noise of a sensor, however many, names were right in 5 of 13 cases: in five
/// of six real recordings, whose sensors are precise (the diagnosis had been changed with them in view), and in none of seven cases of seeds 6 and 8 of the random machines in which
/// what is missing is in no catalogue. They are less sure by at most this.
pub const BESIDE: f64 = 0.38;
/// Names beside something without one are what is said first if they take away this share of the squared error of the check runs:
/// the better half.
pub const MOSTLY: f64 = 0.5;

// ---- what is noise

/// What is known of the noise is too little by up to this factor, if it is coloured; and what repeats of a run do not share is less
/// than the noise by as much at most, because filters of a recorder and lines between samples err alike in all of them.
pub const NOISE_MARGIN: f64 = 1.4;
/// An error of so many times the noise is no noise, even if nothing can be said of it: of models that lack
/// nothing the largest ratio of seeds 4 to 10 of the blind study was 1.37.
pub const FAR: f64 = 1.45;
/// The same for one channel of one run, whose noise is known less well: of models that lack nothing the largest ratio was
/// 1.40 in 36 cases of the blind study.
pub const FAR_ALONE: f64 = 1.7;
/// And of so many times it nothing is explained, whatever the names have taken away: what was named right left 2.5
/// times at most in seed 6 of the study, 3.2 times in real recordings.
pub const TOO_FAR: f64 = 10.0;
/// Two effects that leave less than so many times the noise leave nothing for a third one: of what is less than half the
/// noise nothing is left to find.
pub const NO_MORE: f64 = 1.1;

// ---- what is known beforehand

/// The standard deviation of a parameter, as a share of its nominal value: what is off by more is worth a word.
pub const PRIOR: f64 = 0.3;
/// What a sensor may show at zero, as a share of what its channel spans in all runs: bridges and amplifiers drift by up to 1 % of
/// what they are made for from one balancing to the next, and recordings use a part of that. More is a finding.
pub const ZERO: f64 = 0.02;
/// And what shows above the rest of the errors by so many standard deviations is a finding, too: whoever looks at the sensor sees it.
pub const VISIBLE_ZERO: f64 = 3.0;
/// A lag of all channels up to this share of the sampling interval is the recorder's filter, no finding.
pub const RECORDER_LAG: f64 = 0.3;
/// No input is known better than to this share of itself in a run: what the best calibrations promise, and more than the last
/// digit of most files.
pub const PRECISION: f64 = 1e-4;
