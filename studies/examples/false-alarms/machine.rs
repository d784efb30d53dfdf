//! One machine from its seed to its tally.

use campaign::hours::{Machine, Watched, live};
use motor::MotorFile;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use replay::calibrate::Surroundings;

use crate::tally::{Listener, Tally};

pub fn tally(seed: u64, motors: &[MotorFile], (days, lapse): (f64, f64), alike: bool) -> Tally {
    let machine = Machine::draw(seed, motors);
    let machine = match alike {
        true => machine.with_one_temperature(),
        false => machine,
    };
    let mut random = Pcg64::seed_from_u64(seed ^ 0x5eed);
    let mut tally = Tally {
        words: format!("seed {seed}: {}", machine.words),
        ..Tally::default()
    };
    match Watched::learn(machine, &Surroundings::default(), &mut random) {
        Err(refused) => tally.refused = Some(refused.why),
        Ok(watched) => {
            let healthy = watched.motor.healthy.as_ref();
            let limit = healthy.map_or(f64::NAN, |healthy| healthy.significance) as f32;
            let mut listener = Listener::new(tally, limit);
            let ran = live(&watched, days, lapse, &mut |moment, report| {
                listener.hear(moment, report)
            });
            tally = listener.finish();
            tally.days = days;
            tally.ran_days = ran.calendar_s / 86_400.0;
            tally.lived_days = ran.lived_s / 86_400.0;
        }
    }
    tally
}
