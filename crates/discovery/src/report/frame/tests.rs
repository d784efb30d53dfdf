use super::*;
use estimation::specimen;
use motor::steady_state::OperatingPoint;

const RIGHT: Form = Form {
    frame: Frame::RotorFlux,
    constant: None,
};
const PUBLISHED: Form = Form {
    frame: Frame::Voltage,
    constant: None,
};

fn window_of(point: &OperatingPoint<f64>) -> Window {
    Window {
        u: point.u_s.norm(),
        i: point.i_s * point.u_s.conj() / point.u_s.norm(),
        omega_sync: point.omega_sync,
        omega_el: point.omega_el,
        sigma: [0.1, 0.002, 0.05],
    }
}

fn params() -> TParams<f64> {
    specimen::prior("").plant.motor
}

/// (37) row 1 is zero at every load in the rotor-flux frame; in the voltage frame it is what the paper's signals give.
#[test]
fn r1_is_zero_in_one_frame_and_grows_with_the_load_in_the_other() {
    let p = params();
    for torque in [0.0, 0.5, 1.0, 1.7] {
        let point = specimen::point(torque);
        let window = window_of(&point);
        assert!(RIGHT.r1(&p, &window).abs() < 1e-12);
        let dq = point.in_voltage_frame();
        let r1 = p.r_a() * dq.i_q + p.l_s() * dq.i_d * point.omega_el - dq.u_q;
        assert!((PUBLISHED.r1(&p, &window) - r1 / window.u).abs() < 1e-12);
        let nominal = Form {
            constant: Some(1.05),
            ..PUBLISHED
        };
        let r1 = p.r_a() * dq.i_q + p.l_s() * 1.05 * point.omega_el - dq.u_q;
        assert!((nominal.r1(&p, &window) - r1 / window.u).abs() < 1e-12);
    }
}

/// Noise of the voltage, of the current (and half a per cent of it) over `R_a`, of the speed over the flux.
#[test]
fn r1_is_weighed_by_the_noise_of_everything_in_it() {
    let p = params();
    let window = window_of(&specimen::point(1.0));
    let [u, i, omega] = window.sigma;
    let model = 0.005 * window.i.norm();
    let ampere = (i * i + model * model).sqrt();
    let flux = window.u / window.omega_sync;
    let volt = (u * u + (p.r_a() * ampere).powi(2) + (flux * omega).powi(2)).sqrt();
    let expected = PUBLISHED.r1(&p, &window) * window.u / volt;
    assert!((PUBLISHED.weighted(&p, &window) / expected - 1.0).abs() < 1e-12);
}

/// Neighbours that differ by normal noise of one standard deviation each scatter by one.
#[test]
fn scatter_is_that_between_neighbours() {
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};
    let p = params();
    let mut window = window_of(&specimen::point(1.0));
    window.sigma = [1.0, 0.0, 0.0];
    let normal = Normal::new(0.0, 3.0).expect("a deviation");
    let mut rng = rand_pcg::Pcg64::seed_from_u64(9);
    // A draw of the speed that moves `weighted` by three.
    let base = window;
    let per_rad = {
        let mut moved = base;
        moved.omega_el += 1.0;
        RIGHT.weighted(&p, &moved) - RIGHT.weighted(&p, &base)
    };
    let windows: Vec<Window> = (0..4001)
        .map(|_| {
            let mut w = base;
            w.omega_el += normal.sample(&mut rng) / per_rad;
            w
        })
        .collect();
    let scatter = RIGHT.scatter(&p, &windows);
    assert!((scatter / 3.0 - 1.0).abs() < 0.05, "{scatter}");
}

fn case(seconds: f64, torque: impl Fn(f64) -> f64) -> Case {
    let prior = specimen::prior("");
    Case::new(&specimen::recording(seconds, torque), &prior.plant.rated).expect("judged")
}

/// Five periods of 60 Hz are 83 ms: eleven whole windows in a second, all of them steady.
#[test]
fn windows_hold_the_operating_point() {
    let prior = specimen::prior("");
    let found = windows(&case(1.0, |_| 1.0), &prior);
    assert!((11..=12).contains(&found.len()), "{}", found.len());
    let expected = window_of(&specimen::point(1.0));
    for window in &found {
        assert!((window.u / expected.u - 1.0).abs() < 1e-4);
        assert!((window.i - expected.i).norm() < 1e-3 * expected.i.norm());
        assert!((window.omega_sync / expected.omega_sync - 1.0).abs() < 1e-5);
        assert!((window.omega_el / expected.omega_el - 1.0).abs() < 1e-6);
    }
    // Means over a window of some 208 rows: the noise of one sample over the root of their number.
    let rows = (5.0 / 60.0 / 4e-4_f64).round().sqrt();
    let [u, i, omega] = found[0].sigma;
    let [volt, ampere, speed, _] = specimen::SIGMA;
    let axis = (2.0f64 / 3.0).sqrt();
    assert!((u / (axis * volt / rows) - 1.0).abs() < 1e-6);
    assert!((omega / (2.0 * speed / rows) - 1.0).abs() < 1e-6);
    // At a current of zero only the instrument's noise is left.
    assert!((i / (axis * ampere / rows) - 1.0).abs() < 0.02);
}

#[test]
fn a_window_with_a_load_step_in_it_is_not_steady() {
    let prior = specimen::prior("");
    let steady = windows(&case(2.0, |_| 1.0), &prior).len();
    let stepped = windows(&case(2.0, |t| if t < 1.04 { 0.5 } else { 1.5 }), &prior);
    assert_eq!(stepped.len() + 1, steady);
    let light = stepped
        .iter()
        .filter(|w| w.omega_el > specimen::point(1.0).omega_el);
    assert!((11..=13).contains(&light.count()));
}

const VOLTAGE_FRAME: &str = "[monitor]\nframe = \"voltage\"\n";

/// Loads in stairs of 0.25 s from idle to rated torque.
fn stairs(t: f64) -> f64 {
    0.17 * (t / 0.25).floor()
}

fn judged(rest: &str, cases: &[Case]) -> Option<FrameReport> {
    let prior = specimen::prior("");
    let all: Vec<&Case> = cases.iter().collect();
    judge(&specimen::motor(rest), &prior, &params(), &all)
}

#[test]
fn the_voltage_frame_is_found_to_cost() {
    let cases = [case(2.5, stairs), case(2.5, |t| 1.53 - stairs(t))];
    let report = judged(VOLTAGE_FRAME, &cases).expect("another frame");
    assert!(report.proven, "{report:?}");
    assert!(
        report.held_out_before > 3.0 * report.held_out_after,
        "{report:?}"
    );
    assert!(
        report.fitted_before > 3.0 * report.fitted_after,
        "{report:?}"
    );
    assert_eq!(
        report.windows,
        report.by_load.iter().map(|b| b.windows).sum::<usize>()
    );
    let p = params();
    for band in &report.by_load {
        assert!(band.r1_after_percent < 0.05, "{band:?}");
        // The air gap carries the bearings' friction too, a tenth of rated torque is a band.
        let rated = 0.01 * band.load_percent * 1.7;
        let shaft = rated - 0.0008 * specimen::point(0.5).omega_mech;
        let r1 = |torque: f64| 100.0 * PUBLISHED.r1(&p, &window_of(&specimen::point(torque)));
        let (low, high) = (r1(shaft - 0.086), r1(shaft + 0.086));
        let seen = [-1.0, 1.0].map(|sign| sign * band.r1_before_percent);
        let inside = |x: f64| (low.min(high) - 0.02..=low.max(high) + 0.02).contains(&x);
        assert!(seen.into_iter().any(inside), "{band:?} {low} {high}");
    }
    let loads: Vec<f64> = report.by_load.iter().map(|b| b.load_percent).collect();
    assert!(loads.windows(2).all(|w| w[0] < w[1]) && loads.iter().all(|x| x % 10.0 == 0.0));
}

#[test]
fn the_right_frame_is_not_judged_and_neither_are_few_windows() {
    assert_eq!(judged("", &[case(2.5, stairs)]), None);
    assert_eq!(judged(VOLTAGE_FRAME, &[case(0.7, |_| 1.0)]), None);
    let nominal = "[monitor]\nfield_current = \"nominal\"\n";
    assert!(judged(nominal, &[case(2.5, stairs)]).is_some());
}

#[test]
fn errors_of_proving_recordings_speak_before_those_of_the_first() {
    let errors = |first: &[f64], proof: &[f64]| Errors {
        first: first.to_vec(),
        proof: proof.to_vec(),
    };
    assert_eq!(errors(&[4.0, 4.0], &[]).held_out(), 2.0);
    assert_eq!(errors(&[4.0, 4.0], &[9.0]).held_out(), 3.0);
    let (large, small) = ([4.0; 12], [1.0; 12]);
    assert!(errors(&small, &[]).beats(&errors(&large, &[])));
    assert!(errors(&small, &small).beats(&errors(&large, &large)));
    // Both must gain, and by two per cent.
    assert!(!errors(&small, &large).beats(&errors(&large, &large)));
    assert!(!errors(&large, &small).beats(&errors(&large, &large)));
    assert!(!errors(&[3.9; 12], &[]).beats(&errors(&large, &[])));
    assert!(errors(&[3.8; 12], &[]).beats(&errors(&large, &[])));
}
