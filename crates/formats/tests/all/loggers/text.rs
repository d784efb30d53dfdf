//! Ways of writing numbers and rows.

use super::wave::Instant;
use std::fmt::Write as _;

/// `0.1234`, so many digits behind the point.
pub fn fixed(x: f64, digits: usize) -> String {
    format!("{x:.digits$}")
}

/// `0,1234`.
pub fn comma(x: f64, digits: usize) -> String {
    fixed(x, digits).replace('.', ",")
}

/// `-1.234500E-003`: exponents with a sign and at least so many digits.
pub fn scientific(x: f64, digits: usize, exponent: usize) -> String {
    let text = format!("{x:.digits$E}");
    let (mantissa, power) = text.split_once('E').expect("an exponent");
    let (sign, power) = power
        .strip_prefix('-')
        .map_or(('+', power), |power| ('-', power));
    format!("{mantissa}E{sign}{power:0>exponent$}")
}

/// `-12'345.67` with any mark between thousands and any decimal mark.
pub fn grouped(x: f64, digits: usize, mark: &str, point: &str) -> String {
    let text = fixed(x.abs(), digits);
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    let mut out = if x < 0.0 {
        "-".to_owned()
    } else {
        String::new()
    };
    for (k, digit) in whole.chars().enumerate() {
        if k > 0 && (whole.len() - k) % 3 == 0 {
            out += mark;
        }
        out.push(digit);
    }
    let point = if fraction.is_empty() { "" } else { point };
    format!("{out}{point}{fraction}")
}

/// `14:05:06.2500` since a time of day in s, with so many digits.
pub fn clock(start_s: f64, t: f64, digits: u32) -> String {
    let scale = 10u64.pow(digits);
    let ticks = ((start_s + t) * scale as f64).round() as u64;
    let (seconds, fraction) = (ticks / scale, ticks % scale);
    let width = digits as usize;
    let (h, m, s) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{h:02}:{m:02}:{s:02}.{fraction:0width$}")
}

/// A head and a row for each instant.
pub fn table(
    head: &str,
    wave: &[Instant],
    separator: &str,
    end: &str,
    row: impl Fn(&Instant) -> Vec<String>,
) -> String {
    let mut text = head.replace('\n', end);
    for instant in wave {
        let _ = write!(text, "{}{end}", row(instant).join(separator));
    }
    text
}

/// Text as Windows-1252; every character must have a place there below 256.
pub fn windows_1252(text: &str) -> Vec<u8> {
    text.chars()
        .map(|c| u8::try_from(u32::from(c)).expect("in Latin-1"))
        .collect()
}

/// Text as UTF-16 of little end first.
pub fn utf16(text: &str, with_mark: bool) -> Vec<u8> {
    let mark = with_mark.then_some(0xFEFF);
    mark.into_iter()
        .chain(text.encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect()
}
