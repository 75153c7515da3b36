//! What the named effects leave that is no noise of sensors.

use super::locate;
use super::negligible::{negligible, resolution};
use super::numbers::{
    BESIDE, FAR, FAR_ALONE, FORETOLD_LEVEL, LEFT_OVER, LEFT_OVER_FAR, LIKELY_LEVEL, MIN_FORETOLD, MUCH,
    NOISE_MARGIN, OFTEN_RIGHT, TOO_FAR,
};
use super::precision::within_precision;
use super::rest::Rest;
use super::result::Finding;
use super::roles::Roles;
use super::study::{Fitted, Study};
use super::subject::Subject;
use super::wander::wandering;
use crate::fit::Run;

/// What the named effects leave that is no noise of sensors.
pub(super) struct Left {
    /// What several channels share.
    common: Option<locate::Common>,
    /// What can be foretold in one channel, the most important one.
    structure: Option<locate::Structure>,
    /// The channel whose error is the most times its noise, and how many, if they are too many.
    far: Option<(usize, f64)>,
    /// What repeats of a run do not share in that channel over its error, if any run is repeated.
    scatter: Option<f64>,
    /// The channel and the run to fit whose error is the most times its noise, and how many, if nothing else is left.
    unchecked: Option<(usize, usize, f64)>,
    /// The signals that it depends on.
    depends_on: Vec<String>,
    /// Weighted squared error of the check runs that is foretold, or shared, or far above the noise where
    /// something is.
    error: f64,
}

impl Left {
    /// Looks at what a model leaves of the fit runs and the check runs, and if there is anything, at what it leaves if inputs are no
    /// more precise than they can be.
    pub(super) fn of(
        study: &Study<'_>,
        subject: &Subject,
        roles: &Roles,
        current: &Fitted,
        (fit, check): (&Rest, &Rest),
    ) -> Self {
        let left = Self::in_rests(study, subject, roles, current, (fit, check));
        let precise = |runs: &[&Run], rest: &Rest| within_precision(study, &current.model, runs, rest).ok();
        if left.counts(0.0)
            && let Some(fit) = precise(&study.fit_runs, fit)
            && let Some(check) = precise(&study.check_runs, check)
        {
            return Self::in_rests(study, subject, roles, current, (&fit, &check));
        }
        left
    }

    fn in_rests(
        study: &Study<'_>,
        subject: &Subject,
        roles: &Roles,
        current: &Fitted,
        (fit, check): (&Rest, &Rest),
    ) -> Self {
        let runs = &study.check_runs;
        let (fit_told, check_told) = (study.telling(&study.fit_runs, fit), study.telling(runs, check));
        let before = locate::Seen { runs: &study.fit_runs, simulated: &fit_told };
        let then = locate::Seen { runs, simulated: &check_told };
        let samples: usize = runs.iter().map(|r| r.time.len()).sum();
        // as they are, resolved or not
        let squared = |c: usize| samples as f64 * (study.error(check, c) * study.weights[c]).powi(2);
        let errors: Vec<f64> = (0..study.weights.len()).map(squared).collect();
        // a part of an error is no more than the whole
        let resolved = |c: usize| samples as f64 * (resolution(runs, c) * study.weights[c]).powi(2);
        let mut foretold = 0.0;
        let mut structure = None;
        let mut most = 0.0;
        let wandering = wandering(study, current, (fit, check));
        let structures = locate::structure(before, then, &wandering, &subject.interface, roles);
        for s in structures.iter().cloned() {
            let part = s.share * errors[s.channel];
            if s.p < FORETOLD_LEVEL && s.share > MIN_FORETOLD && part > resolved(s.channel) {
                foretold += part;
                if part > most {
                    (most, structure) = (part, Some(s));
                }
            }
        }
        // sensors have noise of their own: what their residuals share has a cause in the machine
        let all: Vec<&Run> = study.fit_runs.iter().chain(runs).copied().collect();
        let simulated = [&fit_told[..], &check_told[..]].concat();
        let pair = |common: &locate::Common| -> Vec<usize> {
            let channels = study.check_runs.first().map_or(&[][..], |r| &r.channels[..]);
            let pair = common.channels.iter().take(2);
            pair.filter_map(|v| channels.iter().position(|c| c.variable == *v)).collect()
        };
        let is_resolved = |common: &locate::Common| {
            pair(common).into_iter().all(|c| common.share * errors[c] > resolved(c))
        };
        let common = locate::common_cause(&all, &simulated).filter(is_resolved);
        let shared = common
            .as_ref()
            .map_or(0.0, |common| common.share * pair(common).into_iter().map(|c| errors[c]).sum::<f64>());
        let noise = study.noise(fit, check);
        let squared_noise: Vec<f64> = (noise.iter().enumerate())
            .map(|(c, noise)| {
                let alone = noise.alone.unwrap_or(f64::INFINITY);
                let most = alone.min(noise.scatter.map_or(f64::INFINITY, |s| NOISE_MARGIN * s));
                samples as f64 * (most.max(negligible(runs, c)) * study.weights[c]).powi(2)
            })
            .collect();
        // what is said is how many times the noise that is reported
        let times = |c: usize| Some((c, study.error(check, c) / noise[c].least()?.max(negligible(runs, c))));
        let far = (0..study.weights.len())
            .filter(|c| errors[*c] > FAR.powi(2) * squared_noise[*c])
            .filter_map(times)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let scatter = far.and_then(|(c, _)| Some(noise[c].scatter? / study.error(check, c)));
        let beyond: f64 = if common.is_some() || structure.is_some() || far.is_some() {
            let beyond = |(e, n): (&f64, &f64)| (e - NOISE_MARGIN.powi(2) * n).max(0.0);
            errors.iter().zip(&squared_noise).map(beyond).sum()
        } else {
            0.0
        };
        let nothing = common.is_none() && structure.is_none() && far.is_none();
        let unchecked = if nothing { unchecked(study, fit) } else { None };
        // what would foretell much in one of these channels, if less surely, says more than where the error is large
        let concerns = |channel: usize| {
            let variable = runs.first().and_then(|r| r.channels.get(channel)).map(|c| c.variable);
            far.is_some_and(|(c, _)| c == channel)
                || common
                    .as_ref()
                    .is_some_and(|common| variable.is_some_and(|v| common.channels.contains(&v)))
        };
        let likely = structures.iter().find(|s| concerns(s.channel) && s.p < LIKELY_LEVEL && s.share > MUCH);
        let depends_on = match (&structure, &common, far) {
            (Some(s), ..) => s.depends_on.clone(),
            (None, None, None) if unchecked.is_none() => Vec::new(),
            (None, None, None) => locate::depends_on(&study.fit_runs, &fit_told, &subject.interface, roles),
            _ => match likely {
                Some(s) => s.depends_on.clone(),
                None => locate::depends_on(runs, &check_told, &subject.interface, roles),
            },
        };
        Self {
            common,
            structure,
            far,
            scatter,
            unchecked,
            depends_on,
            error: foretold.max(shared).max(beyond),
        }
    }

    /// Whether it is worth a word beside effects that have taken away `explained`.
    pub(super) fn counts(&self, explained: f64) -> bool {
        if self.far.is_some_and(|(_, ratio)| ratio > TOO_FAR) {
            true
        } else if explained > 0.0 {
            let least = if self.far.is_some() { LEFT_OVER_FAR } else { LEFT_OVER };
            self.error > least * (explained + self.error)
        } else {
            self.common.is_some()
                || self.structure.is_some()
                || self.far.is_some()
                || self.unchecked.is_some()
        }
    }

    /// How much less sure effects are that have taken away `explained` and leave this: the share that they are of all
    /// that there was to explain, and the noise over what they leave where that is too much, down to [`BESIDE`].
    pub(super) fn doubt(&self, explained: f64) -> f64 {
        let all = (explained.max(0.0) + self.error).max(f64::MIN_POSITIVE);
        let share = if self.counts(explained) { explained.max(0.0) / all } else { 1.0 };
        share.min(self.far.map_or(1.0, |(_, ratio)| (1.0 / ratio).max(BESIDE)))
    }

    /// The signals that an empirical function should have had, if that is known.
    pub(super) fn depends_on(&self) -> Option<Vec<String>> {
        self.structure.as_ref().map(|s| s.depends_on.clone())
    }

    /// What repeats of a run say of the error that is too large.
    fn repeats(&self) -> &'static str {
        match self.scatter {
            None => "",
            Some(scatter) if scatter * NOISE_MARGIN > 1.0 => {
                " Repeats of a run differ as much: it is made by what was not recorded, or goes on from run to run."
            }
            Some(_) => {
                " It comes again in repeats of a run: the inputs make it, or the time since the start."
            }
        }
    }

    /// Something that is missing and that nothing explains.
    pub(super) fn finding(&self, subject: &Subject, study: &Study<'_>) -> Finding {
        let name_of = |v: usize| subject.interface.variables[v].name.clone();
        let (name, channels, evidence) = match (&self.common, &self.structure, self.unchecked) {
            (Some(common), ..) => (
                "Something in the machine that several channels share",
                common.channels.iter().map(|v| name_of(*v)).collect::<Vec<_>>(),
                format!(
                    "{:.0} % of what is left in these channels between {:.3} and {:.3} Hz is coherent, which noise of separate sensors is not; chance does so with a probability of {:.1e}.",
                    100.0 * common.share,
                    common.band.0,
                    common.band.1,
                    common.p
                ),
            ),
            (None, Some(s), _) => (
                "Something that other signals foretell",
                study.check_runs.first().iter().map(|r| name_of(r.channels[s.channel].variable)).collect(),
                format!(
                    "Functions of {}{} that were found in the fit runs foretell {:.0} % of the squared error of the check runs; chance does so with a probability of {:.1e}.",
                    s.depends_on.join(", "),
                    s.through
                        .as_ref()
                        .map_or(String::new(), |p| format!(", by which {p} would have to change,")),
                    100.0 * s.share,
                    s.p
                ),
            ),
            (None, None, Some((channel, run, ratio))) => {
                let run = &study.fit_runs[run];
                let name = name_of(run.channels[channel].variable);
                let evidence = format!(
                    "The error of {name} in {} is {ratio:.1} times its noise, and no run for checking shows such an error: what explains it in the runs to fit cannot be checked. Record it twice, or have `runs.toml` say that it is for checking.",
                    run.name
                );
                ("Something that only runs to fit show", vec![name], evidence)
            }
            (None, None, None) => {
                let (channel, ratio) = self.far.unwrap_or_default();
                let channel = study.check_runs.first().and_then(|r| r.channels.get(channel));
                (
                    "Something that no signal foretells",
                    channel.iter().map(|c| name_of(c.variable)).collect(),
                    format!("The error of the check runs is {ratio:.1} times the noise.{}", self.repeats()),
                )
            }
        };
        Finding {
            effect: "unknown".into(),
            name: name.into(),
            family: "unknown".into(),
            place: format!("output{} {}", if channels.len() == 1 { "" } else { "s" }, channels.join(", ")),
            channels,
            depends_on: self.depends_on.clone(),
            confidence: OFTEN_RIGHT,
            evidence,
            ..Finding::default()
        }
    }
}

/// The channel of a run to fit whose error is the most times its noise, if that is too many.
fn unchecked(study: &Study<'_>, fit: &Rest) -> Option<(usize, usize, f64)> {
    let mut worst: Option<(usize, usize, f64)> = None;
    for (r, (run, simulated)) in study.fit_runs.iter().zip(&fit.simulated).enumerate() {
        for (c, (channel, trace)) in run.channels.iter().zip(simulated).enumerate() {
            let square: f64 = channel.values.iter().zip(trace).map(|(m, s)| (m - s).powi(2)).sum();
            let error = (square / run.time.len().max(1) as f64).sqrt();
            let Some(noise) = locate::noise(&[run], std::slice::from_ref(simulated), c) else { continue };
            let ratio = error / noise.max(negligible(&study.fit_runs, c));
            if ratio > worst.map_or(FAR_ALONE, |(.., most)| most) {
                worst = Some((c, r, ratio));
            }
        }
    }
    worst
}
