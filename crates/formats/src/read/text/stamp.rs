//! Dates and times of day as instruments print them.

use recording::DateOrder;
use time::{Date, Month};

/// When a row was taken, as its cell says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    pub day: Day,
    /// Since midnight, ns, in universal time where the stamp names its zone; `None` of a date alone.
    pub ns: Option<i64>,
}

/// The date of a stamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Day {
    /// None: a time of day.
    None,
    /// The Julian day.
    Known(i64),
    /// `3/4/2024`: day and month in either order.
    Open { first: u8, second: u8, year: i32 },
}

/// One second, ns.
pub(super) const SECOND: i64 = 1_000_000_000;
/// One day, ns.
pub(super) const DAY: i64 = 86_400 * SECOND;

impl Day {
    /// The Julian day, with the order of an open date; `None` where there is no such day.
    pub fn julian(self, order: DateOrder) -> Option<i64> {
        match (self, order) {
            (Day::None, _) => Some(0),
            (Day::Known(day), _) => Some(day),
            (
                Day::Open {
                    first,
                    second,
                    year,
                },
                DateOrder::DayFirst,
            ) => julian(year, second, first),
            (
                Day::Open {
                    first,
                    second,
                    year,
                },
                DateOrder::MonthFirst,
            ) => julian(year, first, second),
        }
    }

    /// The order that the numbers of an open date leave.
    pub fn only_order(self) -> Option<DateOrder> {
        match self {
            Day::Open { first: 13.., .. } => Some(DateOrder::DayFirst),
            Day::Open { second: 13.., .. } => Some(DateOrder::MonthFirst),
            _ => None,
        }
    }
}

fn julian(year: i32, month: u8, day: u8) -> Option<i64> {
    let month = Month::try_from(month).ok()?;
    let date = Date::from_calendar_date(year, month, day).ok()?;
    Some(i64::from(date.to_julian_day()))
}

/// Reads a date, a time of day, or both.
pub(super) fn parse(text: &str) -> Option<Stamp> {
    let text = text.trim();
    if !text.is_ascii() && !text.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let Some(colon) = text.find(':') else {
        let day = date(text)?;
        return Some(Stamp { day, ns: None });
    };
    let hour = text[..colon]
        .trim_end_matches(|c: char| c.is_ascii_digit())
        .len();
    let before = text[..hour].trim_end_matches([' ', 'T', 't', ',', ';', '/', '-', '_']);
    let day = match before {
        "" => Day::None,
        text => date(text)?,
    };
    let (ns, zone) = time_of_day(&text[hour..])?;
    Some(Stamp {
        day,
        ns: Some(ns - zone),
    })
}

fn date(text: &str) -> Option<Day> {
    let mark = text.chars().find(|c| matches!(c, '.' | '/' | '-' | ' '))?;
    let mut parts = text.split(mark).map(str::trim);
    let (first, second, third) = (parts.next()?, parts.next()?, parts.next()?);
    if parts.next().is_some() {
        return None;
    }
    if first.len() == 4 {
        return julian(number(first)?, small(second)?, small(third)?).map(Day::Known);
    }
    let year = match (third.len(), number(third)?) {
        (2, year) => 2000 + year,
        (4, year) => year,
        _ => return None,
    };
    if let Some(month) = month(second) {
        return julian(year, month, small(first)?).map(Day::Known);
    }
    let (first, second) = (small(first)?, small(second)?);
    match mark {
        '.' => julian(year, second, first).map(Day::Known),
        _ if first == second => julian(year, first, second).map(Day::Known),
        _ => {
            let open = Day::Open {
                first,
                second,
                year,
            };
            let orders = [DateOrder::DayFirst, DateOrder::MonthFirst];
            orders
                .iter()
                .any(|order| open.julian(*order).is_some())
                .then_some(open)
        }
    }
}

fn number(digits: &str) -> Option<i32> {
    let plain = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    digits.parse().ok().filter(|_| plain)
}

fn small(digits: &str) -> Option<u8> {
    number(digits)
        .and_then(|x| u8::try_from(x).ok())
        .filter(|_| digits.len() <= 2)
}

/// Names of months, English and German, by their first letters.
fn month(name: &str) -> Option<u8> {
    const NAMES: [&str; 12] = [
        "jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec",
    ];
    const GERMAN: [(&str, u8); 4] = [("m\u{e4}r", 3), ("mai", 5), ("okt", 10), ("dez", 12)];
    let short: String = name.to_lowercase().chars().take(3).collect();
    if name.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let english = NAMES.iter().zip(1..).find(|(name, _)| **name == short);
    english.map(|(_, month)| month).or_else(|| {
        GERMAN
            .iter()
            .find(|(name, _)| *name == short)
            .map(|(_, month)| *month)
    })
}

/// Nanoseconds since midnight, and the zone's distance from universal time in ns.
fn time_of_day(text: &str) -> Option<(i64, i64)> {
    let end = text.find(|c: char| !(c.is_ascii_digit() || ":.,".contains(c)));
    let (clock, rest) = text.split_at(end.unwrap_or(text.len()));
    let mut parts = clock.splitn(3, ':');
    let hours = i64::from(small(parts.next()?)?);
    let minutes = i64::from(small(parts.next()?)?);
    let (whole, fraction) = match parts.next() {
        Some(seconds) => seconds.split_once(['.', ',', ':']).unwrap_or((seconds, "")),
        None => ("0", ""),
    };
    let seconds = i64::from(small(whole)?);
    let (hours, rest) = half_day(hours, rest.trim())?;
    if hours > 24 || minutes > 59 || seconds > 60 {
        return None;
    }
    let whole = (hours * 60 + minutes) * 60 + seconds;
    Some((whole * SECOND + nano(fraction)?, zone(rest)?))
}

/// A fraction of a second in ns: nine digits, what follows is dropped.
fn nano(fraction: &str) -> Option<i64> {
    if !fraction.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let nine: String = fraction
        .chars()
        .chain("000000000".chars())
        .take(9)
        .collect();
    nine.parse().ok()
}

/// The hour of a day of 24, and what follows AM or PM.
fn half_day(hours: i64, rest: &str) -> Option<(i64, &str)> {
    let half = rest.get(..2).map(str::to_ascii_lowercase);
    let noon = match half.as_deref() {
        Some("am") => 0,
        Some("pm") => 12,
        _ => return Some((hours, rest)),
    };
    (1..=12)
        .contains(&hours)
        .then(|| (hours % 12 + noon, rest[2..].trim()))
}

fn zone(text: &str) -> Option<i64> {
    let text = text
        .trim_start_matches("UTC")
        .trim_start_matches("GMT")
        .trim_start_matches('Z');
    if text.is_empty() {
        return Some(0);
    }
    let sign = match text.as_bytes()[0] {
        b'+' => 1,
        b'-' => -1,
        _ => return None,
    };
    let digits: String = text[1..].chars().filter(|c| *c != ':').collect();
    let (hours, minutes) = (digits.get(..2)?, digits.get(2..).unwrap_or(""));
    let minutes = if minutes.is_empty() { "0" } else { minutes };
    let seconds = 3600 * i64::from(small(hours)?) + 60 * i64::from(small(minutes)?);
    Some(sign * seconds * SECOND)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> (i64, f64) {
        let stamp = parse(text).unwrap_or_else(|| panic!("{text}"));
        let order = stamp.day.only_order().unwrap_or(DateOrder::MonthFirst);
        let day = stamp.day.julian(order).unwrap();
        (day, stamp.ns.unwrap() as f64 / 1e9)
    }

    #[test]
    fn one_instant_in_many_ways_of_writing() {
        let day = julian(2024, 3, 31).unwrap();
        for text in [
            "2024-03-31T14:05:06.25",
            "2024-03-31 14:05:06.25Z",
            "2024-03-31T16:05:06.250000+02:00",
            "31.03.2024 14:05:06,250",
            "31.3.24 14:05:06.25",
            "3/31/2024 2:05:06.250 PM",
            "31-Mar-2024 14:05:06.25",
            "2024/03/31 14:05:06:250",
            "31/03/2024 14:05:06.25",
        ] {
            assert_eq!(at(text), (day, 50_706.25), "{text}");
        }
        assert_eq!(at("12:00:00 am"), (0, 0.0));
        assert_eq!(at("23:59"), (0, 86_340.0));
    }

    #[test]
    fn an_order_that_is_open_stays_open() {
        let open = parse("3/4/2024 10:00:00").unwrap().day;
        assert_eq!(open.only_order(), None);
        assert_ne!(
            open.julian(DateOrder::DayFirst),
            open.julian(DateOrder::MonthFirst)
        );
    }

    #[test]
    fn what_is_no_stamp() {
        for text in [
            "",
            "1.5",
            "12",
            "a:b",
            "1:2:3:4:5",
            "25:00:00 x",
            "2024-13-01",
            "31/31/2024",
            "12:61:00",
            "Time (s)",
            "CH1: 0.05",
            "::",
            "13:00 pm",
            "2024-03-01T",
        ] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
