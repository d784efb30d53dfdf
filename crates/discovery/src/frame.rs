//! The monitor's own model against the recording: does its frame hold at every load?
//!
//! The published instrument puts the voltage on the q axis, but (13)-(29) hold in the rotor-flux frame (Energies 2022,
//! 15(22), 8372; docs/theory.md). The first residual of (37) over windows of steady running tells: with parameters that
//! explain currents and speed it stays near zero in the right frame and grows with the load in the wrong one.

use crate::belief::Belief;
use crate::case::{Case, RELATIVE_CURRENT};
use crate::proof::wilcoxon;
use motor::dynamic::clarke;
use motor::motor_file::{FieldCurrent, Frame};
use motor::steady_state::rotor_flux;
use motor::{MotorFile, TParams};
use num_complex::Complex64;
use serde::Serialize;

/// Name under which `explain` reports and `adopt` takes the frame.
pub(crate) const NAME: &str = "rotor-flux-frame";
/// Supply periods in a window.
const PERIODS: f64 = 5.0;
/// Largest relative change of current, and of voltage and speed, between the halves of a steady window.
const STEADY: [f64; 2] = [0.006, 0.001];
/// Fewest windows from which anything is concluded.
const LEAST_WINDOWS: usize = 10;
/// Least relative gain of held-out error, and largest probability of the pairs without an advantage.
const PROOF: (f64, f64) = (0.02, 0.005);

/// Steady running over a few periods.
#[derive(Clone, Copy, Debug)]
struct Window {
    /// Voltage, V; the real axis lies on it.
    u: f64,
    /// Current relative to the voltage, A.
    i: Complex64,
    /// Supply frequency, rad/s.
    omega_sync: f64,
    /// Electrical rotor speed, rad/s.
    omega_el: f64,
    /// Standard deviations of the means: voltage (V), current (A), electrical speed (rad/s).
    sigma: [f64; 3],
}

/// How the residual is formed.
#[derive(Clone, Copy, Debug)]
struct Form {
    frame: Frame,
    /// Constant field current, A.
    constant: Option<f64>,
}

/// The residual at one load, with the parameters of the motor file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameBand {
    /// Air-gap torque over rated torque, percent, to the nearest ten.
    pub load_percent: f64,
    /// Windows of steady running at this load.
    pub windows: usize,
    /// Root mean square of r1 over the voltage in the frame of the motor file, percent.
    pub r1_before_percent: f64,
    /// The same in the rotor-flux frame with live field current, percent.
    pub r1_after_percent: f64,
}

/// What the frame of the motor file costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameReport {
    /// Windows of steady running.
    pub windows: usize,
    /// Error over noise of r1 in the motor file's frame, on the proving recordings or else on the only one; its
    /// parameters explain currents and speed, r1 itself is never fitted.
    pub held_out_before: f64,
    /// The same in the rotor-flux frame.
    pub held_out_after: f64,
    /// Error over noise of r1 on the first recording before.
    pub fitted_before: f64,
    /// The same after.
    pub fitted_after: f64,
    /// Whether the gain is proven on every recording.
    pub proven: bool,
    /// By load.
    pub by_load: Vec<FrameBand>,
}

/// Judges the frame of a motor file with parameters `fitted` to currents and speed; `None` if it already is the right
/// frame or too little runs steadily.
pub(crate) fn judge(
    motor: &MotorFile,
    belief: &Belief,
    fitted: &TParams<f64>,
    cases: &[&Case],
) -> Option<FrameReport> {
    let constant = match motor.monitor.field_current {
        FieldCurrent::Nominal => Some(motor.nominal_field_current()),
        FieldCurrent::Live => None,
    };
    let believed = Form {
        frame: motor.monitor.frame,
        constant,
    };
    if believed.frame == Frame::RotorFlux && constant.is_none() {
        return None;
    }
    let right = Form {
        frame: Frame::RotorFlux,
        constant: None,
    };
    let windows: Vec<Vec<Window>> = cases.iter().map(|c| windows(c, belief)).collect();
    if windows.iter().any(|w| w.len() < LEAST_WINDOWS) {
        return None;
    }
    let scatter = windows
        .iter()
        .map(|w| right.scatter(fitted, w))
        .fold(1.0, f64::max);
    let [before, after] = [believed, right].map(|form| Errors::of(form, fitted, &windows, scatter));
    Some(FrameReport {
        windows: windows.iter().map(Vec::len).sum(),
        held_out_before: before.held_out(),
        held_out_after: after.held_out(),
        fitted_before: mean(&before.first).sqrt(),
        fitted_after: mean(&after.first).sqrt(),
        proven: after.beats(&before),
        by_load: by_load(belief, &windows.concat(), [believed, right]),
    })
}

/// Squared errors in units of the noise.
struct Errors {
    first: Vec<f64>,
    proof: Vec<f64>,
}

impl Errors {
    fn of(form: Form, p: &TParams<f64>, windows: &[Vec<Window>], scatter: f64) -> Self {
        let square = |w: &Window| (form.weighted(p, w) / scatter).powi(2);
        Self {
            first: windows[0].iter().map(square).collect(),
            proof: windows[1..].iter().flatten().map(square).collect(),
        }
    }

    fn held_out(&self) -> f64 {
        let of = if self.proof.is_empty() {
            &self.first
        } else {
            &self.proof
        };
        mean(of).sqrt()
    }

    fn beats(&self, other: &Self) -> bool {
        let better = |a: &[f64], b: &[f64]| {
            let gain = 1.0 - (mean(a) / mean(b)).sqrt();
            a.is_empty() || gain > PROOF.0 && wilcoxon(b, a) < PROOF.1
        };
        better(&self.first, &other.first) && better(&self.proof, &other.proof)
    }
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len().max(1) as f64
}

impl Form {
    /// `r1` over the voltage.
    fn r1(&self, p: &TParams<f64>, w: &Window) -> f64 {
        let (u, i) = (Complex64::new(w.u, 0.0), w.i);
        let axis = match self.frame {
            Frame::Voltage => Complex64::new(0.0, -1.0),
            Frame::RotorFlux => {
                let psi = rotor_flux(p, u, i, w.omega_sync);
                psi / psi.norm()
            }
        };
        let (u_dq, i_dq) = (u * axis.conj(), i * axis.conj());
        let i_f = self.constant.unwrap_or(i_dq.re);
        let r1 = p.r_a() * i_dq.im + p.l_s() * i_f * w.omega_el - u_dq.im; // (37) row 1
        r1 / w.u
    }

    /// `r1` in units of its noise.
    fn weighted(&self, p: &TParams<f64>, w: &Window) -> f64 {
        let [u, i, omega] = w.sigma;
        let current = p.r_a() * i.hypot(RELATIVE_CURRENT * w.i.norm());
        let speed = w.u / w.omega_sync * omega;
        self.r1(p, w) * w.u / u.hypot(current).hypot(speed)
    }

    /// Scatter between neighbouring windows over what the instruments' noise explains.
    fn scatter(&self, p: &TParams<f64>, windows: &[Window]) -> f64 {
        let pairs = windows.windows(2);
        let mut squares: Vec<f64> = pairs
            .map(|w| (self.weighted(p, &w[1]) - self.weighted(p, &w[0])).powi(2))
            .collect();
        squares.sort_by(f64::total_cmp);
        // The median of a squared normal variable of variance two is 0.91; load steps are in the upper half.
        (squares[squares.len() / 2] / 0.91).sqrt()
    }
}

/// Windows of steady running of a recording.
fn windows(case: &Case, belief: &Belief) -> Vec<Window> {
    if case.table.is_some() || case.speed.is_empty() {
        return Vec::new();
    }
    let rated = &belief.plant.rated;
    let n = (PERIODS * std::f64::consts::TAU / rated.omega_sync / case.t_row()).round() as usize;
    let rows = case.measured.len() / n.max(1);
    let one = |k: usize| {
        let half = |from: usize| Means::of(case, from, n / 2);
        let (a, b) = (half(k * n)?, half(k * n + n / 2)?);
        let running = a.u.norm() > 0.3 * rated.voltage && a.omega > 0.3 * rated.speed();
        (running && a.is_like(&b)).then(|| a.window(&b, case, belief, n))
    };
    (0..rows).filter_map(one).collect()
}

/// Means over half a window, in the frame of the fundamental.
struct Means {
    u: Complex64,
    i: Complex64,
    omega: f64,
    omega_sync: f64,
}

impl Means {
    /// `None` where something is not judged.
    fn of(case: &Case, from: usize, n: usize) -> Option<Self> {
        let stride = case.between.stride() * case.decimation;
        let (mut u, mut i, mut omega, mut sync) = (Complex64::ZERO, Complex64::ZERO, 0.0, 0.0);
        for row in from..from + n {
            if case.weight[row][..3].contains(&0.0) {
                return None;
            }
            let k = row * stride;
            let back = Complex64::from_polar(1.0, -case.supply.theta[k]);
            let [a, b, c, speed, _] = case.measured[row];
            u += case.supply.u_s[k] * back;
            i += clarke([a, b, c]) * back;
            omega += if case.speed_is_input {
                case.speed[k]
            } else {
                speed
            };
            sync += case.supply.omega_sync[k];
        }
        let n = n as f64;
        Some(Self {
            u: u / n,
            i: i / n,
            omega: omega / n,
            omega_sync: sync / n,
        })
    }

    fn is_like(&self, other: &Self) -> bool {
        let change = |a: Complex64, b: Complex64| (a - b).norm() / a.norm().max(b.norm());
        let turned = self.u * other.u.conj() / (self.u.norm() * other.u.norm());
        change(self.i, other.i * turned) < STEADY[0]
            && (self.u.norm() / other.u.norm() - 1.0).abs() < STEADY[1]
            && (self.omega / other.omega - 1.0).abs() < STEADY[1]
    }

    fn window(&self, other: &Self, case: &Case, belief: &Belief, n: usize) -> Window {
        let (u, i) = (0.5 * (self.u + other.u), 0.5 * (self.i + other.i));
        let axis = u / u.norm();
        let n_p = belief.plant.mechanics.n_p;
        let rows = (n as f64).sqrt();
        let of_channel = |k: usize| {
            let w = case.weight.iter().map(|w| w[k]).fold(0.0, f64::max);
            if w > 0.0 { 1.0 / w } else { 0.0 }
        };
        // Clarke's transform of three independent noises: sqrt(2/3) of one phase in each axis.
        let axis_share = (2.0f64 / 3.0).sqrt();
        Window {
            u: u.norm(),
            i: i * axis.conj(),
            omega_sync: 0.5 * (self.omega_sync + other.omega_sync),
            omega_el: n_p * 0.5 * (self.omega + other.omega),
            sigma: [
                case.input_noise.0 / rows,
                axis_share * of_channel(0) / rows,
                n_p * of_channel(3) / rows,
            ],
        }
    }
}

/// Mean squares by load, with the parameters of the motor file.
fn by_load(belief: &Belief, windows: &[Window], forms: [Form; 2]) -> Vec<FrameBand> {
    let plant = &belief.plant;
    let load = |w: &Window| {
        let psi_s =
            (Complex64::new(w.u, 0.0) - w.i * plant.motor.r_s) / Complex64::new(0.0, w.omega_sync);
        let torque = 1.5 * plant.mechanics.n_p * (psi_s.conj() * w.i).im;
        (10.0 * torque / plant.rated.torque).round() as i64 * 10
    };
    let mut groups = std::collections::BTreeMap::<i64, Vec<&Window>>::new();
    for w in windows {
        groups.entry(load(w)).or_default().push(w);
    }
    let band = |(load, group): (i64, Vec<&Window>)| {
        let rms = |form: &Form| {
            let square = |w: &&Window| form.r1(&plant.motor, w).powi(2);
            100.0 * (group.iter().map(square).sum::<f64>() / group.len() as f64).sqrt()
        };
        FrameBand {
            load_percent: load as f64,
            windows: group.len(),
            r1_before_percent: rms(&forms[0]),
            r1_after_percent: rms(&forms[1]),
        }
    };
    groups.into_iter().map(band).collect()
}

#[cfg(test)]
mod closed_form_tests {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;
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
        specimen::belief("").plant.motor
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
        let belief = specimen::belief("");
        Case::new(&specimen::recording(seconds, torque), &belief.plant.rated).expect("judged")
    }

    /// Five periods of 60 Hz are 83 ms: eleven whole windows in a second, all of them steady.
    #[test]
    fn windows_hold_the_operating_point() {
        let belief = specimen::belief("");
        let found = windows(&case(1.0, |_| 1.0), &belief);
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
        let belief = specimen::belief("");
        let steady = windows(&case(2.0, |_| 1.0), &belief).len();
        let stepped = windows(&case(2.0, |t| if t < 1.04 { 0.5 } else { 1.5 }), &belief);
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
        let belief = specimen::belief("");
        let all: Vec<&Case> = cases.iter().collect();
        judge(&specimen::motor(rest), &belief, &params(), &all)
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
}
