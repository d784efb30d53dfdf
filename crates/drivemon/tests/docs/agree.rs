//! Whether a page shows what was printed.

const ANY_LINES: &str = "...";

/// Whether shown lines, `...` among them, are those that were printed.
pub fn agree(shown: &[String], printed: &[String]) -> bool {
    match (shown, printed) {
        ([], []) => true,
        ([any, rest @ ..], _) if any == ANY_LINES => {
            (0..=printed.len()).any(|skipped| agree(rest, &printed[skipped..]))
        }
        ([line, rest @ ..], [other, others @ ..]) => same_line(line, other) && agree(rest, others),
        _ => false,
    }
}

fn same_line(shown: &str, printed: &str) -> bool {
    let (mut ours, mut theirs) = (shown.split_whitespace(), printed.split_whitespace());
    loop {
        match (ours.next(), theirs.next()) {
            (None, None) => return true,
            (Some(a), Some(b)) if a == b || same_number(a, b) => {}
            _ => return false,
        }
    }
}

fn same_number(shown: &str, printed: &str) -> bool {
    let trimmed = |text: &str| text.trim_end_matches([',', ';', ':', '%']).to_owned();
    let (a, b) = (trimmed(shown), trimmed(printed));
    let decimals = |text: &str| text.split_once('.').map_or(0, |(_, digits)| digits.len());
    let (Ok(x), Ok(y)) = (a.parse::<f64>(), b.parse::<f64>()) else {
        return false;
    };
    let unit = 0.1_f64.powi(i32::try_from(decimals(&a)).unwrap_or(i32::MAX));
    decimals(&a) == decimals(&b) && (x - y).abs() < 1.01 * unit
}
