//! A simulated motor on a test bench, computed here with no code of the crate: a phasor circuit that is solved by substitution.
//!
//! Per unit of rated voltage and current. The laws of saturation and skin effect can be those of the crate or others.

use nalgebra::Complex;

pub type C = Complex<f64>;

/// Temperature at which copper and aluminium would have no resistance, degC below zero.
const ZERO: [f64; 2] = [235.0, 225.0];

/// How the magnetizing branch and the leakages saturate, and the rotor's skin effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Laws {
    /// Powers of the flux, two cages, leakage with `x^2/(1 + x^2)`: those that are fitted.
    Fitted,
    /// Iron with a knee (tangent hyperbolic below, straight above), bars after Field, leakage by a describing function.
    Others,
}

#[derive(Clone, Debug)]
pub struct Machine {
    pub laws: Laws,
    pub stator_resistance: f64,
    pub leakage: f64,
    pub magnetizing: f64,
    pub inner_resistance: f64,
    pub outer_resistance: f64,
    pub inner_leakage: f64,
    pub core_conductance: f64,
    /// Windage and friction, and stray load, over rated torque at rated speed and current.
    pub windage: f64,
    pub stray: f64,
    /// Leakage at infinite current over leakage at rated current.
    pub saturated_leakage: f64,
    /// Share of the magnetizing current that saturates at rated load, and the exponent.
    pub saturation: [f64; 2],
    /// Air-gap voltage at rated load.
    pub rated_air_gap: f64,
    /// Bearings' share of friction at rated speed.
    pub bearings: f64,
    pub warm_degc: f64,
    pub slip: f64,
    pub rated_torque: f64,
}

/// What the instruments would show without error.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    pub current: f64,
    pub active: f64,
    pub reactive: f64,
    pub torque: f64,
    pub air_gap: f64,
}

impl Machine {
    fn leakage_factor(&self, current: f64) -> f64 {
        let lost = |i: f64| (i / 3.0).powi(2) / (1.0 + (i / 3.0).powi(2));
        let k = self.saturated_leakage;
        match self.laws {
            Laws::Fitted => {
                let drop = (1.0 - k) / (1.0 - k * lost(1.0));
                (1.0 - drop * lost(current)) / (1.0 - drop * lost(1.0))
            }
            Laws::Others => {
                let begins = 1.5;
                if current <= begins {
                    return 1.0;
                }
                let b = begins / current;
                k + (1.0 - k) * 2.0 / std::f64::consts::PI * (b.asin() + b * (1.0 - b * b).sqrt())
            }
        }
    }

    pub fn susceptance(&self, air_gap: f64, nu: f64) -> f64 {
        let flux = air_gap / nu / self.rated_air_gap;
        let [share, exponent] = self.saturation;
        let grown = match self.laws {
            Laws::Fitted => flux.powf(exponent),
            // The same value and slope at rated flux as the power has.
            Laws::Others => {
                let knee = |x: f64| (1.0 + (4.0 * (x - 1.0)).exp()).ln() / 2f64.ln();
                knee(1.0 + (flux - 1.0) * exponent * 2f64.ln() / 2.0)
            }
        };
        (1.0 - share + share * grown) / self.magnetizing / nu
    }

    /// Impedance of the rotor at a slip and frequency.
    fn rotor(&self, slip: f64, current: f64, nu: f64, warmth: f64) -> C {
        let g = nu * self.leakage_factor(current);
        let common = C::new(0.0, self.leakage * g);
        if self.laws == Laws::Fitted {
            let inner = C::new(
                self.inner_resistance * warmth / slip,
                self.inner_leakage * g,
            );
            let outer = C::new(self.outer_resistance * warmth / slip, 0.0);
            return common + inner * outer / (inner + outer);
        }
        // A bar (A. B. Field, 1905) with the resistance and leakage of both cages at low slip.
        let r = self.inner_resistance * self.outer_resistance
            / (self.inner_resistance + self.outer_resistance);
        let share = self.outer_resistance / (self.inner_resistance + self.outer_resistance);
        let slot = self.inner_leakage * share * share;
        let xi = (1.5 * slot / (0.7 * r) * nu * slip / warmth)
            .sqrt()
            .clamp(1e-3, 20.0);
        let (twice, below) = (2.0 * xi, (2.0 * xi).cosh() - (2.0 * xi).cos());
        let k_r = xi * (twice.sinh() + twice.sin()) / below;
        let k_x = 1.5 * (twice.sinh() - twice.sin()) / (xi * below);
        common + C::new(r * warmth * (0.3 + 0.7 * k_r) / slip, slot * g * k_x)
    }

    pub fn friction(&self, speed: f64) -> f64 {
        self.rated_torque * self.windage * (self.bearings + (1.0 - self.bearings) * speed * speed)
    }

    /// At a terminal voltage, slip, frequency over rated and winding temperature.
    pub fn at(&self, voltage: f64, slip: f64, nu: f64, degc: f64) -> Shown {
        let warmth = ZERO.map(|zero| (zero + degc) / (zero + self.warm_degc));
        let (mut current, mut air_gap) = (voltage, 0.9 * voltage);
        let mut i = C::new(0.0, 0.0);
        let mut rotor = C::new(1.0, 0.0);
        for _ in 0..200 {
            rotor = self.rotor(slip, current, nu, warmth[1]);
            let parallel =
                C::new(self.core_conductance, -self.susceptance(air_gap, nu)) + rotor.inv();
            let stator = C::new(
                self.stator_resistance * warmth[0],
                self.leakage * nu * self.leakage_factor(current),
            );
            i = voltage / (stator + parallel.inv());
            let e = (i / parallel).norm();
            let moved = (i.norm() - current).abs() / current + (e - air_gap).abs() / air_gap;
            (current, air_gap) = (i.norm(), e);
            if moved < 1e-10 {
                break;
            }
        }
        let speed = nu * (1.0 - slip) / (1.0 - self.slip);
        let turning = if speed > 0.0 { 1.0 } else { 0.0 };
        let braking = self.friction(speed) + self.rated_torque * self.stray * current * current;
        Shown {
            current,
            active: voltage * i.re,
            reactive: -voltage * i.im,
            torque: air_gap * air_gap * rotor.inv().re / nu - turning * braking,
            air_gap,
        }
    }

    /// Uncoupled: the slip at which the shaft gives nothing.
    pub fn uncoupled(&self, voltage: f64, degc: f64) -> Shown {
        let (mut low, mut high) = (1e-8, 0.2);
        for _ in 0..60 {
            let middle = f64::sqrt(low * high);
            match self.at(voltage, middle, 1.0, degc).torque < 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        self.at(voltage, low, 1.0, degc)
    }

    /// Locked, with the voltage that drives a current.
    pub fn locked(&self, current: f64, nu: f64, degc: f64) -> (f64, Shown) {
        let (mut low, mut high) = (0.001, 2.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match self.at(middle, 1.0, nu, degc).current < current {
                true => low = middle,
                false => high = middle,
            }
        }
        (low, self.at(low, 1.0, nu, degc))
    }

    /// The slip of the greatest torque between rated slip and standstill.
    pub fn breakdown_slip(&self, degc: f64) -> f64 {
        let torque = |x: f64| self.at(1.0, self.slip.powf(x), 1.0, degc).torque;
        let best = |places: Vec<f64>| {
            let better = |a: &f64, b: &f64| torque(*a).total_cmp(&torque(*b));
            places.into_iter().max_by(better).unwrap()
        };
        let coarse = best((0..=30).map(|k| f64::from(k) / 30.0).collect());
        let fine = |k: i32| (coarse + f64::from(k - 15) / 15.0 / 30.0).clamp(0.0, 1.0);
        self.slip.powf(best((0..=30).map(fine).collect()))
    }
}
