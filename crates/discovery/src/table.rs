//! Load-test tables: the same method with the steady-state equations, points instead of blocks.

use crate::case::{N_CHANNELS, Unsupported};
use motor::effects::{EffectConfig, Plant, Rated, SteadyPoint};
use num_complex::Complex64;
use recording::{LoadPoint, LoadTable};

/// Accuracy of a table: half a per cent of the current, ...
const CURRENT: f64 = 0.005;
/// ... one revolution per minute, ...
const SPEED_RPM: f64 = 1.0;
/// ... and half a point of power factor and of efficiency.
const SHARE: f64 = 0.005;
/// Radians per second in one revolution per minute.
const RPM: f64 = std::f64::consts::TAU / 60.0;

/// What a point of a table is driven by.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drive {
    /// Shaft power, W.
    Power(f64),
    /// Shaft torque, N m.
    Torque(f64),
    /// Speed, rad/s.
    Speed(f64),
}

/// One point: what drives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    voltage: f64,
    drive: Drive,
}

/// Points with their measured rows (current A rms, speed rad/s, power factor, efficiency) and weights.
pub(crate) type Rows = (Vec<Point>, Vec<[f64; N_CHANNELS]>, Vec<[f64; N_CHANNELS]>);

/// Prepares a table.
///
/// # Errors
/// With fewer than five points.
pub(crate) fn rows(table: &LoadTable, rated: &Rated<f64>) -> Result<Rows, Unsupported> {
    let points = table.points();
    if points.len() < 5 {
        return Err(Unsupported::new(
            format!("the load table has {} points", points.len()),
            "measure at least five loads between idling and rated load",
        ));
    }
    let mut out: Rows = Default::default();
    for p in &points {
        let Some(point) = point(p, rated) else {
            continue;
        };
        out.0.push(point);
        let (measured, weight) = row(p, point.drive);
        out.1.push(measured);
        out.2.push(weight);
    }
    Ok(out)
}

/// What a plant would show at each point of a table: line current (A rms), speed (rad/s), power factor, efficiency.
/// `None` for a point without power, torque and speed.
pub fn table_values(table: &LoadTable, plant: &Plant) -> Vec<Option<[f64; 4]>> {
    let values = |p: &LoadPoint| {
        let [current, speed, power_factor, efficiency, _] =
            predict(plant, &point(p, &plant.rated)?);
        Some([current, speed, power_factor, efficiency])
    };
    table.points().iter().map(values).collect()
}

fn point(p: &LoadPoint, rated: &Rated<f64>) -> Option<Point> {
    let voltage = p.voltage_line_rms_volt;
    Some(Point {
        voltage: voltage.map_or(rated.voltage, |u| u * (2.0f64 / 3.0).sqrt()),
        drive: drive(p)?,
    })
}

fn drive(p: &LoadPoint) -> Option<Drive> {
    let torque = p.torque_nm.map(Drive::Torque);
    let power = p.power_watt.map(Drive::Power);
    let speed = p.speed_rpm.map(|n| Drive::Speed(n * RPM));
    power.or(torque).or(speed)
}

fn row(p: &LoadPoint, drive: Drive) -> ([f64; N_CHANNELS], [f64; N_CHANNELS]) {
    let driven = matches!(drive, Drive::Speed(_));
    let one = |x: Option<f64>, sigma: f64| x.map_or((0.0, 0.0), |x| (x, 1.0 / sigma));
    let i = one(
        p.current_rms_amp,
        CURRENT * p.current_rms_amp.unwrap_or(1.0),
    );
    let w = one(
        p.speed_rpm.filter(|_| !driven).map(|n| n * RPM),
        SPEED_RPM * RPM,
    );
    let pf = one(p.power_factor, SHARE);
    // Efficiency says nothing at idle, where it is zero by definition.
    let eta = one(p.efficiency.filter(|&x| x > 0.0), SHARE);
    let all = [i, w, pf, eta, (0.0, 0.0)];
    (all.map(|x| x.0), all.map(|x| x.1))
}

/// Model values of one point: current A rms, speed rad/s, power factor, efficiency.
pub(crate) fn predict(plant: &Plant, point: &Point) -> [f64; N_CHANNELS] {
    let n_p = plant.mechanics.n_p;
    let sync = plant.rated.omega_sync / n_p;
    let omega = match point.drive {
        Drive::Speed(omega) => omega,
        Drive::Power(power) => speed_at(plant, point.voltage, sync, |omega| power / omega),
        Drive::Torque(torque) => speed_at(plant, point.voltage, sync, |_| torque),
    };
    let at = Operating::at(plant, point.voltage, omega);
    let apparent = (at.u * at.i.conj()).norm().max(f64::MIN_POSITIVE);
    let input = (at.u * at.i.conj()).re;
    let output = at.torque * omega / 1.5;
    [
        at.i.norm() / std::f64::consts::SQRT_2,
        omega,
        input / apparent,
        output / input,
        0.0,
    ]
}

/// Speed between half and full synchronous speed at which the shaft torque is `load(omega)`, rad/s.
fn speed_at(plant: &Plant, voltage: f64, sync: f64, load: impl Fn(f64) -> f64) -> f64 {
    let excess = |omega: f64| Operating::at(plant, voltage, omega).torque - load(omega);
    let (mut low, mut high) = (breakdown(plant, voltage, sync), 1.05 * sync);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Speed of the largest torque, rad/s: the stable branch lies above it.
fn breakdown(plant: &Plant, voltage: f64, sync: f64) -> f64 {
    let speed = |k: usize| sync * (1.0 - 0.01 * k as f64);
    let torque = |k: usize| Operating::at(plant, voltage, speed(k)).torque;
    let best = (1..60).max_by(|&a, &b| torque(a).total_cmp(&torque(b)));
    speed(best.unwrap_or(20))
}

/// An operating point of a plant with effects.
struct Operating {
    u: Complex64,
    i: Complex64,
    torque: f64,
}

impl Operating {
    /// Terminal current and shaft torque at a speed: the current for which the corrected point satisfies
    /// the T circuit.
    fn at(plant: &Plant, voltage: f64, omega_mech: f64) -> Self {
        let u = Complex64::new(voltage, 0.0);
        let mut i = Complex64::ZERO;
        let mut point = corrected(plant, u, i, omega_mech);
        for _ in 0..40 {
            let step = circuit(&point) - point.i_s;
            i += step;
            point = corrected(plant, u, i, omega_mech);
            if step.norm() < 1e-10 * plant.rated.current {
                break;
            }
        }
        let psi_s =
            (point.u_s - point.i_s * point.motor.r_s) / Complex64::new(0.0, point.omega_sync);
        let tau = 1.5 * plant.mechanics.n_p * (psi_s.conj() * point.i_s).im;
        Self {
            u,
            i,
            torque: tau - plant.mechanics.total_friction() * omega_mech - point.tau_extra,
        }
    }
}

fn corrected(plant: &Plant, u: Complex64, i: Complex64, omega_mech: f64) -> SteadyPoint<f64> {
    let mut point = SteadyPoint {
        rated: plant.rated,
        omega_sync: plant.rated.omega_sync,
        omega_mech,
        u_s: u,
        i_s: i,
        motor: plant.motor,
        tau_extra: 0.0,
    };
    let apply = |c: &EffectConfig, point: &mut SteadyPoint<f64>| {
        c.effect.correct_f64(&c.values, point);
    };
    plant.effects.iter().for_each(|c| apply(c, &mut point));
    point
}

/// Stator current of the T circuit at a corrected point.
fn circuit(point: &SteadyPoint<f64>) -> Complex64 {
    let (m, w) = (&point.motor, point.omega_sync);
    let slip = point.slip();
    // Rotor branch as an admittance, finite at synchronous speed.
    let rotor = slip / Complex64::new(m.r_r, slip * w * m.l_lr);
    let magnetizing = Complex64::new(0.0, -1.0 / (w * m.l_m));
    point.u_s / (Complex64::new(m.r_s, w * m.l_ls) + 1.0 / (rotor + magnetizing))
}
