//! Section 4, right half, and sections 5 and 6: the full motor in steady state.

use super::*;
use motor::Mechanics;
use motor::steady_state::{OperatingPoint, SteadyState, rotor_flux};

pub struct Full {
    pub believed: TParams<f64>,
    pub mechanics: Mechanics<f64>,
    omega_sync: f64,
}

pub fn full() -> Full {
    let file = motor();
    Full {
        believed: file.parameters,
        mechanics: file.mechanics,
        omega_sync: file.nameplate.omega_sync(),
    }
}

impl Full {
    pub fn point(&self, plant: &TParams<f64>, b_t: f64) -> OperatingPoint<f64> {
        let u = Complex64::new(TABLE_VOLT, 0.0);
        SteadyState::new(plant, self.mechanics.n_p, u, self.omega_sync).at_friction(b_t)
    }

    /// Terminal phasors in the supply's frame.
    fn terminals(&self, point: &OperatingPoint<f64>) -> Measured {
        Measured {
            u: point.u_s,
            i: point.i_s,
            omega_el: point.omega_el,
            omega_sync: self.omega_sync,
        }
    }

    /// Turns the phasors so that the rotor flux computed from them lies on the d axis.
    fn to_rotor_flux(&self, m: Measured) -> Measured {
        let flux = rotor_flux(&self.believed, m.u, m.i, self.omega_sync);
        let back = flux.conj() / flux.norm();
        Measured {
            u: m.u * back,
            i: m.i * back,
            ..m
        }
    }

    /// Turns the phasors so that the voltage lies on the q axis.
    fn to_voltage(&self, m: Measured) -> Measured {
        let back = Complex64::i() * m.u.conj() / m.u.norm();
        Measured {
            u: m.u * back,
            i: m.i * back,
            ..m
        }
    }

    /// (37) with the live field current.
    fn live(&self, b_t: f64, m: Measured) -> [f64; 4] {
        residuals(&self.believed, self.mechanics.n_p, b_t, m.i.re, m)
    }

    fn fault(&self, fault: &str, factor: f64) -> [f64; 4] {
        let mut plant = self.believed;
        let mut mechanics = self.mechanics;
        match fault {
            "Rs" => plant.r_s *= factor,
            "Rr" => plant.r_r *= factor,
            "Lls" => plant.l_ls *= factor,
            "Llr" => plant.l_lr *= factor,
            "Lm" => plant.l_m *= factor,
            "B" => mechanics.friction *= factor,
            "Bl" => mechanics.load_friction *= factor,
            _ => {}
        }
        let mut terminals = self.terminals(&self.point(&plant, mechanics.total_friction()));
        match fault {
            // As the table has it: all three voltage sensors, so that the flux angle follows.
            "Vq" => terminals.u *= factor,
            "wr" => terminals.omega_el *= factor,
            _ => {}
        }
        let mut dq = self.to_rotor_flux(terminals);
        match fault {
            // The paper's way: one d-q signal is changed behind the transformation; the angle stays.
            "Iq" => dq.i.im *= factor,
            "Vq on d-q" => dq.u.im *= factor,
            _ => {}
        }
        self.live(self.mechanics.total_friction(), dq)
    }
}

#[test]
fn the_full_motor_gives_the_right_hand_table() {
    let (two, one) = (TWO_DIGITS, ONE_DIGIT);
    #[rustfmt::skip]
    let table = [
        ("Rs",  [(-2.81, two), (-2.19, two), (-0.76, two), (-2.94, two)]),
        ("Rr",  [(-1.24, two), (0.0, two), (-1.24, two), (-1.24, two)]),
        ("Lls", [(-1.84, two), (1.95, two), (-3.70, two), (-1.73, two)]),
        ("Lm",  [(-30.2, one), (33.9, one), (-52.6, one), (-27.4, one)]),
        ("Llr", [(1.02, two), (-1.20, two), (2.20, two), (0.96, two)]),
        ("B",   [(0.0, two), (-9.04, two), (8.75, two), (-0.50, two)]),
        ("Bl",  [(0.0, two), (-39.2, one), (37.5, one), (-2.21, two)]),
        // Printed r2 is -50: that is -K_f N_p I_q over B_t w_r; over B_t w_s, as everywhere else, -48.7.
        ("Iq",  [(2.70, two), (-48.7, one), (50.0, one), (0.0, two)]),
        ("Vq",  [(-33.0, one), (0.99, two), (-33.6, one), (-33.0, one)]),
        ("wr",  [(47.3, one), (48.7, one), (0.0, two), (50.0, one)]),
    ];
    for (fault, printed) in table {
        assert_row(fault, full().fault(fault, 1.5), printed);
    }
}

/// The rows of Table 1 that survive exact physics, both directions, sensor faults on the d-q signal.
/// (Half the voltage on all three sensors instead also lights r2, at -3.4 %.)
#[test]
fn seven_faults_keep_their_published_pattern_on_the_full_motor() {
    for (fault, expected) in TABLE_1 {
        if fault == "Ls" || fault == "Lr" {
            continue;
        }
        for factor in [1.5, 0.5] {
            let injected = if fault == "Vq" { "Vq on d-q" } else { fault };
            let r = full().fault(injected, factor);
            for thresholds in threshold_sets() {
                let lit = lamps(r, thresholds);
                assert_eq!(lit, expected, "{fault} x {factor}: {r:.2?}, {thresholds:?}");
            }
        }
    }
}

/// Section 5: the healthy motor under load, in both frames. The believed load follows the load.
#[test]
fn the_voltage_frame_errs_with_load_and_the_rotor_flux_frame_does_not() {
    let table = [
        (0.1, -0.28, -15.96),
        (1.0, 1.33, 2.76),
        (1.5, 4.00, 1.90),
        (2.5, 13.05, -6.15),
    ];
    let full = full();
    for (load, r1, r2) in table {
        // r1 at a tenth of the load comes out as -0.2747: its last printed digit is off by one.
        let digits = if load == 0.1 { 0.005_5 } else { TWO_DIGITS };
        let b_t = full.mechanics.friction + load * full.mechanics.load_friction;
        let terminals = full.terminals(&full.point(&full.believed, b_t));
        let voltage = full.live(b_t, full.to_voltage(terminals));
        assert!((voltage[0] - r1).abs() <= digits, "{load}: {voltage:.4?}");
        assert!(
            (voltage[1] - r2).abs() <= TWO_DIGITS,
            "{load}: {voltage:.4?}"
        );
        for r in full.live(b_t, full.to_rotor_flux(terminals)) {
            // Zero up to the rounding of the operating point, in percent.
            assert!(r.abs() < 1e-9, "{load}: {r}");
        }
    }
}

/// Section 5: frozen at its nominal value, the field current moves the Rs fault from r1 into r2. The
/// printed figures are those of an instrument that knows the true flux angle; with the angle computed
/// from the believed `R_s` they are 0.24 and -5.5.
#[test]
fn a_frozen_field_current_hides_a_stator_fault_from_r1() {
    let full = full();
    let b_t = full.mechanics.total_friction();
    let nominal = full.point(&full.believed, b_t).in_rotor_flux_frame().i_d;
    let mut plant = full.believed;
    plant.r_s *= 1.5;
    let point = full.point(&plant, b_t);
    let frozen = |m| residuals(&full.believed, full.mechanics.n_p, b_t, nominal, m);
    let dq = point.in_rotor_flux_frame();
    let known_angle = frozen(Measured {
        u: Complex64::new(dq.u_d, dq.u_q),
        i: Complex64::new(dq.i_d, dq.i_q),
        ..full.terminals(&point)
    });
    assert!(
        (known_angle[0] + 0.03).abs() <= TWO_DIGITS,
        "{known_angle:.4?}"
    );
    assert!(
        (known_angle[1] + 1.5).abs() <= ONE_DIGIT,
        "{known_angle:.4?}"
    );
    let computed_angle = frozen(full.to_rotor_flux(full.terminals(&point)));
    assert!(
        (computed_angle[0] - 0.24).abs() <= TWO_DIGITS,
        "{computed_angle:.4?}"
    );
    assert!(
        (computed_angle[1] + 5.51).abs() <= TWO_DIGITS,
        "{computed_angle:.4?}"
    );
}

/// Section 6: r1, r2, e_d, e_q of 5 % faults at rated load.
#[test]
fn the_two_further_residuals_span_a_third_dimension() {
    #[rustfmt::skip]
    let table = [
        ("Rs",  [-0.27, -0.25, 0.29, -0.01]),
        ("Rr",  [-0.13, 0.00, 0.00, 0.12]),
        ("Lm",  [-4.23, 4.93, 4.34, 0.01]),
        ("B",   [0.00, -0.91, 0.00, 0.00]),
        ("I",   [4.92, -10.2, -4.91, -0.15]),
        ("V",   [-4.69, 0.15, 4.68, 0.14]),
        ("wr",  [4.73, 4.87, 0.00, -4.43]),
        ("Lls", [-0.20, 0.21, 0.18, 0.02]),
        ("Llr", [0.10, -0.12, -0.10, 0.00]),
    ];
    for (fault, printed) in table {
        let ours = four_directions(fault);
        for k in 0..4 {
            let tolerance = if printed[k] == -10.2 {
                ONE_DIGIT
            } else {
                TWO_DIGITS
            };
            assert!(
                (ours[k] - printed[k]).abs() <= tolerance,
                "{fault}: {ours:.4?}"
            );
        }
    }
}

fn four_directions(fault: &str) -> [f64; 4] {
    let full = full();
    let p = full.believed;
    let mut plant = p;
    let mut mechanics = full.mechanics;
    match fault {
        "Rs" => plant.r_s *= 1.05,
        "Rr" => plant.r_r *= 1.05,
        "Lm" => plant.l_m *= 1.05,
        "Lls" => plant.l_ls *= 1.05,
        "Llr" => plant.l_lr *= 1.05,
        "B" => mechanics.friction *= 1.05,
        _ => {}
    }
    let mut m = full.terminals(&full.point(&plant, mechanics.total_friction()));
    match fault {
        "I" => m.i *= 1.05,
        "V" => m.u *= 1.05,
        "wr" => m.omega_el *= 1.05,
        _ => {}
    }
    let flux = rotor_flux(&p, m.u, m.i, m.omega_sync).norm();
    let dq = full.to_rotor_flux(m);
    let r = full.live(full.mechanics.total_friction(), dq);
    let v = m.u.norm();
    let e_d = (flux - p.l_m * dq.i.re) * m.omega_sync * p.l_m / (p.l_r() * v);
    let e_q = ((m.omega_sync - m.omega_el) * flux - p.r_r * p.l_m / p.l_r() * dq.i.im) / v;
    [r[0], r[1], 100.0 * e_d, 100.0 * e_q]
}
