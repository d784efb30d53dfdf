//! Columns that hold a clock as dates, times of day, or seconds since 1970.

use super::stamp::{self, DAY, Day, SECOND, Stamp};
use recording::DateOrder;
use std::cell::Cell;

/// How the cells of a column become times since the first row.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Clock {
    /// Dates with times of day, or times of day alone.
    Stamps(Stamps),
    /// Counts since 1970, too large for a double to hold with their fraction.
    Epoch {
        /// Whole counts of the first row.
        base: i128,
        unit: &'static str,
    },
}

/// A column of stamps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stamps {
    first: Stamp,
    /// As the numbers of the first rows leave it.
    order: Option<DateOrder>,
    /// Nanoseconds of the last row since the first one's midnight, and whole days that a time of day has passed.
    last: Cell<(i64, i64)>,
}

/// Why a stamp has no time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrong {
    /// It is no stamp.
    NoStamp,
    /// The date changes, and day and month could be exchanged.
    OpenOrder,
}

/// Ranges of counts since 1970 from 2001 to 2100, with their unit.
const EPOCHS: [(f64, &str); 4] = [(1.0, "s"), (1e3, "ms"), (1e6, "us"), (1e9, "ns")];

/// The clock that cells hold, if they hold one that is no plain number.
pub(super) fn clock<'c>(mut cells: impl Iterator<Item = &'c str> + Clone) -> Option<Clock> {
    let all = cells.clone();
    let first = cells.next()?;
    if let Some(stamp) = stamp::parse(first).filter(|stamp| stamp.ns.is_some()) {
        // A damaged cell among many is an error of its row, not another column.
        let are = |cell| stamp::parse(cell).is_some_and(|stamp| stamp.ns.is_some());
        let (stamps, count) =
            all.fold((0, 0), |(n, of), cell| (n + usize::from(are(cell)), of + 1));
        if 2 * stamps <= count {
            return None;
        }
        let order = cells
            .chain([first])
            .find_map(|cell| stamp::parse(cell)?.day.only_order());
        return Some(Clock::Stamps(Stamps::new(stamp, order)));
    }
    let base = whole(first)?;
    let unit = EPOCHS
        .iter()
        .find(|(scale, _)| (1e9 * scale..4.1e9 * scale).contains(&(base as f64)))?;
    let counts: Option<Vec<i128>> = all.map(whole).collect();
    let rises = counts.is_some_and(|counts| counts.windows(2).all(|pair| pair[1] >= pair[0]));
    rises.then_some(Clock::Epoch { base, unit: unit.1 })
}

/// The whole part of a number, written with point or comma.
fn whole(cell: &str) -> Option<i128> {
    let digits = cell.split(['.', ',']).next()?;
    digits
        .parse()
        .ok()
        .filter(|_| cell.len() < 40 && !cell.contains(['e', 'E']))
}

/// Counts since a base: whole counts are subtracted before the fraction is added.
pub(super) fn since(base: i128, cell: &str) -> Option<f64> {
    let (digits, fraction) = cell.split_once(['.', ',']).unwrap_or((cell, "0"));
    let fraction: f64 = format!("0.{fraction}").parse().ok()?;
    Some((digits.parse::<i128>().ok()? - base) as f64 + fraction)
}

impl Stamps {
    fn new(first: Stamp, order: Option<DateOrder>) -> Stamps {
        Stamps {
            last: Cell::new((first.ns.unwrap_or(0), 0)),
            first,
            order,
        }
    }

    /// Whether the stamps are times of day without a date.
    pub fn is_time_of_day(&self) -> bool {
        self.first.day == Day::None
    }

    /// Takes the order of day and month that the user says.
    pub fn ordered(&mut self, order: DateOrder) {
        self.order = Some(order);
    }

    /// Seconds since the first row.
    ///
    /// # Errors
    /// A cell that is no stamp; a date whose order is open and matters.
    pub fn seconds(&self, cell: &str) -> Result<f64, Wrong> {
        let stamp = stamp::parse(cell).ok_or(Wrong::NoStamp)?;
        let ns = stamp.ns.ok_or(Wrong::NoStamp)?;
        let days = match stamp.day {
            Day::None => return Ok(self.past_midnight(ns)),
            day if day == self.first.day => 0,
            day => {
                let known = matches!((day, self.first.day), (Day::Known(_), Day::Known(_)));
                let order = self
                    .order
                    .or(known.then_some(DateOrder::DayFirst))
                    .ok_or(Wrong::OpenOrder)?;
                let number = |day: Day| day.julian(order).ok_or(Wrong::NoStamp);
                number(day)? - number(self.first.day)?
            }
        };
        Ok(self.since_first(days.saturating_mul(DAY).saturating_add(ns)))
    }

    fn since_first(&self, ns: i64) -> f64 {
        (ns - self.first.ns.unwrap_or(0)) as f64 / SECOND as f64
    }

    /// A time of day that falls by more than half a day has passed midnight.
    fn past_midnight(&self, ns: i64) -> f64 {
        let (last, mut days) = self.last.get();
        if ns < last - DAY / 2 {
            days += 1;
        }
        self.last.set((ns, days));
        self.since_first(days.saturating_mul(DAY).saturating_add(ns))
    }
}

impl Clock {
    /// What is to be said when the column is the clock.
    pub fn remark(&self, name: &str) -> String {
        match self {
            Clock::Stamps(stamps) if stamps.is_time_of_day() => {
                format!("t counts from the first time of day in {name}")
            }
            Clock::Stamps(_) => format!("t counts from the first date in {name}"),
            Clock::Epoch { unit, .. } => {
                format!("{name} counts {unit} since 1970; t counts from the first row")
            }
        }
    }

    /// Unit of the times that come out.
    pub fn unit(&self) -> &'static str {
        match self {
            Clock::Stamps(_) => "s",
            Clock::Epoch { unit, .. } => unit,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(cells: &[&str]) -> Stamps {
        match clock(cells.iter().copied()) {
            Some(Clock::Stamps(stamps)) => stamps,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn times_count_from_the_first_row_and_pass_midnight() {
        let of_day = stamps(&["23:59:59.9", "23:59:59.95"]);
        assert!((of_day.seconds("23:59:59.95").unwrap() - 0.05).abs() < 1e-12);
        assert!((of_day.seconds("00:00:00.1").unwrap() - 0.2).abs() < 1e-12);
        let dated = stamps(&["31.12.2023 23:59:59,5"]);
        assert!((dated.seconds("01.01.2024 00:00:00,5").unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn an_open_order_matters_only_when_the_date_changes() {
        let mut open = stamps(&["03/04/2024 23:59:59", "03/04/2024 23:59:59.5"]);
        assert_eq!(open.seconds("03/04/2024 23:59:59.5"), Ok(0.5));
        assert_eq!(open.seconds("04/04/2024 00:00:01"), Err(Wrong::OpenOrder));
        open.ordered(DateOrder::DayFirst);
        assert_eq!(open.seconds("04/04/2024 00:00:01"), Ok(2.0));
    }

    #[test]
    fn nanoseconds_since_1970_keep_their_last_digit() {
        let cells = ["1700000000000000001", "1700000000000100001"];
        let Some(Clock::Epoch { base, unit }) = clock(cells.into_iter()) else {
            panic!()
        };
        assert_eq!((unit, since(base, cells[1])), ("ns", Some(100_000.0)));
        assert_eq!(since(1_700_000_000, "1700000000.0002"), Some(0.0002));
        assert_eq!(clock(["1.5", "2.5"].into_iter()), None);
        assert_eq!(clock(["1700000000", "1600000000"].into_iter()), None);
    }
}
