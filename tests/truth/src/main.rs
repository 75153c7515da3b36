//! `latsch-truth`: cases with concealed effects, their sealed answers, and the score.

use clap::Parser;
use latsch_truth::machines::{self, View};
use latsch_truth::study::{name, study};
use latsch_truth::{car, files, score, sessions, solid};
use std::path::PathBuf;
use std::process::ExitCode;

/// Recordings with concealed effects, sealed answers, and their score
#[derive(Parser)]
enum Command {
    /// Write the recordings of a case, without a word about what is in them
    Case {
        /// Number of the case, from 1
        number: usize,
        /// Folder of the case
        #[arg(long)]
        output: PathBuf,
        /// How a machine is told: larger, smaller, slower, faster, turned, renamed, reordered, beside, doubled, spoilt
        #[arg(long, default_value = "same", requires = "machines", conflicts_with_all = ["sessions", "solid", "car"])]
        view: View,
        #[command(flatten)]
        seed: Seed,
        #[command(flatten)]
        of: Of,
    },
    /// Write the answers of cases; only the scorer may see them, and only when all diagnoses are there
    Answers {
        /// Numbers of the cases, from 1 [default: all]
        numbers: Vec<usize>,
        /// Folder of the answers
        #[arg(long)]
        output: PathBuf,
        #[command(flatten)]
        seed: Seed,
        #[command(flatten)]
        of: Of,
    },
    /// Write what a rig records of a tire along the measurement programme of an identification
    Rig {
        /// Number of the tire
        number: u64,
        /// Folder that `latsch rig-program` wrote
        #[arg(long)]
        programme: PathBuf,
        /// Folder of the recordings, with the truth beside them
        #[arg(long)]
        output: PathBuf,
        #[command(flatten)]
        seed: Seed,
    },
    /// Say how many cases there are
    Count {
        #[command(flatten)]
        seed: Seed,
        #[command(flatten)]
        of: Of,
    },
    /// List every case with its kind: this breaks the seal, it is for those who build the study
    Reveal {
        #[command(flatten)]
        seed: Seed,
    },
    /// Hold diagnoses (RESULTS/CASE/diagnosis.json) against answers and print the table
    Score {
        /// Folder of the answers
        answers: PathBuf,
        /// Folder of the results
        results: PathBuf,
    },
}

#[derive(clap::Args)]
struct Seed {
    /// Seed of the study
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(clap::Args)]
struct Of {
    /// The study of random machines in place of the one of the base models
    #[arg(long, conflicts_with = "sessions")]
    machines: bool,
    /// The study of sessions on a flat track, with a tire of its own
    #[arg(long)]
    sessions: bool,
    /// The study of a solid rubber tire under a cylinder and on a drum, with a tire of its own
    #[arg(long, conflicts_with_all = ["machines", "sessions"])]
    solid: bool,
    /// The study of a car that brakes, wired to four brakes and a controller, with a car of its own
    #[arg(long, conflicts_with_all = ["machines", "sessions", "solid"])]
    car: bool,
}

impl Of {
    fn count(&self, seed: u64) -> usize {
        match self {
            Self { machines: true, .. } => machines::count(),
            Self { sessions: true, .. } => sessions::count(),
            Self { solid: true, .. } => solid::count(),
            Self { car: true, .. } => car::count(),
            _ => study(seed).len(),
        }
    }
}

fn main() -> ExitCode {
    match run(&Command::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("latsch-truth: {message}");
            ExitCode::FAILURE
        }
    }
}

fn index(number: usize) -> Result<usize, String> {
    number.checked_sub(1).ok_or_else(|| "cases are numbered from 1".to_owned())
}

fn run(command: &Command) -> Result<(), String> {
    match command {
        Command::Case { number, output, view, seed, of } => {
            let number = index(*number)?;
            match of {
                Of { machines: true, .. } => machines::write_case(seed.seed, number, *view, output),
                Of { sessions: true, .. } => sessions::case(seed.seed, number)?.write_case(output),
                Of { solid: true, .. } => solid::case(seed.seed, number)?.write_case(output),
                Of { car: true, .. } => car::case(seed.seed, number)?.write_case(output),
                _ => files::case(seed.seed, number)?.write_case(output),
            }
        }
        Command::Answers { numbers, output, seed, of } => {
            let record = |number| match of {
                Of { machines: true, .. } => machines::recorded(seed.seed, number),
                Of { sessions: true, .. } => sessions::case(seed.seed, number),
                Of { solid: true, .. } => solid::case(seed.seed, number),
                Of { car: true, .. } => car::case(seed.seed, number),
                _ => files::case(seed.seed, number),
            };
            let all: Vec<usize> = (1..=of.count(seed.seed)).collect();
            for number in if numbers.is_empty() { &all } else { numbers } {
                record(index(*number)?)?.write_answer(output)?;
            }
            Ok(())
        }
        Command::Rig { number, programme, output, seed } => {
            files::write_session(seed.seed, *number, programme, output)
        }
        Command::Count { seed, of } => {
            println!("{}", of.count(seed.seed));
            Ok(())
        }
        Command::Reveal { seed } => {
            for (number, kind) in study(seed.seed).iter().enumerate() {
                println!("{} {kind:?}", name(number));
            }
            Ok(())
        }
        Command::Score { answers, results } => {
            print!("{}", score::report(&score::judge_all(answers, results)?));
            Ok(())
        }
    }
}
