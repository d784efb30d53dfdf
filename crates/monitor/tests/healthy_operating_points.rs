//! Every healthy steady operating point leaves the rotor-flux residuals at zero, from samples to report.
//!
//! Oracle: the closed-form steady state of the T model in f64 (crate `motor`, tested on its own).

use std::f64::consts::TAU;

use monitor::{
    Abc, ComparatorConfig, Converter, FieldCurrent, Frame, LoadKind, Monitor, MonitorConfig,
    MonitorState, ParameterDoubt, RawSample, Report, Sample, SpeedSample,
};
use motor::steady_state::{OperatingPoint, SteadyState};
use motor::{Mechanics, TParams};
use num_complex::Complex64;
use proptest::prelude::*;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

const T_SAMPLE: f64 = 1e-4;

/// A motor, its supply and its friction load.
#[derive(Clone, Debug)]
struct Machine {
    params: TParams<f64>,
    mechanics: Mechanics<f64>,
    amplitude: f64,
    omega_sync: f64,
}

impl Machine {
    fn curve(&self) -> SteadyState<f64> {
        let supply = Complex64::new(self.amplitude, 0.0);
        SteadyState::new(&self.params, self.mechanics.n_p, supply, self.omega_sync)
    }

    fn point(&self) -> OperatingPoint<f64> {
        self.curve().at_friction(self.mechanics.total_friction())
    }

    /// A motor that its load holds beyond breakdown is stalled, not healthy.
    fn runs(&self) -> bool {
        let (_, breakdown_slip) = self.curve().breakdown();
        self.point().omega_slip < breakdown_slip
    }

    fn config(&self) -> MonitorConfig {
        let point = self.point();
        let single = |x: f64| x as f32;
        MonitorConfig {
            t_sample: T_SAMPLE as f32,
            converter: Converter::bipolar(
                single(1.5 * self.amplitude),
                single(3.0 * point.i_s.norm()),
                12,
            ),
            encoder_counts_per_revolution: 4096.0,
            params: TParams {
                r_s: single(self.params.r_s),
                r_r: single(self.params.r_r),
                l_ls: single(self.params.l_ls),
                l_lr: single(self.params.l_lr),
                l_m: single(self.params.l_m),
            },
            laws: Default::default(),
            effects: Default::default(),
            channel_gain: [1.0; 6],
            mechanics: Mechanics {
                n_p: single(self.mechanics.n_p),
                inertia: single(self.mechanics.inertia),
                friction: single(self.mechanics.friction),
                load_friction: single(self.mechanics.load_friction),
            },
            rated_voltage: single(self.amplitude),
            rated_current: single(point.i_s.norm()),
            rated_omega: single(self.omega_sync),
            rated_torque: single(point.tau_em),
            frame: Frame::RotorFlux,
            field: FieldCurrent::Live,
            load: LoadKind::Friction,
            thresholds: [0.006, 0.03, 0.04, 0.003],
            window_cycles: 5,
            comparator: ComparatorConfig {
                persistence: 3,
                hysteresis: 0.8,
            },
            healthy: None,
            cage: monitor::Cage::UNKNOWN,
            doubt: ParameterDoubt::default(),
        }
    }
}

fn phases(x: Complex64) -> [f64; 3] {
    [0.0, -TAU / 3.0, TAU / 3.0].map(|shift| (x * Complex64::from_polar(1.0, shift)).re)
}

/// The last report of `seconds` of ideal samples.
fn last_report(machine: &Machine, seconds: f64) -> Report {
    let monitor =
        Monitor::new(machine.config()).expect("a physical machine is a valid configuration");
    let mut state = MonitorState::default();
    let point = machine.point();
    let mut last = Report::default();
    for k in 0..(seconds / T_SAMPLE) as u64 {
        let turn = Complex64::from_polar(1.0, machine.omega_sync * k as f64 * T_SAMPLE);
        let single = |x: Complex64| Some(Abc::from_array(phases(x * turn).map(|x| x as f32)));
        let sample = Sample {
            u_s_abc: single(point.u_s),
            i_s_abc: single(point.i_s),
            speed: SpeedSample::RadPerSecond(point.omega_mech as f32),
            ..Sample::default()
        };
        last = monitor.update(&mut state, &sample).unwrap_or(last);
    }
    last
}

/// Parameters relative to the impedance base, over what motors from 0.1 to 100 kW have.
fn machines() -> impl Strategy<Value = Machine> {
    let supply = (5.0..100.0_f64, 10.0..400.0_f64, 0.5..50.0_f64);
    let per_unit = (
        0.005..0.1_f64,
        0.005..0.08_f64,
        0.04..0.15_f64,
        0.04..0.15_f64,
        1.0..4.0_f64,
    );
    let mechanics = (1_u8..=4, 0.05..1.5_f64, 0.1..1.0_f64);
    (supply, per_unit, mechanics).prop_map(|(supply, per_unit, mechanics)| {
        let (hertz, volt_at_50, amp) = supply;
        let (r_s, r_r, x_ls, x_lr, x_m) = per_unit;
        let (n_p, load, motor_share) = mechanics;
        let omega_sync = TAU * hertz;
        let amplitude = volt_at_50 * hertz / 50.0;
        let ohm = volt_at_50 / amp;
        let henry = ohm / (TAU * 50.0);
        let n_p = f64::from(n_p);
        let rated_torque = 1.5 * volt_at_50 * amp * n_p / (TAU * 50.0);
        let b_t = load * rated_torque * n_p / (TAU * 50.0);
        Machine {
            params: TParams {
                r_s: r_s * ohm,
                r_r: r_r * ohm,
                l_ls: x_ls * henry,
                l_lr: x_lr * henry,
                l_m: x_m * henry,
            },
            mechanics: Mechanics {
                n_p,
                inertia: 0.1 * rated_torque * n_p / (TAU * 50.0),
                friction: motor_share * b_t,
                load_friction: (1.0 - motor_share) * b_t,
            },
            amplitude,
            omega_sync,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn residuals_of_a_healthy_motor_are_zero(machine in machines()) {
        prop_assume!(machine.runs());
        // Twelve cycles lock, five fill the window.
        let report = last_report(&machine, 24.0 * TAU / machine.omega_sync);
        prop_assert_eq!(report.not_judged, None);
        let residuals = report.residuals.unwrap_or_default();
        // 0.05 % of scale: a tenth of the smallest threshold in use (r1 0.6 %, r4 0.3 %).
        for r in residuals.r {
            prop_assert!(r.abs() < 5e-4, "{:?}", residuals);
        }
        prop_assert!(residuals.e_d.abs() < 5e-4 && residuals.e_q.abs() < 5e-4, "{:?}", residuals);
        prop_assert!(report.lamps.is_quiet());
    }
}

/// The assumed 300 W motor of the published bench, with its friction load.
fn bench_motor() -> Machine {
    Machine {
        params: TParams {
            r_s: 8.0,
            r_r: 7.0,
            l_ls: 0.028,
            l_lr: 0.028,
            l_m: 0.42,
        },
        mechanics: Mechanics {
            n_p: 2.0,
            inertia: 0.002,
            friction: 0.0008,
            load_friction: 0.0035,
        },
        amplitude: 179.6,
        omega_sync: TAU * 60.0,
    }
}

/// What the board sees: 12-bit codes with 0.2 % noise and a 1024-pulse encoder.
struct Board {
    converter: Converter,
    noise: Normal<f64>,
    rng: Pcg64Mcg,
}

impl Board {
    fn code(&mut self, value: f64, unit_per_code: f32, full_scale_codes: f64) -> u16 {
        let noisy =
            value / f64::from(unit_per_code) + self.noise.sample(&mut self.rng) * full_scale_codes;
        (noisy + full_scale_codes)
            .round()
            .clamp(0.0, 2.0 * full_scale_codes - 1.0) as u16
    }

    fn sample(&mut self, u: [f64; 3], i: [f64; 3], shaft_angle: f64) -> RawSample {
        let (volt, amp) = (
            self.converter.voltage.unit_per_code,
            self.converter.current.unit_per_code,
        );
        RawSample {
            voltage_codes: u.map(|u| self.code(u, volt, 2048.0)),
            current_codes: i.map(|i| self.code(i, amp, 2048.0)),
            encoder_count: (shaft_angle / TAU * 4096.0).floor() as i64 as u16,
            ..RawSample::default()
        }
    }
}

/// Scatter of the residuals through codes and encoder: the ground on which thresholds stand.
#[test]
fn scatter_through_adc_and_encoder_stays_far_below_the_thresholds() {
    let machine = bench_motor();
    let config = machine.config();
    let monitor = Monitor::new(config).expect("valid");
    let mut state = MonitorState::default();
    let mut board = Board {
        converter: config.converter,
        noise: Normal::new(0.0, 0.002).expect("a valid deviation"),
        rng: Pcg64Mcg::seed_from_u64(7),
    };
    let point = machine.point();
    let mut windows: Vec<[f64; 6]> = Vec::new();
    for k in 0..100_000_u32 {
        let t = f64::from(k) * T_SAMPLE;
        let turn = Complex64::from_polar(1.0, machine.omega_sync * t);
        let raw = board.sample(
            phases(point.u_s * turn),
            phases(point.i_s * turn),
            point.omega_mech * t,
        );
        let report = monitor
            .update_raw(&mut state, &raw)
            .filter(Report::is_judged);
        if let Some(residuals) = report.and_then(|report| report.residuals) {
            let [r1, r2, r3, r4] = residuals.r;
            windows.push([r1, r2, r3, r4, residuals.e_d, residuals.e_q].map(f64::from));
        }
        if let Some(report) = report {
            assert!(report.lamps.is_quiet());
        }
    }
    assert!(
        windows.len() > 550,
        "10 s of 60 Hz, less locking: {}",
        windows.len()
    );
    for (name, column) in ["r1", "r2", "r3", "r4", "e_d", "e_q"].iter().zip(0..) {
        let n = windows.len() as f64;
        let mean = windows.iter().map(|w| w[column]).sum::<f64>() / n;
        let sigma = (windows
            .iter()
            .map(|w| (w[column] - mean).powi(2))
            .sum::<f64>()
            / n)
            .sqrt();
        println!(
            "{name}: mean {:+.4} %, scatter {:.4} % of scale",
            100.0 * mean,
            100.0 * sigma
        );
        if let Some(threshold) = config.thresholds.get(column) {
            let worst = mean.abs() + 6.0 * sigma;
            assert!(
                worst < f64::from(*threshold),
                "{name}: mean + 6 sigma = {worst}"
            );
        }
    }
}
