//! Simulated motors of another form than the circuit that is fitted: deep bars after Field instead of two cages, leakage
//! that saturates by a describing function. Computed here, with no code of the crate.

use nalgebra::Complex;
use nameplate::contradiction::Contradiction;
use nameplate::{Estimate, Plate};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::f64::consts::PI;

/// A motor per unit of rated voltage; impedances in ohm at 400 V are these times 400/sqrt(3) V over rated current.
struct Machine {
    stator_resistance: f64,
    rotor_resistance: f64,
    stator_leakage: f64,
    rotor_leakage: f64,
    magnetizing: f64,
    core_conductance: f64,
    windage: f64,
    stray: f64,
    /// Bar height over the depth of penetration at standstill.
    bar: f64,
    /// Share of the rotor's resistance and leakage in the slots.
    slot: [f64; 2],
    /// Leakage at infinite current, and the current at which saturation begins.
    saturation: [f64; 2],
}

struct Point {
    torque: f64,
    current: f64,
    power_factor: f64,
    input: f64,
}

impl Machine {
    fn drawn(rng: &mut Pcg64Mcg) -> (Machine, f64) {
        let mut log = |low: f64, high: f64| rng.random_range(low.ln()..high.ln()).exp();
        let power_kw = log(0.5, 500.0);
        let size = (power_kw / 10.0f64).powf(-0.2);
        let machine = Machine {
            stator_resistance: 0.03 * size * log(0.7, 1.4),
            rotor_resistance: 0.025 * size * log(0.7, 1.4),
            stator_leakage: log(0.07, 0.12),
            rotor_leakage: log(0.07, 0.13),
            magnetizing: log(1.8, 3.6),
            core_conductance: 0.015 * size * log(0.6, 1.6),
            windage: 0.01 * size * log(0.5, 1.5),
            stray: 0.01 * log(0.6, 1.5),
            bar: log(1.2, 3.5),
            slot: [log(0.5, 0.8), log(0.2, 0.5)],
            saturation: [log(0.6, 0.95), log(1.2, 2.5)],
        };
        (machine, power_kw)
    }

    /// Resistance and reactance factors of a bar (A. B. Field, 1905).
    fn bar_factors(&self, slip: f64) -> (f64, f64) {
        let xi = (self.bar * slip.sqrt()).max(1e-3);
        let (twice, below) = (2.0 * xi, (2.0 * xi).cosh() - (2.0 * xi).cos());
        (
            xi * (twice.sinh() + twice.sin()) / below,
            1.5 * (twice.sinh() - twice.sin()) / (xi * below),
        )
    }

    fn leakage_factor(&self, current: f64) -> f64 {
        let [least, begins] = self.saturation;
        if current <= begins {
            return 1.0;
        }
        let b = begins / current;
        least + (1.0 - least) * 2.0 / PI * (b.asin() + b * (1.0 - b * b).sqrt())
    }

    /// `torque_base` scales windage and stray load.
    fn at(&self, slip: f64, torque_base: f64) -> Point {
        let (resistance, reactance) = self.bar_factors(slip);
        let [r_slot, x_slot] = self.slot;
        let r_r = self.rotor_resistance * (1.0 - r_slot + r_slot * resistance);
        let mut current = 1.0;
        let mut i = Complex::new(0.0, 0.0);
        let mut torque = 0.0;
        for _ in 0..200 {
            let g = self.leakage_factor(current);
            let x_r = self.rotor_leakage * g * (1.0 - x_slot + x_slot * reactance);
            let rotor = Complex::new(r_r / slip, x_r);
            let parallel =
                Complex::new(self.core_conductance, -1.0 / self.magnetizing) + rotor.inv();
            let stator = Complex::new(self.stator_resistance, self.stator_leakage * g);
            i = (stator + parallel.inv()).inv();
            torque = (i / parallel / rotor).norm_sqr() * r_r / slip;
            if (i.norm() - current).abs() < 1e-11 * current {
                break;
            }
            current = 0.5 * (current + i.norm());
        }
        let speed = 1.0 - slip;
        Point {
            torque: torque
                - torque_base * speed * (self.windage * speed + self.stray * i.norm_sqr()),
            current: i.norm(),
            power_factor: i.re / i.norm(),
            input: i.re,
        }
    }

    /// A coarse grid of the slip's logarithm, then a fine one around its best: the torque there is flat to 1e-6.
    fn greatest_torque(&self, rated_slip: f64) -> f64 {
        let torque = |x: f64| self.at(rated_slip.powf(x.clamp(0.0, 1.0)), 0.8).torque;
        let best = |places: Vec<f64>| {
            let better = |a: &f64, b: &f64| torque(*a).total_cmp(&torque(*b));
            places.into_iter().max_by(better).unwrap()
        };
        let coarse = best((0..=60).map(|k| f64::from(k) / 60.0).collect());
        let fine = |k: i32| coarse + f64::from(k - 40) / 40.0 / 60.0;
        torque(best((0..=80).map(fine).collect()))
    }

    /// The plate, with every digit; `None` where no such motor would be sold.
    fn plate(&self, power_kw: f64) -> Option<Plate> {
        let (mut low, mut high) = (1e-4, 0.2);
        for _ in 0..100 {
            let slip: f64 = 0.5 * (low + high);
            if self.at(slip, 0.8).current < 1.0 {
                low = slip
            } else {
                high = slip
            }
        }
        let slip = 0.5 * (low + high);
        let rated = self.at(slip, 0.8);
        let breakdown = self.greatest_torque(slip);
        let locked = self.at(1.0, 0.8);
        let efficiency = rated.torque * (1.0 - slip) / rated.input;
        let sold = (0.5..0.98).contains(&efficiency)
            && (0.6..0.95).contains(&rated.power_factor)
            && breakdown > 1.6 * rated.torque
            && locked.torque > 0.4 * rated.torque;
        let exact = |x: f64| Some(nameplate::plate::Printed::exact(x));
        sold.then(|| Plate {
            power_kw: exact(power_kw),
            voltage_volt: exact(400.0),
            frequency_hz: exact(50.0),
            speed_rpm: exact(1500.0 * (1.0 - slip)),
            efficiency_percent: exact(100.0 * efficiency),
            power_factor: exact(rated.power_factor),
            current_amp: None,
            dc_resistance: None,
            breakdown_torque_ratio: exact(breakdown / rated.torque),
            locked_rotor_torque_ratio: exact(locked.torque / rated.torque),
            locked_rotor_current_ratio: exact(locked.current / rated.current),
        })
    }
}

#[test]
fn motors_of_another_form_are_met_and_never_accused() {
    let mut rng = Pcg64Mcg::seed_from_u64(19);
    let machines: Vec<_> = (0..4000).map(|_| Machine::drawn(&mut rng)).collect();
    let plates: Vec<Plate> = machines
        .par_iter()
        .filter_map(|(machine, power_kw)| machine.plate(*power_kw))
        .collect();
    let plates = &plates[..2000];
    let estimates: Vec<Estimate> = plates
        .par_iter()
        .map(|p| Estimate::of(p).unwrap())
        .collect();
    let within = |limit: f64| {
        estimates.iter().filter(|e| e.fit.worst <= limit).count() as f64 / estimates.len() as f64
    };
    println!(
        "within 1 % {:.1} %, 5 % {:.1} %",
        100.0 * within(0.01),
        100.0 * within(0.05)
    );
    assert!(within(0.01) >= 0.97);
    let accused = |estimate: &&Estimate| {
        let impossible = |c: &Contradiction| matches!(c, Contradiction::Impossible { .. });
        estimate.contradictions.iter().any(impossible)
    };
    assert_eq!(estimates.iter().filter(accused).count(), 0);
}
