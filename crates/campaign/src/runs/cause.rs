//! Why FAULT was lit on a healthy motor: the run again, each time without one of its troubles.

use crate::planned::axis::Axis;
use crate::runs::run::Run;
use scenario::Start;

/// A trouble that may cause an alarm, and a run without it.
type Trouble = (&'static str, fn(&mut Run<'_>));

const TROUBLES: [Trouble; 14] = [
    ("winding temperature", |run| {
        let cold = run.nominal(Axis::Winding);
        run.set(Axis::Winding, cold);
    }),
    ("gain errors", |run| run.set(Axis::GainError, 0.0)),
    ("unbalance", |run| run.set(Axis::Unbalance, 0.0)),
    ("distortion", |run| run.set(Axis::Distortion, 0.0)),
    ("noise", |run| run.set(Axis::Noise, 0.0)),
    ("load step", |run| run.set(Axis::LoadStepTo, f64::NAN)),
    ("voltage step", |run| run.set(Axis::VoltageStepTo, f64::NAN)),
    ("frequency step", |run| {
        run.set(Axis::FrequencyStepTo, f64::NAN);
    }),
    ("sampling rate", |run| run.set(Axis::SampleRate, 10_000.0)),
    ("direction", |run| run.set(Axis::Backwards, 0.0)),
    ("start", |run| run.start = Start::Running),
    ("voltage", |run| run.set(Axis::Voltage, 100.0)),
    ("frequency", |run| {
        let rated = run.nominal(Axis::Frequency);
        run.set(Axis::Frequency, rated);
    }),
    ("load", |run| run.set(Axis::Load, 100.0)),
];

/// What is said when the motor file itself, or several troubles together, are to blame.
const NO_SINGLE: &str = "no single condition";

/// The troubles without any single one of which FAULT stays dark on this motor while it is healthy.
pub(crate) fn of(run: &Run<'_>) -> String {
    let is_to_blame = |(_, remove): &&Trouble| {
        let mut without = run.healthy_part();
        remove(&mut without);
        let changed = without.differs_from(run);
        changed
            && without
                .outcome()
                .is_ok_and(|outcome| outcome.healthy_fault == 0)
    };
    let to_blame = TROUBLES.iter().filter(is_to_blame);
    let names: Vec<&str> = to_blame.map(|(name, _)| *name).collect();
    match names.as_slice() {
        [] => NO_SINGLE.to_owned(),
        names => names.join(", "),
    }
}
