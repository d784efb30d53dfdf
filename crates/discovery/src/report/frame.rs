//! The monitor's own model against the recording: does its frame hold at every load?
//!
//! The published instrument puts the voltage on the q axis, but (13)-(29) hold in the rotor-flux frame (Energies 2022,
//! 15(22), 8372; docs/theory.md). The first residual of (37) over windows of steady running tells: with parameters that
//! explain currents and speed it stays near zero in the right frame and grows with the load in the wrong one.

use crate::report::types::{FrameBand, FrameReport};
use estimation::data::case::{Case, RELATIVE_CURRENT, Waveform};
use estimation::model::prior::Prior;
use estimation::proof::pairs::wilcoxon;
use motor::dynamic::clarke;
use motor::motor_file::{FieldCurrent, Frame};
use motor::steady_state::rotor_flux;
use motor::{MotorFile, TParams};
use num_complex::Complex64;

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

/// Judges the frame of a motor file with parameters `fitted` to currents and speed; `None` if it already is the right
/// frame or too little runs steadily.
pub(crate) fn judge(
    motor: &MotorFile,
    prior: &Prior,
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
    let windows: Vec<Vec<Window>> = cases.iter().map(|c| windows(c, prior)).collect();
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
        by_load: by_load(prior, &windows.concat(), [believed, right]),
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
fn windows(case: &Case, prior: &Prior) -> Vec<Window> {
    let with_speed = case.waveform().filter(|one| !one.speed.is_empty());
    let Some(waveform) = with_speed else {
        return Vec::new();
    };
    let rated = &prior.plant.rated;
    let n =
        (PERIODS * std::f64::consts::TAU / rated.omega_sync / waveform.t_row()).round() as usize;
    let rows = waveform.measured.len() / n.max(1);
    let one = |k: usize| {
        let half = |from: usize| Means::of(waveform, from, n / 2);
        let (a, b) = (half(k * n)?, half(k * n + n / 2)?);
        let running = a.u.norm() > 0.3 * rated.voltage && a.omega > 0.3 * rated.speed();
        (running && a.is_like(&b)).then(|| a.window(&b, waveform, prior, n))
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
    fn of(waveform: &Waveform, from: usize, n: usize) -> Option<Self> {
        let stride = waveform.samples_per_row();
        let (mut u, mut i, mut omega, mut sync) = (Complex64::ZERO, Complex64::ZERO, 0.0, 0.0);
        for row in from..from + n {
            if waveform.weight[row][..3].contains(&0.0) {
                return None;
            }
            let k = row * stride;
            let back = Complex64::from_polar(1.0, -waveform.supply.theta[k]);
            let [a, b, c, speed, _] = waveform.measured[row];
            u += waveform.supply.u_s[k] * back;
            i += clarke([a, b, c]) * back;
            omega += if waveform.speed_is_input {
                waveform.speed[k]
            } else {
                speed
            };
            sync += waveform.supply.omega_sync[k];
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

    fn window(&self, other: &Self, waveform: &Waveform, prior: &Prior, n: usize) -> Window {
        let (u, i) = (0.5 * (self.u + other.u), 0.5 * (self.i + other.i));
        let axis = u / u.norm();
        let n_p = prior.plant.mechanics.n_p;
        let rows = (n as f64).sqrt();
        let of_channel = |k: usize| {
            let w = waveform.weight.iter().map(|w| w[k]).fold(0.0, f64::max);
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
                waveform.input_noise.voltage / rows,
                axis_share * of_channel(0) / rows,
                n_p * of_channel(3) / rows,
            ],
        }
    }
}

/// Mean squares by load, with the parameters of the motor file.
fn by_load(prior: &Prior, windows: &[Window], forms: [Form; 2]) -> Vec<FrameBand> {
    let plant = &prior.plant;
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
mod closed_form_tests;

#[cfg(test)]
mod tests;
