//! Direct-on-line start of the 2.2 kW machine, rated load at 1 s, voltages held over 100 us: the equivalence case.

use flate2::read::GzDecoder;
use motor::dynamic::{Dynamic, DynamicState};
use motor::{Mechanics, TParams};
use num_complex::Complex64;
use std::fs::File;

/// Step of the solver and hold time of the voltages, s.
pub const STEP_S: f64 = 1e-4;

/// What is held during one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Stator voltage, V.
    pub u_s: Complex64,
    /// Load torque, N m.
    pub tau_load: f64,
}

/// Stator current and speed before a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Stator current, A.
    pub i_s: Complex64,
    /// Shaft speed, mechanical rad/s.
    pub omega_mech: f64,
}

/// The case: machine and what is held in each step.
#[derive(Clone, Debug)]
pub struct Case {
    /// Electrical parameters.
    pub params: TParams<f64>,
    /// Mechanical parameters.
    pub mechanics: Mechanics<f64>,
    /// One entry per step.
    pub rows: Vec<Held>,
}

impl Case {
    /// The case as the equivalence test of crate `motor` has it.
    ///
    /// # Panics
    /// When the file that is part of the source tree cannot be read.
    pub fn read() -> Case {
        let path = format!(
            "{}/../crates/motor/tests/data/dol_start_rated_step.csv.gz",
            crate::FOLDER
        );
        let file = File::open(&path).expect("part of the source tree");
        let mut table = csv::Reader::from_reader(GzDecoder::new(file));
        let rows = table
            .records()
            .map(|row| held(&row.expect("a complete row")))
            .collect();
        Case {
            params: TParams {
                r_s: 3.7,
                r_r: 2.296875,
                l_ls: 0.010735192570458851,
                l_lr: 0.010735192570458851,
                l_m: 0.23426480742954114,
            },
            mechanics: Mechanics {
                n_p: 2.0,
                inertia: 0.015,
                friction: 0.0,
                load_friction: 0.0,
            },
            rows,
        }
    }

    /// Simulated time of one pass, s.
    pub fn duration(&self) -> f64 {
        self.rows.len() as f64 * STEP_S
    }

    /// One start from rest; the state after the last step.
    #[inline(never)]
    pub fn run(&self, motor: &Dynamic) -> DynamicState {
        let mut state = DynamicState::rest();
        for row in &self.rows {
            advance(motor, &mut state, row);
        }
        state
    }

    /// The whole start.
    pub fn trajectory(&self, motor: &Dynamic) -> Vec<Instant> {
        let mut state = DynamicState::rest();
        let mut instant = |row: &Held| {
            let instant = Instant {
                i_s: motor.current(0.0, &state, row.u_s),
                omega_mech: state.omega_mech,
            };
            advance(motor, &mut state, row);
            instant
        };
        self.rows.iter().map(&mut instant).collect()
    }
}

/// What is held does not depend on time, so the time of the step does not matter.
#[inline(always)]
fn advance(motor: &Dynamic, state: &mut DynamicState, row: &Held) {
    motor.step(state, 0.0, STEP_S, |_| row.u_s, |_, _| row.tau_load);
}

fn held(row: &csv::StringRecord) -> Held {
    let number = |k: usize| row[k].parse::<f64>().expect("a number");
    Held {
        u_s: Complex64::new(number(1), number(2)),
        tau_load: number(3),
    }
}

/// Largest difference of two trajectories, relative to the largest current and the largest speed.
pub fn largest_difference(a: &[Instant], b: &[Instant]) -> f64 {
    let largest = |x: fn(&Instant) -> f64| a.iter().map(x).fold(0.0, f64::max);
    let (i_max, w_max) = (largest(|x| x.i_s.norm()), largest(|x| x.omega_mech.abs()));
    assert_eq!(a.len(), b.len(), "trajectories of equal length");
    assert!(i_max > 0.0 && w_max > 0.0, "the motor must have started");
    let differences = a.iter().zip(b).flat_map(|(x, y)| {
        let current = (x.i_s - y.i_s).norm() / i_max;
        [current, (x.omega_mech - y.omega_mech).abs() / w_max]
    });
    // In this order a NaN is the largest.
    differences.max_by(f64::total_cmp).unwrap_or(f64::NAN)
}
