mod closed_form;
mod companion;
mod decision;
mod gates;
mod plant;
mod rows;
mod sensitivities;

use motor::{Mechanics, TParams};

use super::circuit::{Circuit, Iron, Scales};
use super::decision::Limits;
use super::departures::Priors;
use super::{KnownLoad, Motion, MotionCycle, MotionSample, MotionState, rated_step};
use plant::{Plant, State, T_SAMPLE};

/// What the monitor believes of a motor: its own parameters.
pub fn believed(plant: &Plant) -> Motion {
    let rated = Scales {
        voltage: plant.volt as f32,
        current: 7.07,
        omega: (std::f64::consts::TAU * plant.hertz) as f32,
        torque: 14.6,
    };
    let circuit = Circuit {
        params: TParams {
            r_s: plant.r_s as f32,
            r_r: plant.r_r as f32,
            l_ls: plant.l_ls as f32,
            l_lr: plant.l_lr as f32,
            l_m: plant.l_m as f32,
        },
        iron: Iron::LINEAR,
        mechanics: Mechanics {
            n_p: plant.n_p as f32,
            inertia: plant.inertia as f32,
            friction: plant.friction as f32,
            load_friction: 0.0,
        },
        friction: plant.friction as f32,
        rated,
        t_sample: T_SAMPLE as f32,
    };
    Motion {
        circuit,
        priors: Priors::of(&Default::default()),
        limits: Limits {
            statistic: 5.5,
            square: 75.0,
        },
        channel_gain: [1.0; 6],
        per_count: (std::f64::consts::TAU * plant.n_p / plant.counts) as f32,
        samples: (1.0 / (plant.hertz * T_SAMPLE)).round() as f32,
        part: 10.0,
        step: rated_step(rated.omega, T_SAMPLE as f32),
        load: KnownLoad::Measured,
        is_doubted: false,
    }
}

/// All cycles of a run.
pub fn cycles(motion: &Motion, samples: &[(MotionSample, State)]) -> Vec<MotionCycle> {
    let mut state = MotionState::default();
    let update = |(sample, _): &(MotionSample, State)| motion.update(&mut state, sample);
    samples.iter().filter_map(update).collect()
}

/// Root mean square of E+ and E- of all cycles but the first `skip`, share of rated voltage.
pub fn scatter_of_e(cycles: &[MotionCycle], skip: usize) -> f32 {
    let rows = cycles
        .iter()
        .skip(skip)
        .flat_map(|cycle| cycle.rows.iter().take(4));
    root_mean_square(rows.copied())
}

pub fn root_mean_square(x: impl Iterator<Item = f32>) -> f32 {
    let (n, sum) = x.fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + x * x));
    (sum / n).sqrt()
}
