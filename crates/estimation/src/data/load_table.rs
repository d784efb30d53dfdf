//! Load-test tables: the same method with the steady-state equations, points instead of blocks.

use crate::data::channels::N_CHANNELS;
use crate::data::unsupported::Unsupported;
use motor::effect::{EffectConfig, Plant, Rated, SteadyPoint};
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
pub struct Point {
    voltage: f64,
    drive: Drive,
}

/// The points of a table with their measured rows: current A rms, speed rad/s, power factor, efficiency.
#[derive(Clone, Debug, Default)]
pub struct LoadPoints {
    /// What drives each point.
    pub points: Vec<Point>,
    /// Measured rows.
    pub measured: Vec<[f64; N_CHANNELS]>,
    /// One over the standard deviation; zero where not judged.
    pub weight: Vec<[f64; N_CHANNELS]>,
}

/// Prepares a table.
///
/// # Errors
/// With fewer than five points.
pub fn load_points(table: &LoadTable, rated: &Rated<f64>) -> Result<LoadPoints, Unsupported> {
    let points = table.points();
    if points.len() < 5 {
        return Err(Unsupported::new(
            format!("the load table has {} points", points.len()),
            "measure at least five loads between idling and rated load",
        ));
    }
    let mut all = LoadPoints::default();
    for p in &points {
        let Some(point) = point(p, rated) else {
            continue;
        };
        let (measured, weight) = row(p, point.drive);
        all.points.push(point);
        all.measured.push(measured);
        all.weight.push(weight);
    }
    Ok(all)
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
pub fn predict(plant: &Plant, point: &Point) -> [f64; N_CHANNELS] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;
    use motor::steady_state::SteadyState;
    use recording::TableColumn;
    use std::collections::BTreeMap;

    fn plant() -> Plant {
        specimen::prior("").plant
    }

    fn point_of(voltage: f64, drive: Drive) -> Point {
        Point { voltage, drive }
    }

    /// What the closed-form steady state says at a speed: current (A rms), power factor, efficiency, shaft torque.
    fn closed_form(plant: &Plant, voltage: f64, omega: f64) -> [f64; 4] {
        let u = Complex64::new(voltage, 0.0);
        let n_p = plant.mechanics.n_p;
        let point = SteadyState::new(&plant.motor, n_p, u, plant.rated.omega_sync).at_speed(omega);
        let shaft = point.tau_em - plant.mechanics.total_friction() * omega;
        [
            point.i_s.norm() / 2f64.sqrt(),
            point.power_factor(),
            shaft * omega / point.power_in(),
            shaft,
        ]
    }

    #[test]
    fn a_driven_speed_gives_the_closed_form_of_the_t_circuit() {
        let plant = plant();
        for (voltage, omega) in [
            (180.0, 180.0),
            (150.0, 170.0),
            (180.0, 120.0),
            (90.0, 188.0),
        ] {
            let got = predict(&plant, &point_of(voltage, Drive::Speed(omega)));
            let [current, power_factor, efficiency, _] = closed_form(&plant, voltage, omega);
            for (got, expected) in got
                .into_iter()
                .zip([current, omega, power_factor, efficiency])
            {
                assert!((got / expected - 1.0).abs() < 1e-6, "{got} {expected}");
            }
        }
    }

    /// The speed that a torque or a power asks for is on the stable branch, and gives that torque or power.
    #[test]
    fn a_torque_or_a_power_finds_its_speed() {
        let plant = plant();
        let sync = plant.rated.speed();
        for torque in [-0.5, 0.0, 0.8, 1.7, 2.5] {
            let [_, omega, ..] = predict(&plant, &point_of(180.0, Drive::Torque(torque)));
            let shaft = closed_form(&plant, 180.0, omega)[3];
            assert!((shaft - torque).abs() < 1e-6, "{shaft} {torque}");
            assert!(omega > 0.7 * sync, "{omega}");
            let [_, by_power, ..] = predict(&plant, &point_of(180.0, Drive::Power(torque * omega)));
            assert!((by_power / omega - 1.0).abs() < 1e-6, "{by_power} {omega}");
        }
    }

    /// Breakdown lies where the closed form has it, to the hundredth of synchronous speed that is tried.
    #[test]
    fn the_stable_branch_begins_at_breakdown() {
        let plant = plant();
        let u = Complex64::new(180.0, 0.0);
        let curve = SteadyState::new(&plant.motor, 2.0, u, plant.rated.omega_sync);
        let (_, slip_speed) = curve.breakdown();
        let sync = plant.rated.speed();
        let expected = sync - slip_speed / 2.0;
        let got = breakdown(&plant, 180.0, sync);
        assert!((got - expected).abs() < 0.02 * sync, "{got} {expected}");
    }

    /// An effect's torque is taken from the shaft: Coulomb friction of 0.2 N m.
    #[test]
    fn effects_act_at_every_point() {
        let mut plant = plant();
        let before = Operating::at(&plant, 180.0, 180.0);
        let coulomb = motor::effects::find("coulomb-friction", "").expect("in the library");
        let mut config = EffectConfig::absent(coulomb, &plant.rated);
        config.values[0] = 0.2;
        plant.effects.push(config);
        let after = Operating::at(&plant, 180.0, 180.0);
        assert!((before.torque - after.torque - 0.2).abs() < 1e-9);
        assert!((before.i - after.i).norm() < 1e-9);
    }

    /// Core loss draws a current in phase with the voltage behind the stator resistance; the corrected point still
    /// satisfies the T circuit.
    #[test]
    fn a_current_that_the_t_model_lacks_is_found() {
        let mut plant = plant();
        let core = motor::effects::find("core-loss", "").expect("in the library");
        let mut config = EffectConfig::absent(core, &plant.rated);
        config.values[0] = 1e-4;
        let before = Operating::at(&plant, 180.0, 188.0);
        plant.effects.push(config);
        let after = Operating::at(&plant, 180.0, 188.0);
        let watt = |at: &Operating| 1.5 * (at.u * at.i.conj()).re;
        let loss = 1.5 * 1e-4 * 180.0 * 180.0;
        // The drop over the stator resistance moves it by a few per cent.
        assert!(((watt(&after) - watt(&before)) / loss - 1.0).abs() < 0.1);
        let point = corrected(&plant, after.u, after.i, 188.0);
        assert!((circuit(&point) - point.i_s).norm() < 1e-8);
    }

    /// Without slip the rotor carries nothing; at standstill both branches are parallel.
    #[test]
    fn the_t_circuit_is_a_stator_and_two_parallel_branches() {
        let plant = plant();
        let at = |omega| corrected(&plant, Complex64::new(180.0, 0.0), Complex64::ZERO, omega);
        let (m, w) = (plant.motor, plant.rated.omega_sync);
        let stator = Complex64::new(m.r_s, w * m.l_ls);
        let magnetizing = Complex64::new(0.0, w * m.l_m);
        let rotor = Complex64::new(m.r_r, w * m.l_lr);
        let idle = 180.0 / (stator + magnetizing);
        assert!((circuit(&at(plant.rated.speed())) - idle).norm() < 1e-9);
        let stalled = 180.0 / (stator + magnetizing * rotor / (magnetizing + rotor));
        assert!((circuit(&at(0.0)) - stalled).norm() < 1e-9);
    }

    fn table(columns: &[(TableColumn, &[f64])]) -> LoadTable {
        let columns: BTreeMap<_, _> = columns.iter().map(|(c, x)| (*c, x.to_vec())).collect();
        LoadTable::new("table", columns).expect("a valid table")
    }

    #[test]
    fn a_table_becomes_points_with_rows_and_weights() {
        use TableColumn::{Current, Efficiency, Power, PowerFactor, Speed, Voltage};
        let table = table(&[
            (Power, &[0.0, 75.0, 150.0, 225.0, 300.0]),
            (Current, &[0.8, 0.9, 1.0, 1.1, 1.3]),
            (Speed, &[1795.0, 1770.0, 1745.0, 1715.0, 1680.0]),
            (PowerFactor, &[0.2, 0.4, 0.55, 0.65, 0.75]),
            (Efficiency, &[0.0, 0.5, 0.65, 0.7, 0.75]),
            (Voltage, &[220.0, 220.0, 210.0, 220.0, 220.0]),
        ]);
        let all = load_points(&table, &plant().rated).expect("five points");
        let (points, measured, weight) = (all.points, all.measured, all.weight);
        assert_eq!((points.len(), measured.len(), weight.len()), (5, 5, 5));
        assert_eq!(points[2].drive, Drive::Power(150.0));
        assert!((points[2].voltage - 210.0 * (2.0f64 / 3.0).sqrt()).abs() < 1e-9);
        assert_eq!(measured[2][0], 1.0);
        assert!((measured[2][1] - 1745.0 * std::f64::consts::TAU / 60.0).abs() < 1e-9);
        assert_eq!(measured[2][2..], [0.55, 0.65, 0.0]);
        // Half a per cent of the current, one revolution per minute, half a point of power factor and efficiency.
        let sigma = weight[2].map(|w| 1.0 / w);
        assert!((sigma[0] - 0.005).abs() < 1e-12);
        assert!((sigma[1] - std::f64::consts::TAU / 60.0).abs() < 1e-12);
        assert!((sigma[2] - 0.005).abs() < 1e-12 && (sigma[3] - 0.005).abs() < 1e-12);
        assert_eq!(weight[2][4], 0.0);
        // No efficiency is judged where no power leaves the shaft.
        assert_eq!(weight[0][3], 0.0);
    }

    #[test]
    fn fewer_than_five_points_are_refused() {
        use TableColumn::{Current, Power, Speed};
        let few = table(&[
            (Power, &[0.0, 100.0, 200.0, 300.0]),
            (Current, &[0.8, 0.9, 1.0, 1.3]),
            (Speed, &[1795.0, 1760.0, 1725.0, 1680.0]),
        ]);
        let refused = load_points(&few, &plant().rated).expect_err("too few");
        assert!(refused.reason.contains("4 points"), "{}", refused.reason);
    }

    /// A speed that drives the point is no measurement of it.
    #[test]
    fn power_drives_before_torque_and_torque_before_speed() {
        let point = |power_watt, torque_nm, speed_rpm| LoadPoint {
            power_watt,
            torque_nm,
            speed_rpm,
            ..LoadPoint::default()
        };
        assert_eq!(
            drive(&point(Some(5.0), Some(2.0), Some(60.0))),
            Some(Drive::Power(5.0))
        );
        assert_eq!(
            drive(&point(None, Some(2.0), Some(60.0))),
            Some(Drive::Torque(2.0))
        );
        let Some(Drive::Speed(omega)) = drive(&point(None, None, Some(60.0))) else {
            panic!("the speed is all there is")
        };
        assert!((omega - std::f64::consts::TAU).abs() < 1e-12);
        assert_eq!(drive(&point(None, None, None)), None);
        let (_, weight) = row(&point(None, None, Some(60.0)), Drive::Speed(omega));
        assert_eq!(weight, [0.0; N_CHANNELS]);
    }

    #[test]
    fn a_point_without_voltage_has_the_rated_one() {
        let rated = plant().rated;
        let bare = LoadPoint {
            torque_nm: Some(1.0),
            ..LoadPoint::default()
        };
        assert_eq!(point(&bare, &rated).map(|p| p.voltage), Some(rated.voltage));
        assert_eq!(point(&LoadPoint::default(), &rated), None);
    }

    #[test]
    fn the_values_of_a_table_are_those_of_its_points() {
        use TableColumn::{Current, Speed, Torque};
        let table = table(&[
            (Torque, &[0.5, 1.0]),
            (Current, &[0.9, 1.0]),
            (Speed, &[1780.0, 1750.0]),
        ]);
        let plant = plant();
        let values = table_values(&table, &plant);
        assert_eq!(values.len(), 2);
        let [_, omega, ..] = values[1].expect("a torque and a speed");
        // Torque and speed of a point make its power, which drives it.
        let power = 1.0 * 1750.0 * RPM;
        let shaft = closed_form(&plant, plant.rated.voltage, omega)[3];
        assert!((shaft * omega / power - 1.0).abs() < 1e-6, "{shaft}");
    }
}
