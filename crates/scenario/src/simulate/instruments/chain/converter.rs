//! What a converter adds: charge of the channel before, and codes off the straight line.

use crate::chain::{CHANNELS, Inl, InlShape, SEQUENCE};
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// The upper bits whose weights are uncertain, and the pieces that they divide the range into.
const BITS: usize = 6;
const PIECES: usize = 1 << BITS;
/// Keeps the bit weights apart from the noise, which is drawn from the same seed.
const STREAM: u64 = 0x494e_4c00_0000_0000;
/// Crest of `s - s^3`, at `s = 1/sqrt(3)`.
const CUBIC_CREST: f64 = 0.384_900_179_459_750_5;

/// Lets each channel take a share of its difference to the one before; `last` is the one before the first. Gives the last.
pub(super) fn crosstalk(shares: &mut [f64; CHANNELS], last: f64, leak: f64) -> f64 {
    let mut before = last;
    for k in SEQUENCE {
        let own = shares[k];
        shares[k] += leak * (before - own);
        before = own;
    }
    before
}

/// The integral non-linearity over the range.
#[derive(Clone, Debug)]
pub(super) struct Linearity {
    inl: Inl,
    /// LSB per piece, for [`InlShape::Bits`].
    pieces: [f64; PIECES],
}

impl Linearity {
    pub(super) fn new(inl: &Inl, seed: u64) -> Linearity {
        let pieces = match inl.shape {
            InlShape::Bits => scaled(deviations(seed), inl.lsb),
            InlShape::Bow | InlShape::Cubic => [0.0; PIECES],
        };
        Linearity { inl: *inl, pieces }
    }

    /// Deviation of a share of full scale, LSB.
    pub(super) fn lsb(&self, share: f64) -> f64 {
        let s = share.clamp(-1.0, 1.0);
        match self.inl.shape {
            InlShape::Bow => self.inl.lsb * (1.0 - s * s),
            InlShape::Cubic => self.inl.lsb * s * (1.0 - s * s) / CUBIC_CREST,
            InlShape::Bits => {
                // From 0 to PIECES: inside an index.
                let piece = ((s + 1.0) / 2.0 * PIECES as f64) as usize;
                self.pieces[piece.min(PIECES - 1)]
            }
        }
    }
}

/// Pieces from random bit weights, off the line through both ends. A bit's error grows with the root of its weight, as
/// that of capacitors side by side does.
fn deviations(seed: u64) -> [f64; PIECES] {
    let mut random = Pcg64::seed_from_u64(seed ^ STREAM);
    let weights: [f64; BITS] = std::array::from_fn(|bit| {
        let normal: f64 = random.sample(StandardNormal);
        normal * f64::from(1_u32 << bit).sqrt()
    });
    let sum = |piece: usize| -> f64 {
        let bits = weights.iter().enumerate();
        bits.filter(|(bit, _)| piece >> bit & 1 == 1)
            .map(|(_, w)| w)
            .sum()
    };
    let last = sum(PIECES - 1);
    std::array::from_fn(|piece| sum(piece) - last * piece as f64 / (PIECES - 1) as f64)
}

fn scaled(pieces: [f64; PIECES], largest: f64) -> [f64; PIECES] {
    let crest = pieces.iter().fold(0.0_f64, |crest, x| crest.max(x.abs()));
    pieces.map(|x| x * largest / crest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(shape: InlShape, seed: u64) -> Linearity {
        Linearity::new(&Inl { lsb: 2.0, shape }, seed)
    }

    #[test]
    fn every_shape_reaches_its_size_and_begins_and_ends_on_the_line() {
        for shape in [InlShape::Bow, InlShape::Cubic, InlShape::Bits] {
            let inl = of(shape, 7);
            let shares = (-1000..=1000).map(|k| f64::from(k) / 1000.0);
            let crest = shares.fold(0.0_f64, |crest, s| crest.max(inl.lsb(s).abs()));
            assert!((crest - 2.0).abs() < 1e-4, "{shape:?}: {crest}");
            for end in [-1.0, 1.0, -7.0, 7.0] {
                assert!(inl.lsb(end).abs() < 1e-12, "{shape:?} at {end}");
            }
        }
    }

    #[test]
    fn bit_weights_follow_the_seed() {
        let table = |seed| of(InlShape::Bits, seed).pieces;
        assert_eq!(table(1), table(1));
        assert_ne!(table(1), table(2));
    }

    #[test]
    fn each_channel_takes_a_share_of_the_one_converted_before() {
        // Order of conversion: va ia vb ib vc ic.
        let mut shares = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        let last = crosstalk(&mut shares, 1.0, 0.01);
        let expected = [
            0.1 + 0.01 * (1.0 - 0.1),
            0.2 + 0.01 * (0.4 - 0.2),
            0.3 + 0.01 * (0.5 - 0.3),
            0.4 + 0.01 * (0.1 - 0.4),
            0.5 + 0.01 * (0.2 - 0.5),
            0.6 + 0.01 * (0.3 - 0.6),
        ];
        for (share, expected) in shares.iter().zip(expected) {
            assert!((share - expected).abs() < 1e-15);
        }
        assert_eq!(last, 0.6);
    }
}
