//! `drivemon board events`: what happened, from the board's flash.

use board::modbus::Field;
use board::{Event, EventCause, LOG_EVENTS};
use clap::Args;
use live::Registers;
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use super::line::LineArgs;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::JsonArgs;
use crate::cli::printing::terminal::say;
use crate::cli::printing::{paint, progress};

/// List what happened to motor and board, oldest first: starts, crashes, lamps, doubts, learning.
///
/// The board keeps 448 to 512 events in flash, whatever was switched off since. It has no clock: times count from its start.
/// A cause is written once a minute at most, with the number of times that it happened since.
#[derive(Debug, Args)]
pub struct Events {
    #[command(flatten)]
    line: LineArgs,
    /// How many of the newest events
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=i64::from(LOG_EVENTS)))]
    last: u32,
    #[command(flatten)]
    json: JsonArgs,
}

/// The board's log.
#[derive(Debug, Serialize, JsonSchema)]
pub struct EventsJson {
    /// The oldest first.
    events: Vec<Told>,
}

impl Answer for EventsJson {
    const FORMAT: &'static str = "board-events/1";
}

/// An event.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "BoardEvent")]
struct Told {
    /// Counts every event since the board was made.
    number: u32,
    /// Time since the board's start, s.
    uptime_s: u32,
    /// What happened.
    cause: &'static str,
    /// How often in a row.
    times: u16,
    /// What belongs to the cause, as the log holds it.
    values: [u32; 2],
    /// The same in words.
    text: String,
}

impl Events {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let mut line = self.line.open()?;
        let newest = Registers::read(&mut line)?.long(Field::LastEvent);
        let count = self.last.min(newest);
        let bar = progress::bar("events", u64::from(count));
        let read = line.events(newest - count + 1, newest, |more| bar.inc(more));
        bar.finish_and_clear();
        let told = EventsJson {
            events: read?.iter().map(tell).collect(),
        };
        self.json.give(&told, || print(&told.events))?;
        Ok(Finding::Nothing)
    }
}

fn tell(event: &Event) -> Told {
    Told {
        number: event.number,
        uptime_s: event.uptime_s,
        cause: event.cause.label(),
        times: event.times,
        values: event.values,
        text: event.to_string(),
    }
}

fn print(told: &[Told]) {
    if told.is_empty() {
        say!("No event yet.");
        return;
    }
    let header = format!("{:>5} {:>13}  what", "#", "since start");
    say!("{}", paint::strong(header));
    for event in told {
        let Told { number, text, .. } = event;
        let line = format!("{number:5} {:>13}  {text}", clock(event.uptime_s));
        if event.cause == EventCause::Start.label() {
            say!("{}", paint::strong(line));
        } else {
            say!("{line}");
        }
    }
}

/// Hours, minutes and seconds; days before them where there are any.
fn clock(seconds: u32) -> String {
    let (minutes, s) = (seconds / 60, seconds % 60);
    let (hours, min) = (minutes / 60, minutes % 60);
    match (hours / 24, hours % 24) {
        (0, h) => format!("{h}:{min:02}:{s:02}"),
        (days, h) => format!("{days}d {h}:{min:02}:{s:02}"),
    }
}

#[cfg(test)]
mod tests {
    use super::clock;

    #[test]
    fn times_read_as_on_a_clock() {
        assert_eq!(clock(0), "0:00:00");
        assert_eq!(clock(3_661), "1:01:01");
        assert_eq!(clock(86_399), "23:59:59");
        assert_eq!(clock(400 * 86_400 + 62), "400d 0:01:02");
    }
}
