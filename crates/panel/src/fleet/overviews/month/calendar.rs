//! A month of the calendar.

use std::fmt;
use std::str::FromStr;

use time::{Date, Month as Name, OffsetDateTime};

/// A month, of UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CalendarMonth {
    year: i32,
    month: Name,
}

/// It is no month.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is no month: write one as 2026-10")]
pub struct NoMonth(String);

impl FromStr for CalendarMonth {
    type Err = NoMonth;

    fn from_str(text: &str) -> Result<Self, NoMonth> {
        let parts = text.split_once('-').filter(|(year, month)| {
            let digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
            year.len() == 4 && month.len() == 2 && digits(year) && digits(month)
        });
        let of = |(year, month): (&str, &str)| {
            let month = Name::try_from(month.parse::<u8>().ok()?).ok()?;
            let year = year.parse::<i32>().ok().filter(|year| *year >= 1970)?;
            Some(CalendarMonth { year, month })
        };
        parts.and_then(of).ok_or_else(|| NoMonth(text.to_owned()))
    }
}

impl fmt::Display for CalendarMonth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}", self.year, u8::from(self.month))
    }
}

impl CalendarMonth {
    /// Its begin, Unix ms.
    pub fn from_ms(self) -> i64 {
        begin_ms(self.year, self.month)
    }

    /// Its end, Unix ms.
    pub fn to_ms(self) -> i64 {
        match self.month {
            Name::December => begin_ms(self.year + 1, Name::January),
            month => begin_ms(self.year, month.next()),
        }
    }
}

fn begin_ms(year: i32, month: Name) -> i64 {
    // Years have four digits here, which every calendar has room for.
    let first = Date::from_calendar_date(year.min(9999), month, 1);
    first.map_or(0, |day| {
        1_000 * day.midnight().assume_utc().unix_timestamp()
    })
}

fn instant(ms: i64) -> OffsetDateTime {
    // Beyond the calendar there is no alarm.
    OffsetDateTime::from_unix_timestamp(ms.div_euclid(1_000)).unwrap_or(OffsetDateTime::UNIX_EPOCH)
}

/// A day in UTC, as 2026-10-05.
pub(in crate::fleet) fn day(ms: i64) -> String {
    let date = instant(ms).date();
    let month = u8::from(date.month());
    format!("{:04}-{month:02}-{:02}", date.year(), date.day())
}

/// A minute in UTC, as 2026-10-05 14:03.
pub(super) fn minute(ms: i64) -> String {
    let time = instant(ms).time();
    format!("{} {:02}:{:02}", day(ms), time.hour(), time.minute())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_month_begins_and_ends_with_the_calendar() {
        let month: CalendarMonth = "2026-12".parse().expect("a month");
        // `date -ud 2026-12-01 +%s`, `date -ud 2027-01-01 +%s`
        assert_eq!(month.from_ms(), 1_796_083_200_000);
        assert_eq!(month.to_ms(), 1_798_761_600_000);
        assert_eq!(month.to_string(), "2026-12");
    }

    #[test]
    fn times_are_told_in_utc() {
        // `date -ud @1795564861`
        assert_eq!(minute(1_795_564_861_500), "2026-11-25 00:01");
    }

    #[test]
    fn what_is_no_month_is_refused() {
        for wrong in [
            "2026-13",
            "2026-00",
            "2026-1",
            "26-10",
            "2026",
            "10.2026",
            "",
            "1969-01",
            "２026-10",
        ] {
            assert!(wrong.parse::<CalendarMonth>().is_err(), "{wrong}");
        }
    }
}
