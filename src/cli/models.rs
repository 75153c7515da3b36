//! `latsch models`: what is shipped.

use super::{Format, print, print_json};
use latsch::Result;
use latsch::shipped::MODELS;
use serde_json::json;

/// List the models that are shipped
#[derive(clap::Args)]
pub struct Args {
    /// How to print
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
}

pub fn run(args: &Args) -> Result<()> {
    let tables = MODELS.iter().map(|m| (m.table)());
    if args.format == Format::Json {
        let list: Vec<_> = tables.map(|t| json!({"name": t.name, "description": t.description})).collect();
        return print_json(&json!(list));
    }
    for table in tables {
        print(&format!("{}\n    {}", table.name, table.description))?;
    }
    print("\n`latsch describe MODEL` lists a model's variables.")
}
