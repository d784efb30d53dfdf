//! The motor as the current model sees it: its constants, and what the iron and the winding's temperature make of them.

use motor::{Mechanics, TParams};
use num_complex::Complex32;

use monitor::magnitude;

/// Saturating iron: `L_m = L_m0/(1 + s ((psi_m/psi_n)^n - 1))`, the library's `magnetizing-saturation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iron {
    /// `s`; 0 for linear iron.
    pub saturation: f32,
    /// `n`.
    pub exponent: f32,
}

impl Iron {
    /// Linear iron, with the exponent by which it would saturate.
    pub const LINEAR: Iron = Iron {
        saturation: 0.0,
        exponent: 7.0,
    };
}

/// Rated amplitudes that rows are shares of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Phase voltage, V.
    pub voltage: f32,
    /// Phase current, A.
    pub current: f32,
    /// Supply, rad/s.
    pub omega: f32,
    /// Torque, N m.
    pub torque: f32,
}

impl Scales {
    /// Rated flux linkage, V s.
    pub fn flux(&self) -> f32 {
        self.voltage / self.omega
    }
}

/// What is known of the motor and its load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circuit {
    /// Parameters at the temperature of the motor file and at rated flux.
    pub params: TParams<f32>,
    /// Iron.
    pub iron: Iron,
    /// Pole pairs, inertia; friction as declared.
    pub mechanics: Mechanics<f32>,
    /// Friction that the torque row takes off beside a measured torque, N m s.
    pub friction: f32,
    /// Rated values.
    pub rated: Scales,
    /// Sampling time, s.
    pub t_sample: f32,
}

/// Coefficients of the flux equations, constant from one part of a cycle to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficients {
    /// Stator resistance, ohm.
    pub r_s: f32,
    /// Rotor resistance, ohm.
    pub r_r: f32,
    /// Stator leakage, H.
    pub l_ls: f32,
    /// Rotor leakage, H.
    pub l_lr: f32,
    /// Magnetizing inductance at the present flux, H.
    pub l_m: f32,
    /// `L_lr + L_m`, H.
    pub l_r: f32,
    /// `L_m/L_r`.
    pub k_r: f32,
    /// `L_ls + k_r L_lr`, H.
    pub l_a: f32,
    /// `exp(-T R_r/L_r)`: what the rotor flux keeps of itself from one sample to the next.
    pub keep: f32,
}

/// Flux beyond which the iron's law is not followed, share of rated.
const MOST_FLUX: f32 = 1.3;

impl Circuit {
    /// Coefficients at a flux of the magnetizing branch, V s, and a relative rise of both resistances.
    pub fn at(&self, psi_m: f32, rise: f32) -> Coefficients {
        let p = &self.params;
        let l_m = p.l_m / (1.0 + self.iron.saturation * self.bend(psi_m));
        let l_r = p.l_lr + l_m;
        let k_r = l_m / l_r;
        let r_r = p.r_r * (1.0 + rise);
        let decay = self.t_sample * r_r / l_r;
        Coefficients {
            r_s: p.r_s * (1.0 + rise),
            r_r,
            l_ls: p.l_ls,
            l_lr: p.l_lr,
            l_m,
            l_r,
            k_r,
            l_a: p.l_ls + k_r * p.l_lr,
            keep: libm::expf(-decay),
        }
    }

    /// `(psi_m/psi_n)^n - 1`.
    pub fn bend(&self, psi_m: f32) -> f32 {
        let share = (psi_m / self.rated.flux()).min(MOST_FLUX);
        power(share, self.iron.exponent) - 1.0
    }

    /// Time constant of the open rotor, `L_r/R_r`, s.
    pub fn rotor_time(&self) -> f32 {
        self.params.l_r() / self.params.r_r
    }

    /// Samples of one rated cycle.
    pub fn cycle_samples(&self) -> f32 {
        libm::roundf(core::f32::consts::TAU / (self.rated.omega * self.t_sample))
    }

    /// Apparent impedance at a slip: what current noise does to the voltage rows, ohm.
    pub fn impedance(&self, slip: f32) -> f32 {
        let p = &self.params;
        let omega = self.rated.omega;
        let rotor = p.l_m * p.l_m / p.l_r() / Complex32::new(1.0, slip * omega * self.rotor_time());
        magnitude(Complex32::new(p.r_s, 0.0) + Complex32::new(0.0, omega) * (rotor + p.l_a()))
    }
}

impl Coefficients {
    /// Flux of the magnetizing branch, `L_m (i_s + i_r)`, from the rotor flux, V s.
    pub fn air_gap(&self, psi_r: Complex32, i_s: Complex32) -> f32 {
        self.k_r * magnitude(psi_r + i_s * self.l_lr)
    }

    /// Stator flux `L_a i + k_r psi_r`, V s.
    pub fn linkage(&self, psi_r: Complex32, i_s: Complex32) -> Complex32 {
        i_s * self.l_a + psi_r * self.k_r
    }
}

/// `x^n`; whole exponents, as most are, by products.
fn power(x: f32, n: f32) -> f32 {
    /// Largest exponent that is multiplied out.
    const MOST_PRODUCTS: f32 = 16.0;
    let whole = n as u8;
    if n > MOST_PRODUCTS || f32::from(whole) != n {
        return libm::powf(x, n);
    }
    (0..whole).fold(1.0, |product, _| product * x)
}

/// `e^{j 2 pi/3}`.
const TURN: Complex32 = Complex32::new(-0.5, 0.866_025_4);
/// Axis of each phase.
pub const PHASES: [Complex32; 3] = [Complex32::ONE, TURN, Complex32::new(-0.5, -0.866_025_4)];
