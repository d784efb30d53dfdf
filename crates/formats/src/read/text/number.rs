//! Numbers as recorders of all countries write them.

/// How the numbers of a file are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Numbers {
    /// Whether the decimal mark is a comma.
    pub decimal_comma: bool,
    /// Separator of groups of three digits; a blank means any kind of blank.
    pub thousands: Option<char>,
}

/// The thousands separators that are known.
pub(super) const THOUSANDS: [char; 4] = ['.', ',', '\'', ' '];

impl Numbers {
    /// The number that a cell holds, if it is written this way.
    pub fn parse(self, text: &str) -> Option<f64> {
        if self == Numbers::default() {
            return text.parse().ok();
        }
        if self.decimal_comma && could_be_thousands(text, '.') && self.thousands != Some('.') {
            return None;
        }
        let point = if self.decimal_comma { ',' } else { '.' };
        let (mantissa, exponent) = text.split_at(text.find(['e', 'E']).unwrap_or(text.len()));
        let (whole, fraction) = mantissa.split_once(point).unwrap_or((mantissa, ""));
        let whole = match self.thousands {
            Some(mark) => ungrouped(whole, mark)?,
            None => whole.to_owned(),
        };
        let mark = if fraction.is_empty() { "" } else { "." };
        format!("{whole}{mark}{fraction}{exponent}").parse().ok()
    }
}

/// Digits that a mantissa may have for it and its power of ten to be doubles without rounding.
const MOST_DIGITS: usize = 15;

/// Powers of ten that are doubles without rounding, as far as a mantissa has digits.
const TENS: [f64; MOST_DIGITS + 1] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
];

/// The number of a cell such as `-12.345`, a point as its mark, no more than fifteen digits, no exponent; `None` for every
/// other cell, whatever it holds. Both parts of the quotient are exact, so that it is rounded once, as the number itself
/// would be (Clinger, How to read floating point numbers accurately, 1990).
pub(super) fn plain(cell: &[u8]) -> Option<f64> {
    let (is_negative, digits) = match cell {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, cell),
    };
    if digits.is_empty() || digits.len() > MOST_DIGITS + 1 {
        return None;
    }
    let (mut mantissa, mut point) = (0_u64, None);
    for (k, byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => mantissa = 10 * mantissa + u64::from(byte - b'0'),
            b'.' if point.is_none() => point = Some(k),
            _ => return None,
        }
    }
    let count = digits.len() - usize::from(point.is_some());
    let behind = point.map_or(0, |at| digits.len() - 1 - at);
    if count == 0 || count > MOST_DIGITS {
        return None;
    }
    let x = mantissa as f64 / TENS[behind];
    Some(if is_negative { -x } else { x })
}

fn is_blank(c: char) -> bool {
    matches!(c, ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}')
}

fn is_mark(c: char, mark: char) -> bool {
    match mark {
        ' ' => is_blank(c),
        '\'' => matches!(c, '\'' | '\u{2019}'),
        mark => c == mark,
    }
}

/// The digits without the marks between their groups; `None` where a group has not three digits.
fn ungrouped(whole: &str, mark: char) -> Option<String> {
    let mut groups = whole.split(|c| is_mark(c, mark));
    let first = groups.next()?;
    let rest: Vec<&str> = groups.collect();
    let lead = first.trim_start_matches(['+', '-']);
    let is_grouped = (1..=3).contains(&lead.len())
        && rest
            .iter()
            .all(|group| group.len() == 3 && group.bytes().all(|b| b.is_ascii_digit()));
    (rest.is_empty() || is_grouped).then(|| format!("{first}{}", rest.concat()))
}

/// Whether a number, with or without such a mark, could have it between thousands: `1,234`, not `0,123` or `1,23`.
fn could_be_thousands(text: &str, mark: char) -> bool {
    let digits = text.trim_start_matches(['+', '-']);
    digits.contains(|c| is_mark(c, mark))
        && !digits.starts_with('0')
        && digits
            .chars()
            .all(|c| c.is_ascii_digit() || is_mark(c, mark))
        && ungrouped(digits, mark).is_some()
}

/// Whether a cell is a number in any way of writing.
pub(super) fn is_number(text: &str) -> bool {
    if text.parse::<f64>().is_ok() {
        return true;
    }
    let starts = text.starts_with(|c: char| c.is_ascii_digit() || "+-.,".contains(c));
    starts
        && [false, true].into_iter().any(|decimal_comma| {
            let marks = THOUSANDS.into_iter().map(Some).chain([None]);
            let mut marks =
                marks.filter(|mark| *mark != Some(if decimal_comma { ',' } else { '.' }));
            marks.any(|thousands| {
                let numbers = Numbers {
                    decimal_comma,
                    thousands,
                };
                numbers.parse(text).is_some()
            })
        })
}

/// Where a cell stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub line: u64,
    pub column: usize,
    pub text: String,
}

/// What the cells of a file say about how its numbers are written.
#[derive(Clone, Debug, Default)]
pub(super) struct Evidence {
    decimal_comma: Option<Place>,
    decimal_point: Option<Place>,
    thousands: Option<(char, Place)>,
    /// `1,234`: a decimal comma, or a thousand.
    open_comma: Option<Place>,
    /// `1.234`, where the columns are separated by semicolons.
    open_point: Option<Place>,
}

/// A file that can be read in two ways.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Ambiguous {
    pub place: Place,
    pub is_comma: bool,
}

impl Evidence {
    /// Looks at one number.
    pub fn take(&mut self, text: &str, line: u64, column: usize) {
        let place = || Place {
            line,
            column,
            text: text.to_owned(),
        };
        let digits = text.trim_start_matches(['+', '-']);
        for mark in ['\'', ' '] {
            if digits.contains(|c| is_mark(c, mark)) {
                self.thousands.get_or_insert_with(|| (mark, place()));
            }
        }
        let count = |mark: char| digits.matches(mark).count();
        let (commas, points) = (count(','), count('.'));
        let comma_last = digits.rfind(',') > digits.rfind('.');
        let both = commas > 0 && points > 0;
        if both || commas > 1 || points > 1 {
            let of_both = if comma_last { '.' } else { ',' };
            let of_many = if commas > 1 { ',' } else { '.' };
            let mark = if both { of_both } else { of_many };
            self.thousands.get_or_insert_with(|| (mark, place()));
        }
        let slot = match (commas, points) {
            (1.., 1..) if comma_last => &mut self.decimal_comma,
            (1.., 1..) => &mut self.decimal_point,
            (1, 0) if could_be_thousands(digits, ',') => &mut self.open_comma,
            (1, 0) => &mut self.decimal_comma,
            (0, 1) if could_be_thousands(digits, '.') => &mut self.open_point,
            (0, 1) => &mut self.decimal_point,
            _ => return,
        };
        slot.get_or_insert_with(place);
    }

    /// How the numbers are written, as far as flags leave it open; `point_is_open` where a lone point may separate
    /// thousands.
    ///
    /// # Errors
    /// The cell that could be two numbers.
    pub fn decide(
        &self,
        decimal_comma: Option<bool>,
        thousands: Option<Option<char>>,
        point_is_open: bool,
    ) -> Result<Numbers, Box<Ambiguous>> {
        let seen = thousands.unwrap_or_else(|| self.thousands.as_ref().map(|(mark, _)| *mark));
        let comma = decimal_comma.unwrap_or_else(|| self.is_decimal_comma(seen, thousands));
        let point = if comma { ',' } else { '.' };
        let seen = seen.filter(|mark| *mark != point);
        let settled = decimal_comma.is_some() || thousands.is_some();
        let open = |place: &Option<Place>, is_comma| match place.clone() {
            Some(place) if !settled => Err(Box::new(Ambiguous { place, is_comma })),
            _ => Ok(()),
        };
        if !comma && seen != Some(',') && self.decimal_point.is_none() {
            open(&self.open_comma, true)?;
        }
        if !comma && seen.is_none() && point_is_open && self.decimal_point.is_none() {
            open(&self.open_point, false)?;
        }
        let by_point = !comma && seen.is_none() && self.open_comma.is_some();
        let by_comma = comma && seen.is_none() && thousands.is_none() && self.open_point.is_some();
        Ok(Numbers {
            decimal_comma: comma,
            thousands: match (by_point, by_comma) {
                (true, _) => Some(','),
                (_, true) if self.decimal_point.is_none() && decimal_comma.is_none() => Some('.'),
                _ => seen,
            },
        })
    }

    fn is_decimal_comma(&self, seen: Option<char>, said: Option<Option<char>>) -> bool {
        let said_other = said.is_some() && seen != Some(',') && self.open_comma.is_some();
        seen != Some(',')
            && (self.decimal_comma.is_some()
                || (seen == Some('.') && self.decimal_point.is_none())
                || (said_other && self.decimal_point.is_none()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_numbers_are_those_of_the_library_to_the_last_bit() {
        let mut state = 1_u64;
        for _ in 0..20_000 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let digits = format!("{:015}", (state >> 11) % 1_000_000_000_000_000);
            let at = (state % 16) as usize;
            let text = format!("-{}.{}", &digits[..at], &digits[at..]);
            for text in [
                &text[..],
                &text[1..],
                &text[2..],
                &text[..at + 1],
                &text[9..],
            ] {
                let Some(x) = plain(text.as_bytes()) else {
                    assert!(
                        text.len() < 2 || !text.starts_with(|c: char| c.is_ascii_digit()),
                        "{text}"
                    );
                    continue;
                };
                assert_eq!(
                    x.to_bits(),
                    text.parse::<f64>().unwrap().to_bits(),
                    "{text}"
                );
            }
        }
        for other in [
            "",
            "-",
            ".",
            "-.",
            "1e3",
            "nan",
            "1,5",
            " 1",
            "1.2.3",
            "+1",
            "inf",
            "0123456789012345",
        ] {
            assert_eq!(plain(other.as_bytes()), None, "{other}");
        }
        assert_eq!(plain(b"-0").map(f64::to_bits), Some((-0.0_f64).to_bits()));
    }

    fn decided(cells: &[&str], point_is_open: bool) -> Result<Numbers, Box<Ambiguous>> {
        let mut evidence = Evidence::default();
        for (k, cell) in cells.iter().enumerate() {
            assert!(is_number(cell), "{cell}");
            evidence.take(cell, k as u64 + 1, 0);
        }
        evidence.decide(None, None, point_is_open)
    }

    #[test]
    fn the_way_of_writing_is_told_by_the_cells_that_tell_it() {
        let cases: [(&[&str], bool, Option<char>); 9] = [
            (&["1.5", "2"], false, None),
            (&["1,5", "2"], true, None),
            (&["1.234,5"], true, Some('.')),
            (&["1,234.5"], false, Some(',')),
            (&["1'234.5", "0.1"], false, Some('\'')),
            (&["1\u{202f}234,5"], true, Some(' ')),
            (&["1,234", "0,5"], true, None),
            (&["1,234", "0.5"], false, Some(',')),
            (&["1.234", "0,5"], true, Some('.')),
        ];
        for (cells, decimal_comma, thousands) in cases {
            let found = decided(cells, true).unwrap();
            let expected = Numbers {
                decimal_comma,
                thousands,
            };
            assert_eq!(found, expected, "{cells:?}");
        }
    }

    #[test]
    fn what_could_be_two_numbers_is_not_guessed() {
        assert!(decided(&["1,234", "5,678"], true).unwrap_err().is_comma);
        assert!(!decided(&["1.234"], true).unwrap_err().is_comma);
        assert_eq!(decided(&["1.234"], false).unwrap(), Numbers::default());
        let mut evidence = Evidence::default();
        evidence.take("1,234", 1, 0);
        let comma = evidence.decide(Some(true), None, true).unwrap();
        assert_eq!(comma.parse("1,234"), Some(1.234));
        let grouped = evidence.decide(None, Some(Some(',')), true).unwrap();
        assert_eq!(grouped.parse("1,234"), Some(1234.0));
        let none = evidence.decide(None, Some(None), true).unwrap();
        assert_eq!(none.parse("1,234"), Some(1.234));
    }

    #[test]
    fn a_group_has_three_digits() {
        let numbers = Numbers {
            decimal_comma: true,
            thousands: Some('.'),
        };
        assert_eq!(numbers.parse("-12.345,6"), Some(-12345.6));
        assert_eq!(numbers.parse("1.5"), None);
        assert_eq!(numbers.parse("2,5E-3"), Some(2.5e-3));
        let plain = Numbers {
            decimal_comma: true,
            thousands: None,
        };
        assert_eq!(
            (plain.parse("0.5"), plain.parse("1.234")),
            (Some(0.5), None)
        );
    }
}
