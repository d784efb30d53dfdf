//! Supply cycles between two operating points, with the noise and the counts that the samples would have had.

use monitor::{
    CHANNELS, ChannelCycle, ClippedChannels, Cycle, CyclePhasors, MonitorConfig, SpeedReading,
    TorqueReading,
};
use num_complex::{Complex32, Complex64};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::instrument::Instrument;
use super::operating::Shows;
use crate::runs::run::T_SAMPLE_S;

/// Makes one cycle after the other.
#[derive(Clone, Debug)]
pub struct Cycles {
    sigma: [f32; CHANNELS],
    offset: [f32; CHANNELS],
    encoder: Encoder,
    /// Where the positive sequence of the voltage lies, seen from the oscillator.
    reference: Complex64,
    backwards: bool,
}

/// Counts of an encoder, and times of its edges to a sample.
#[derive(Clone, Debug)]
struct Encoder {
    counts_per_rad: f64,
    /// Angle since the reference edge, counts.
    angle: f64,
    /// Samples since the reference edge, and the part of a sample by which cycles are behind.
    samples: f64,
    rest: f64,
}

impl Cycles {
    /// Cycles as `instrument` shows them; the voltage begins at the angle that samples left, as a unit vector.
    pub fn new(
        instrument: &Instrument,
        config: &MonitorConfig,
        reference: Complex64,
        backwards: bool,
        random: &mut Pcg64,
    ) -> Cycles {
        let counts = f64::from(config.encoder_counts_per_revolution);
        Cycles {
            sigma: instrument.sigmas().map(|x| x as f32),
            offset: instrument.offsets().map(|x| x as f32),
            encoder: Encoder {
                counts_per_rad: counts / std::f64::consts::TAU,
                angle: random.random(),
                samples: 0.0,
                rest: random.random(),
            },
            reference,
            backwards,
        }
    }

    /// The cycle at `share` (0..1) of the way from one operating point to the next.
    pub fn cycle(&mut self, from: &Shows, to: &Shows, share: f64, random: &mut Pcg64) -> Cycle {
        let between = |a: f64, b: f64| a + (b - a) * share;
        let samples = 1.0 / (between(from.hertz, to.hertz) * T_SAMPLE_S);
        let beside = [0, 1].map(|k| between(from.beside[k], to.beside[k]) as f32);
        let deviation = (2.0 / samples).sqrt() as f32;
        let mut channels: [ChannelCycle; CHANNELS] = std::array::from_fn(|k| {
            let (a, b) = (from.phasors[k], to.phasors[k]);
            let phasor = (a + (b - a) * share) * self.reference;
            let sigma = self.sigma[k];
            self.channel(k, single(phasor), beside[k / 3], sigma * deviation, random)
        });
        let speed = between(from.omega_mech, to.omega_mech);
        let mut omega_mech = self.encoder.over(speed, samples);
        if self.backwards {
            channels.swap(1, 2);
            channels.swap(4, 5);
            omega_mech = -omega_mech;
        }
        Cycle {
            phasors: CyclePhasors {
                channels,
                samples: samples as f32,
                missing: 0.0,
            },
            speed: SpeedReading {
                omega_mech: Some(omega_mech as f32),
                ..SpeedReading::default()
            },
            torque: TorqueReading::default(),
            clipped: ClippedChannels::NONE,
            invalid_samples: 0,
        }
    }

    fn channel(
        &self,
        k: usize,
        phasor: Complex32,
        beside: f32,
        deviation: f32,
        random: &mut Pcg64,
    ) -> ChannelCycle {
        let mut noise = || -> f32 { StandardNormal.sample(random) };
        let noisy = phasor + Complex32::new(noise(), noise()) * deviation;
        let offset = self.offset[k];
        let sigma = self.sigma[k];
        ChannelCycle {
            phasor: noisy,
            offset,
            mean_square: 0.5 * noisy.norm_sqr() + offset * offset + sigma * sigma + beside,
        }
    }
}

impl Encoder {
    /// Mean speed from the last edge before the cycle to the last edge in it, edges known to a sample, rad/s.
    fn over(&mut self, omega: f64, samples: f64) -> f64 {
        let ends = samples + self.rest;
        let whole = ends.floor();
        self.rest = ends - whole;
        let per_sample = omega * self.counts_per_rad * T_SAMPLE_S;
        self.angle += per_sample * whole;
        self.samples += whole;
        let counts = self.angle.floor();
        let behind = ((self.angle - counts) / per_sample).floor();
        let until_edge = self.samples - behind;
        self.angle -= counts;
        self.samples = behind;
        counts / (self.counts_per_rad * until_edge * T_SAMPLE_S)
    }
}

fn single(z: Complex64) -> Complex32 {
    Complex32::new(z.re as f32, z.im as f32)
}
