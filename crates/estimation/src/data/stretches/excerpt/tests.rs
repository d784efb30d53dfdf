use super::*;
use crate::data::case::Case;
use crate::data::channels::N_CHANNELS;
use crate::data::given::Given;
use crate::data::given::Sources;
use crate::data::question::Question;
use crate::data::study::Subject;
use crate::model::prediction::{SpeedObserver, outputs, residual};
use crate::model::prior::Hypothesis;
use crate::specimen::{self, T_SAMPLE};
use recording::Channel;

const BUDGET: Budget = Budget {
    stretch_s: 1.0,
    fitted: 4,
    proving: 3,
};

/// Pieces of so many samples.
fn pieces(whole: &Recording, rows: usize) -> Vec<Recording> {
    let begins = (0..whole.len()).step_by(rows);
    let piece = |from: usize| whole.slice(from..(from + rows).min(whole.len()));
    begins.map(piece).collect::<Result<_, _>>().expect("pieces")
}

fn excerpt(pieces: &[Recording]) -> Excerpt {
    let mut survey = Survey::new(&specimen::motor(""), BUDGET);
    pieces.iter().for_each(|piece| survey.take(piece));
    let mut gathering = Gathering::new(survey.choose());
    let mut each = pieces.iter();
    each.try_for_each(|piece| gathering.take(piece))
        .expect("the same recording");
    gathering.finish()
}

fn waveform(excerpt: &Excerpt, role: Role) -> Waveform {
    let rated = specimen::prior("").plant.rated;
    excerpt.case(role, &rated).expect("judged").0
}

fn spans(excerpt: &Excerpt, role: Role) -> Vec<(f64, f64)> {
    let of = excerpt.stretches.iter().filter(|one| one.role == role);
    of.map(|one| (one.from_s, one.to_s)).collect()
}

/// The motor's steady state in closed form, in every stretch; nothing of it is left, and each stands at its own time.
#[test]
fn stretches_leave_no_error_and_keep_clock_and_angle() {
    let excerpt = excerpt(&pieces(&specimen::recording(20.0, |_| 1.0), 7_001));
    let prior = specimen::prior("");
    let omega = specimen::point(1.0).omega_mech;
    for role in [Role::Fitted, Role::Proves] {
        let waveform = waveform(&excerpt, role);
        let case = Case::from(waveform.clone());
        let model = outputs(
            &case,
            &prior,
            &Hypothesis::at_prior(false),
            SpeedObserver::Off,
        );
        let r = residual(&case, &model);
        let rms = (r.iter().map(|r| r * r).sum::<f64>() / case.judged()).sqrt();
        // In units of the declared noise, which the samples do not have: what is left is the integration.
        assert!(rms < 0.1, "{role:?}: {rms}");
        let judged = |row: usize| waveform.weight[row] != [0.0; N_CHANNELS];
        let inside = |t: f64| {
            let of = spans(&excerpt, role);
            of.iter().any(|(from, to)| (from - 1e-9..*to).contains(&t))
        };
        let rows = (0..waveform.measured.len()).filter(|row| judged(*row));
        assert!(
            rows.clone().all(|row| inside(waveform.time_of(row))),
            "{role:?}"
        );
        // Blocks of 40 ms are whole: of each second not more than one is left out.
        let seconds = rows.count() as f64 * waveform.t_row();
        let told: f64 = spans(&excerpt, role)
            .iter()
            .map(|(from, to)| to - from)
            .sum();
        assert!(
            (told - 0.04 * told..told + 1e-6).contains(&seconds),
            "{told} {seconds}"
        );
        for row in (0..waveform.measured.len()).step_by(97) {
            let theta = waveform.timeline.theta_mech[row * waveform.samples_per_row()];
            // A trapezoid sums the speed without error where it is constant.
            assert!(
                (theta - omega * waveform.time_of(row)).abs() < 1e-6,
                "{row}"
            );
        }
    }
}

/// What is taken depends on the recording alone, not on where its pieces end.
#[test]
fn the_size_of_the_pieces_changes_nothing() {
    let load = |t: f64| if t < 9.3 { 1.0 } else { 0.4 };
    let whole = specimen::recording(20.0, load);
    let (one, other) = (
        excerpt(&pieces(&whole, 9_973)),
        excerpt(&pieces(&whole, 50_001)),
    );
    assert_eq!(one.stretches, other.stretches);
    for role in [Role::Fitted, Role::Proves] {
        let (one, other) = (waveform(&one, role), waveform(&other, role));
        assert_eq!(one.measured, other.measured);
        assert_eq!(one.inputs.u_s, other.inputs.u_s);
        assert_eq!(one.timeline.cuts, other.timeline.cuts);
    }
}

/// Two loads and the step between them are fitted; nothing that is fitted proves, and every proof is like something fitted.
#[test]
fn what_differs_is_fitted_and_what_is_like_it_proves() {
    let load = |t: f64| if t < 9.3 { 1.0 } else { 0.4 };
    let excerpt = excerpt(&pieces(&specimen::recording(20.0, load), 9_973));
    let (fitted, proving) = (spans(&excerpt, Role::Fitted), spans(&excerpt, Role::Proves));
    let holds = |spans: &[(f64, f64)], t: f64| spans.iter().any(|(a, b)| (*a..*b).contains(&t));
    assert!(holds(&fitted, 9.3), "{fitted:?}");
    assert!(fitted.iter().any(|(_, to)| *to < 9.3) && fitted.iter().any(|(from, _)| *from > 9.3));
    let apart = |(a, b): &(f64, f64)| fitted.iter().all(|(c, d)| b <= c || d <= a);
    assert!(
        !proving.is_empty() && proving.iter().all(apart),
        "{proving:?}"
    );
    let why = excerpt
        .stretches
        .iter()
        .find(|one| (one.from_s..one.to_s).contains(&9.3));
    let why = &why.expect("taken").why;
    assert!(
        why.contains("torque 0.4") && why.contains("to 1.0"),
        "{why}"
    );
}

/// Time without samples ends what may be taken together, and what the audit refuses is not taken.
#[test]
fn nothing_is_taken_across_a_gap_or_from_a_piece_that_is_refused() {
    let whole = specimen::recording(24.0, |_| 1.0);
    let mut all = pieces(&whole, (4.0 / T_SAMPLE) as usize);
    // The second piece is missing; the third stands still.
    all.remove(1);
    let levels = [(Channel::VOLTAGES, 150.0), (Channel::CURRENTS, 1.0)];
    for (channel, level) in levels.iter().flat_map(|(all, x)| all.map(|one| (one, *x))) {
        let held = vec![level; all[1].len()];
        all[1].set(channel, held).expect("as long");
    }
    let excerpt = excerpt(&all);
    let taken = [spans(&excerpt, Role::Fitted), spans(&excerpt, Role::Proves)].concat();
    assert!(
        taken
            .iter()
            .all(|(from, to)| *to <= 4.0 + 1e-9 || *from >= 12.0 - 1e-9),
        "{taken:?}"
    );
    assert!(
        excerpt.audit.supported
            && excerpt
                .audit
                .findings
                .iter()
                .any(|one| one.from_s.is_some())
    );
    let parts = excerpt.parts.iter().map(|part| part.recording.t());
    assert!(
        parts
            .clone()
            .all(|t| t.windows(2).all(|w| w[1] - w[0] < 1.5 * T_SAMPLE))
    );
    assert!(parts.count() > 2);
}

#[test]
fn a_recording_without_a_sound_second_is_refused_with_its_reason() {
    let short = specimen::recording(0.6, |_| 1.0);
    let excerpt = excerpt(&[short]);
    let rated = specimen::prior("").plant.rated;
    let why = excerpt.case(Role::Fitted, &rated).expect_err("too short");
    assert!(why.reason.contains("sampled evenly"), "{why:?}");
    assert!(excerpt.around(0.0).is_none());
}

/// One long recording proves itself on stretches that were not fitted; beside another recording it is fitted alone.
#[test]
fn a_question_about_stretches_has_proofs_of_its_own() {
    let motor = specimen::motor("");
    let excerpt = excerpt(&pieces(&specimen::recording(20.0, |_| 1.0), 9_973));
    let alone = [Given::Excerpt(excerpt.clone())];
    let question = Question::new(Sources::Given(&alone), &motor, &mut |_, _| {}).expect("judged");
    assert_eq!(question.study.proofs.len(), 1);
    assert_eq!(question.stretches, excerpt.stretches);
    assert!(
        question
            .audit
            .assumptions
            .iter()
            .any(|one| one.contains("prove"))
    );
    let other = specimen::recording(1.0, |_| 0.5);
    let both = [
        Given::Source(recording::Source::Recording(other)),
        Given::Excerpt(excerpt),
    ];
    let question = Question::new(Sources::Given(&both), &motor, &mut |_, _| {}).expect("judged");
    assert_eq!(question.study.proofs.len(), 1);
    let rows = |subject: &Subject| subject.case.measured().len();
    assert!(rows(&question.study.proofs[0]) > rows(&question.study.fitted));
}

/// A motor that is switched off for a while: its rest is no state that a model could be held against.
#[test]
fn a_motor_at_rest_is_not_taken() {
    let whole = specimen::recording(20.0, |_| 1.0);
    let mut all = pieces(&whole, (4.0 / T_SAMPLE) as usize);
    for channel in Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS) {
        let noise = (0..all[2].len()).map(|k| 1e-3 * (k as f64).sin()).collect();
        all[2].set(channel, noise).expect("as long");
    }
    let excerpt = excerpt(&all);
    let taken = [spans(&excerpt, Role::Fitted), spans(&excerpt, Role::Proves)].concat();
    assert!(
        taken.iter().all(|(from, to)| *to <= 8.1 || *from >= 11.9),
        "{taken:?}"
    );
    let rated = specimen::prior("").plant.rated;
    let (_, used) = excerpt.case(Role::Fitted, &rated).expect("judged");
    assert!(used.iter().all(|one| excerpt.stretches.contains(one)));
}

/// Far from the clock's zero its steps are rounded, by another amount in every stretch: they are one recording all the same.
#[test]
fn a_clock_that_is_rounded_leaves_no_stretch_out() {
    let near = specimen::recording(20.0, |_| 1.0);
    let t = near.t().iter().map(|t| t + 20_000.0).collect();
    let empty = Recording::new("far", t, near.metadata.clone()).expect("a clock");
    let far = near.channels().fold(empty, |far, (channel, values)| {
        far.with_channel(channel, values.to_vec()).expect("as long")
    });
    let excerpt = excerpt(&pieces(&far, 7_001));
    let rated = specimen::prior("").plant.rated;
    for role in [Role::Fitted, Role::Proves] {
        let (case, used) = excerpt.case(role, &rated).expect("judged");
        assert_eq!(used.len(), spans(&excerpt, role).len());
        assert!((case.time_of(0) - used[0].from_s).abs() < 0.51);
    }
}

/// What is simulated has a limit: four seconds that stand alone take half a second each before they are judged, as long as five
/// in a row with one such half.
#[test]
fn stretches_in_a_row_are_more_than_those_that_stand_alone() {
    for (seconds, taken) in [(5.0, 5), (60.0, 4)] {
        let excerpt = excerpt(&pieces(&specimen::recording(seconds, |_| 1.0), 7_001));
        let fitted: f64 = spans(&excerpt, Role::Fitted)
            .iter()
            .map(|(from, to)| to - from)
            .sum();
        assert!((fitted - f64::from(taken)).abs() < 1e-6, "{fitted}");
        let waveform = waveform(&excerpt, Role::Fitted);
        let simulated = waveform.measured.len() as f64 * waveform.t_row();
        assert!(simulated < 4.0 * 1.5 + 1e-6, "{simulated}");
    }
}
