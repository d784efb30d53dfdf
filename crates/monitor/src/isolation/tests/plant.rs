//! A motor in steady state seen through six channels, and a monitor that believes in the healthy one.

use motor::TParams;
use motor::steady_state::{OperatingPoint, SteadyState};
use num_complex::{Complex32, Complex64};

use crate::checks::sensors::Phase;
use crate::config::{LoadKind, MonitorConfig};
use crate::input::sample::CHANNELS;
use crate::isolation::{Healthy, ROWS, Uncertainty};
pub use crate::tests::motor_2200_watt::OMEGA_SYNC;
use crate::tests::motor_2200_watt::{self, AMPLITUDE, FRICTION, PARAMS};
use crate::window::Window;
use crate::{Evidence, Monitor};
use frames::Sequence;

/// The difference between two perfect descriptions of one motor.
#[derive(Clone, Copy, Debug)]
pub struct Plant {
    pub params: TParams<f64>,
    /// `B + B_l`, N m s.
    pub friction: f64,
    /// Voltages a, b, c, then currents.
    pub gains: [f64; CHANNELS],
    pub speed_gain: f64,
    /// Ohm in series with each phase, behind the voltage probes.
    pub series: [f64; 3],
    /// Current through shorted turns of each phase in phase with its voltage, as a share of the motor's current.
    pub shorted: [f64; 3],
    /// Angle by which that current lags, rad.
    pub lag: f64,
    /// Displacement of the supply's neutral, against which voltages are measured, as a share of the voltage.
    pub neutral: Complex64,
    /// Negative over positive sequence of the supply.
    pub unbalance: Complex64,
}

impl Plant {
    /// A 2.2 kW motor at two thirds of its torque.
    pub fn healthy() -> Self {
        Plant {
            params: PARAMS,
            friction: FRICTION,
            gains: [1.0; CHANNELS],
            speed_gain: 1.0,
            series: [0.0; 3],
            shorted: [0.0; 3],
            lag: 0.0,
            neutral: Complex64::ZERO,
            unbalance: Complex64::ZERO,
        }
    }

    fn curve(&self) -> SteadyState<f64> {
        let mut params = self.params;
        params.r_s += self.series.iter().sum::<f64>() / 3.0;
        SteadyState::new(&params, 2.0, Complex64::new(AMPLITUDE, 0.0), OMEGA_SYNC)
    }

    /// A third of a resistance in one phase acts on the positive sequence; what the negative sequence gives back to it is
    /// of second order.
    pub fn point(&self) -> OperatingPoint<f64> {
        self.curve().at_friction(self.friction)
    }

    /// What the negative sequence meets, ohm.
    pub fn negative_impedance(&self, point: &OperatingPoint<f64>) -> Complex64 {
        let backwards = OMEGA_SYNC + point.omega_el;
        point.u_s / self.curve().at_slip_speed(backwards).i_s
    }

    /// Phase currents, A.
    fn currents(&self, point: &OperatingPoint<f64>) -> [Complex64; 3] {
        let mut currents = phases(point.i_s);
        let impedance = self.negative_impedance(point);
        let supplied = AMPLITUDE * self.unbalance / impedance;
        for (m, current) in currents.iter_mut().enumerate() {
            *current += supplied * TURN.powi(m as i32);
        }
        for (k, r) in self.series.iter().enumerate() {
            // The unbalanced drop drives a current of negative sequence through the motor.
            let drop = r / 3.0 * currents[k] * TURN.powi(2 * k as i32);
            let negative = -drop / impedance;
            for (m, current) in currents.iter_mut().enumerate() {
                *current += negative * TURN.powi(m as i32);
            }
        }
        let voltages = phases(point.u_s);
        for (k, share) in self.shorted.iter().enumerate() {
            let lagging = Complex64::cis(-self.lag);
            let shunt = voltages[k] / AMPLITUDE * point.i_s.norm() * *share * lagging;
            currents[k] += shunt;
            // Three wires carry no zero sequence.
            currents
                .iter_mut()
                .for_each(|current| *current -= shunt / 3.0);
        }
        currents
    }

    pub fn window(&self) -> Window {
        let point = self.point();
        let displaced = phases(point.u_s).map(|u| u + AMPLITUDE * self.neutral);
        let of_phase = |m: usize| AMPLITUDE * self.unbalance * TURN.powi(m as i32);
        let [ua, ub, uc] = [0, 1, 2].map(|m| displaced[m] + of_phase(m));
        let [ia, ib, ic] = self.currents(&point);
        let mut channels = [ua, ub, uc, ia, ib, ic];
        for (x, gain) in channels.iter_mut().zip(self.gains) {
            *x *= gain;
        }
        let single = channels.map(|x| Complex32::new(x.re as f32, x.im as f32));
        let [ua, ub, uc, ia, ib, ic] = single;
        Window {
            u_s: Sequence::from_phases([ua, ub, uc]),
            i_s: Sequence::from_phases([ia, ib, ic]),
            omega_sync: OMEGA_SYNC as f32,
            omega_mech: Some((point.omega_mech * self.speed_gain) as f32),
            span: 0.08,
            ..Window::default()
        }
    }
}

/// `e^{j 2 pi / 3}`.
const TURN: Complex64 = Complex64::new(-0.5, 0.866_025_403_784_438_6);

fn phases(positive: Complex64) -> [Complex64; 3] {
    [positive, positive * TURN.conj(), positive * TURN]
}

/// Statistics of a careful calibration: the defaults of the motor file, and a noise of 0.05 % in every row.
pub fn statistics() -> Healthy {
    Healthy {
        mean: [0.0; ROWS],
        scatter: [5e-4; ROWS],
        current_unbalance: [0.0; 2],
        current_unbalance_at: 0.0,
        negative_drop: [0.0; 2],
        current_unbalance_scatter: 5e-4,
        turns_axis: [0.342, 0.94],
        uncertainty: Uncertainty {
            stator_resistance: 0.01,
            rotor_resistance: 0.01,
            heating: 0.3,
            magnetizing_inductance: 0.002,
            leakage: 0.005,
            friction: 0.02,
            current_gain: 0.002,
            voltage_gain: 0.002,
            speed: 1e-4,
            iron_loss: 0.015,
            supply_unbalance: 0.002,
            negative_impedance: 0.1,
        },
        range: None,
        significance: 5.5,
        in_motion: motor::InMotion::Unseen,
    }
}

/// A monitor of the healthy motor.
pub fn monitor() -> Monitor {
    Monitor::new(config()).expect("a valid motor")
}

fn config() -> MonitorConfig {
    MonitorConfig {
        healthy: Some(statistics()),
        ..motor_2200_watt::config()
    }
}

/// What the monitor of the healthy motor makes of a plant.
pub fn evidence(plant: &Plant) -> Evidence {
    evidence_by(plant, &statistics())
}

/// The same beside other statistics.
pub fn evidence_by(plant: &Plant, healthy: &Healthy) -> Evidence {
    monitor()
        .evidence(healthy, &plant.window())
        .expect("voltages, currents and speed are there")
}

/// What a monitor that knows no load makes of it.
pub fn evidence_of_any_load(plant: &Plant) -> Evidence {
    let free = MonitorConfig {
        load: LoadKind::Free,
        ..config()
    };
    let monitor = Monitor::new(free).expect("a valid motor");
    let evidence = monitor.evidence(&statistics(), &plant.window());
    evidence.expect("voltages, currents and speed are there")
}

/// Index of a phase in arrays over a, b, c.
pub fn index(phase: Phase) -> usize {
    phase as usize
}
