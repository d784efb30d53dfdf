use super::*;

const MOTOR: TParams<f64> = TParams {
    r_s: 3.7,
    r_r: 2.3,
    l_ls: 0.011,
    l_lr: 0.009,
    l_m: 0.234,
};
const OMEGA: f64 = 314.0;
const VOLT: f64 = 326.0;

/// Steady running at a slip: the current of the equivalent circuit, rotor branch `R_r/s + j w L_lr`.
fn running(slip: f64) -> Window {
    let j = Complex64::i();
    let (rotor, iron) = (
        MOTOR.r_r / slip + j * OMEGA * MOTOR.l_lr,
        j * OMEGA * MOTOR.l_m,
    );
    let impedance = MOTOR.r_s + j * OMEGA * MOTOR.l_ls + rotor * iron / (rotor + iron);
    Window {
        u: VOLT,
        i: VOLT / impedance,
        omega_sync: OMEGA,
        omega_el: (1.0 - slip) * OMEGA,
        sigma: [0.1, 0.01, 0.05],
    }
}

fn form(frame: Frame, constant: Option<f64>) -> Form {
    Form { frame, constant }
}

#[test]
fn the_residual_vanishes_in_the_rotor_flux_frame_at_every_slip() {
    for slip in [-0.05, 1e-6, 0.01, 0.05, 0.3] {
        let r1 = form(Frame::RotorFlux, None).r1(&MOTOR, &running(slip));
        // Rounding of a few products.
        assert!(r1.abs() < 1e-12, "{slip}: {r1}");
    }
}

#[test]
fn in_the_voltage_frame_the_residual_is_what_the_equations_leave() {
    let w = running(0.05);
    // The voltage on the q axis: i_q = Re i, i_d = -Im i.
    let left = MOTOR.r_a() * w.i.re - MOTOR.l_s() * w.i.im * w.omega_el - VOLT;
    let r1 = form(Frame::Voltage, None).r1(&MOTOR, &w);
    assert!((r1 - left / VOLT).abs() < 1e-12, "{r1}");
    // It grows with the load.
    let light = form(Frame::Voltage, None).r1(&MOTOR, &running(0.005));
    assert!(r1.abs() > 5.0 * light.abs(), "{r1} {light}");
}

#[test]
fn a_constant_field_current_is_wrong_by_its_share_of_the_induced_voltage() {
    let w = running(0.03);
    let psi = rotor_flux(&MOTOR, Complex64::new(w.u, 0.0), w.i, OMEGA);
    let live = (w.i * psi.conj() / psi.norm()).re;
    let r1 = form(Frame::RotorFlux, Some(1.1 * live)).r1(&MOTOR, &w);
    let expected = 0.1 * MOTOR.l_s() * live * w.omega_el / VOLT;
    assert!((r1 - expected).abs() < 1e-12, "{r1} {expected}");
}

#[test]
fn noise_counts_in_volts_on_one_axis() {
    let mut w = running(0.03);
    w.omega_el += 1.0;
    let right = form(Frame::RotorFlux, None);
    let psi = rotor_flux(&MOTOR, Complex64::new(w.u, 0.0), w.i, OMEGA);
    let live = (w.i * psi.conj() / psi.norm()).re;
    let current = MOTOR.r_a() * 0.01f64.hypot(RELATIVE_CURRENT * w.i.norm());
    let sigma = (0.1f64.powi(2) + current.powi(2) + (VOLT / OMEGA * 0.05).powi(2)).sqrt();
    let expected = MOTOR.l_s() * live / sigma;
    let weighted = right.weighted(&MOTOR, &w);
    assert!((weighted / expected - 1.0).abs() < 1e-9, "{weighted}");
}

#[test]
fn enough_loaded_windows_prove_the_frame() {
    let errors = |form: Form, slips: &[f64]| {
        let windows = vec![slips.iter().map(|&s| running(s)).collect::<Vec<_>>()];
        Errors::of(form, &MOTOR, &windows, 1.0)
    };
    let loaded: Vec<f64> = (1..=20).map(|k| 0.002 * f64::from(k)).collect();
    let [wrong, right] = [Frame::Voltage, Frame::RotorFlux].map(|f| form(f, None));
    assert!(errors(right, &loaded).beats(&errors(wrong, &loaded)));
    assert!(!errors(wrong, &loaded).beats(&errors(right, &loaded)));
    assert!(!errors(right, &loaded[..3]).beats(&errors(wrong, &loaded[..3])));
}
