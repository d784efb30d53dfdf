//! Rows of whole numbers as few bytes: differences of each column, seven bits a byte, then Zstandard.

/// Level of compression. Higher levels take several times as long and win some per cent.
const LEVEL: i32 = 3;

/// More bytes than any block unpacks to: a damaged one takes no memory.
const MOST_BYTES: usize = 16_000_000;

/// Bytes of the largest number.
const LONGEST: usize = 10;

/// Packs rows of `WIDTH` numbers.
pub(super) fn pack<const WIDTH: usize>(rows: &[[i64; WIDTH]]) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(rows.len() * WIDTH);
    for column in 0..WIDTH {
        let mut before = 0_i64;
        for row in rows {
            put(&mut bytes, row[column].wrapping_sub(before));
            before = row[column];
        }
    }
    zstd::bulk::compress(&bytes, LEVEL)
}

/// The rows; `None` where the bytes are damaged.
pub(super) fn unpack<const WIDTH: usize>(bytes: &[u8], count: usize) -> Option<Vec<[i64; WIDTH]>> {
    let most = count.checked_mul(WIDTH)?.checked_mul(LONGEST)?;
    if most > MOST_BYTES {
        return None;
    }
    let bytes = zstd::bulk::decompress(bytes, most).ok()?;
    let mut bytes = bytes.iter().copied();
    let mut rows = vec![[0; WIDTH]; count];
    for column in 0..WIDTH {
        let mut before = 0_i64;
        for row in &mut rows {
            before = before.wrapping_add(take(&mut bytes)?);
            row[column] = before;
        }
    }
    bytes.next().is_none().then_some(rows)
}

/// Small numbers of either sign become small ones without sign, seven bits a byte from the lowest.
fn put(bytes: &mut Vec<u8>, number: i64) {
    let mut rest = ((number << 1) ^ (number >> 63)) as u64;
    while rest >= 0x80 {
        bytes.push(rest as u8 | 0x80);
        rest >>= 7;
    }
    bytes.push(rest as u8);
}

fn take(bytes: &mut impl Iterator<Item = u8>) -> Option<i64> {
    let mut number = 0_u64;
    for shift in (0..64).step_by(7) {
        let byte = bytes.next()?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some((number >> 1) as i64 ^ -((number & 1) as i64));
        }
    }
    None
}

/// Bits of a float that history leaves out: 15 of the 23 of its fraction are left, half a step is 1.6e-5 of the value.
const LEFT_OUT: u32 = 8;

/// A float as a whole number of which near values are near.
pub(super) fn of_float(value: f32) -> i64 {
    let bits = if value.is_nan() {
        f32::NAN.to_bits()
    } else {
        value.to_bits()
    };
    let half = 1 << (LEFT_OUT - 1);
    // Rounding up from the largest fraction goes on to the next power of two, as it should; infinity stays.
    let rounded = if value.is_finite() {
        bits.saturating_add(half)
    } else {
        bits
    };
    i64::from(rounded >> LEFT_OUT)
}

/// The float back.
pub(super) fn to_float(number: i64) -> f32 {
    f32::from_bits((number as u32) << LEFT_OUT)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn rows_come_back(rows in proptest::collection::vec(any::<[i64; 3]>(), 0..50)) {
            let bytes = pack(&rows).unwrap();
            prop_assert_eq!(unpack::<3>(&bytes, rows.len()), Some(rows.clone()));
            prop_assert_eq!(unpack::<3>(&bytes, rows.len() + 1), None);
        }

        #[test]
        fn damaged_bytes_are_refused_or_are_other_numbers(bytes: Vec<u8>, count in 0_usize..100) {
            if let Some(rows) = unpack::<2>(&bytes, count) {
                prop_assert_eq!(rows.len(), count);
            }
        }

        #[test]
        fn a_float_keeps_fifteen_bits(value in proptest::num::f32::NORMAL) {
            let back = to_float(of_float(value));
            // Half a step of a fraction of 15 bits.
            prop_assert!((back - value).abs() <= value.abs() * 2_f32.powi(-16), "{} {}", value, back);
        }
    }

    #[test]
    fn what_is_no_number_stays_none() {
        assert!(to_float(of_float(f32::NAN)).is_nan());
        assert!(to_float(of_float(-f32::NAN)).is_nan());
        assert_eq!(to_float(of_float(f32::INFINITY)), f32::INFINITY);
        assert_eq!(to_float(of_float(0.0)), 0.0);
    }
}
