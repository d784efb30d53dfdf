//! `drivemon fleet export`.

use std::path::PathBuf;

use clap::Args;
use fleet::Reader;
use time::{Date, Month};

use super::error::CommandError;
use super::terminal::Terminal;
use super::users::OfPlant;

/// Milliseconds of a day.
const DAY_MS: i64 = 86_400_000;

/// A day of seconds as a file.
#[derive(Debug, Args)]
pub(super) struct Export {
    #[command(flatten)]
    of: OfPlant,
    /// The day in UTC, as 2026-11-25
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = day)]
    day: Date,
    /// The Parquet file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

fn day(text: &str) -> Result<Date, String> {
    let numbers: Vec<&str> = text.split('-').collect();
    let date = match numbers[..] {
        [year, month, day] => of_numbers(year, month, day),
        _ => None,
    };
    date.ok_or_else(|| format!("\"{text}\" is no day: write one as 2026-11-25"))
}

fn of_numbers(year: &str, month: &str, day: &str) -> Option<Date> {
    let month = Month::try_from(month.parse::<u8>().ok()?).ok()?;
    Date::from_calendar_date(year.parse().ok()?, month, day.parse().ok()?).ok()
}

impl Export {
    /// Runs the command.
    pub fn run(&self, terminal: Terminal) -> Result<(), CommandError> {
        let from_ms = 1_000 * self.day.midnight().assume_utc().unix_timestamp();
        let reader = Reader::open(&self.of.store()?)?;
        let count = reader.export_seconds(from_ms, from_ms + DAY_MS, &self.output)?;
        let (day, file) = (self.day, self.output.display());
        (terminal.complain)(&format!("{file}: {count} seconds of {day}"));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_is_a_day_of_the_calendar() {
        let told = |text| day(text).map(|day| day.midnight().assume_utc().unix_timestamp());
        // `date -ud 2026-11-25 +%s`
        assert_eq!(told("2026-11-25"), Ok(1_795_564_800));
        for wrong in [
            "2026-02-30",
            "2026-13-01",
            "25.11.2026",
            "2026-11",
            "2026-11-25-1",
            "",
        ] {
            assert!(told(wrong).is_err(), "{wrong}");
        }
    }
}
