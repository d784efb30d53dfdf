//! "Did you mean ...?"

/// The candidate that a misspelt name most resembles, if any resembles it.
///
/// Upper case and separators do not count; of the rest at most one letter in four may differ, and a
/// name of two letters must agree in all (`vd` is not a misspelt `va`).
pub fn closest<'c>(name: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let plain = normalised(name);
    candidates
        .into_iter()
        .map(|candidate| (distance(&plain, &normalised(candidate)), candidate))
        .filter(|(distance, candidate)| distance * 4 <= candidate.len())
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

fn normalised(name: &str) -> Vec<char> {
    let kept = name.chars().filter(|c| c.is_alphanumeric());
    kept.flat_map(char::to_lowercase).take(64).collect()
}

/// Levenshtein's edit distance.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_recognised_and_a_stranger_is_not() {
        let known = ["va", "ia", "speed", "torque", "temperature"];
        let cases = [
            ("Speed", Some("speed")),
            ("spead", Some("speed")),
            ("temperatur", Some("temperature")),
            ("I_a", Some("ia")),
            ("vd", None),
            ("speed_raw", None),
            ("dc_field_amp", None),
            ("", None),
        ];
        for (name, expected) in cases {
            assert_eq!(closest(name, known), expected, "{name}");
        }
    }
}
