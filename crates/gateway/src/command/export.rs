//! `drivemon fleet export`.

use std::path::PathBuf;

use clap::Args;
use fleet::Reader;
use live::Fetched;
use motor::MotorFile;
use time::{Date, Month};

use super::error::CommandError;
use super::terminal::Terminal;
use super::users::OfPlant;

/// Milliseconds of a day.
const DAY_MS: i64 = 86_400_000;

/// A day of seconds, or the recording of an alarm, as a file.
#[derive(Debug, Args)]
pub(super) struct Export {
    #[command(flatten)]
    of: OfPlant,
    /// The day in UTC, as 2026-11-25
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = day, required_unless_present = "alarm")]
    day: Option<Date>,
    /// The alarm whose recording is written; its motor needs `motor_file` in the configuration
    #[arg(long, value_name = "NUMBER", conflicts_with = "day")]
    alarm: Option<u64>,
    /// The file to write: .parquet of a day; .csv, .csv.gz or .parquet of a recording
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
        let reader = Reader::open(&self.of.store()?)?;
        let told = match (self.day, self.alarm) {
            (Some(day), _) => self.seconds(&reader, day)?,
            (None, Some(alarm)) => self.recording(&reader, alarm)?,
            // The arguments leave nothing else.
            (None, None) => return Ok(()),
        };
        (terminal.complain)(&format!("{}: {told}", self.output.display()));
        Ok(())
    }

    fn seconds(&self, reader: &Reader, day: Date) -> Result<String, CommandError> {
        let from_ms = 1_000 * day.midnight().assume_utc().unix_timestamp();
        let count = reader.export_seconds(from_ms, from_ms + DAY_MS, &self.output)?;
        Ok(format!("{count} seconds of {day}"))
    }

    fn recording(&self, reader: &Reader, alarm: u64) -> Result<String, CommandError> {
        let kept = reader.recording_of_alarm(alarm)?;
        let motor = MotorFile::read(&kept.motor_file)?;
        let fetched = Fetched::of_file(kept.constants, &kept.instants)?;
        let recording = live::recording(&fetched, &motor)?;
        formats::write_recording(&self.output, &recording)?;
        let (name, rows) = (kept.name, recording.t().len());
        let file = kept.motor_file.display();
        Ok(format!(
            "{rows} samples of recording {name}, alarm {alarm}; its motor is {file}"
        ))
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
