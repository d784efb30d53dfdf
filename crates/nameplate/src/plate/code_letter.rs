//! NEMA code letters: locked-rotor apparent power per horsepower (NEMA MG 1, 10.37.2).

use super::Printed;

/// Least kVA per horsepower of each letter; the next letter's is its upper end.
const LETTERS: [(char, f64); 20] = [
    ('A', 2.0),
    ('B', 3.15),
    ('C', 3.55),
    ('D', 4.0),
    ('E', 4.5),
    ('F', 5.0),
    ('G', 5.6),
    ('H', 6.3),
    ('J', 7.1),
    ('K', 8.0),
    ('L', 9.0),
    ('M', 10.0),
    ('N', 11.2),
    ('P', 12.5),
    ('R', 14.0),
    ('S', 16.0),
    ('T', 18.0),
    ('U', 20.0),
    ('V', 22.4),
    ('-', 25.0),
];

/// kVA per horsepower in the middle of a letter's range, its half step half of the range.
pub fn kva_per_horsepower(letter: char) -> Option<Printed> {
    let ranges = LETTERS.windows(2);
    let range = ranges
        .into_iter()
        .find(|range| range[0].0 == letter.to_ascii_uppercase())?;
    let (low, high) = (range[0].1, range[1].1);
    Some(Printed {
        value: 0.5 * (low + high),
        half_step: 0.5 * (high - low),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_ranges() {
        let g = kva_per_horsepower('g').unwrap();
        assert!((g.value - 5.95).abs() < 1e-12 && (g.half_step - 0.35).abs() < 1e-12);
        assert!(kva_per_horsepower('I').is_none() && kva_per_horsepower('-').is_none());
    }
}
