use super::*;
use crate::specimen;
use motor::motor_file::EffectEntry;
use recording::Channel;

fn asked(sources: &[Source], motor: &MotorFile) -> Result<Question, Error> {
    Question::new(sources, motor, &mut |_, _| {})
}

fn steady(seconds: f64) -> Recording {
    specimen::recording(seconds, |_| 1.0)
}

fn scaled(rec: &Recording, channels: &[Channel], gain: f64) -> Recording {
    channels.iter().fold(rec.clone(), |rec, &channel| {
        let x = rec.channel(channel).expect("recorded");
        let x = x.iter().map(|x| gain * x).collect();
        rec.with_channel(channel, x).expect("as long")
    })
}

/// The recording with these channels only.
fn only(rec: &Recording, kept: impl Fn(Channel) -> bool) -> Recording {
    let empty = Recording::new("less", rec.t().to_vec(), rec.metadata.clone()).expect("a clock");
    rec.channels()
        .filter(|(c, _)| kept(*c))
        .fold(empty, |rec, (c, x)| {
            rec.with_channel(c, x.to_vec()).expect("as long")
        })
}

fn message(error: Option<Error>) -> String {
    match error {
        Some(Error::Recordings(message)) => message,
        other => format!("another error: {other:?}"),
    }
}

#[test]
fn the_first_source_is_fitted_and_the_others_prove() {
    let sources = [
        specimen::table_source(|_| ()),
        specimen::table_source(|_| ()),
    ];
    let mut told = Vec::new();
    let question = Question::new(&sources, &specimen::motor(""), &mut |what, share| {
        told.push((what.to_owned(), share));
    });
    let question = question.expect("judged");
    assert!(question.audit.supported && question.audit.findings.is_empty());
    assert_eq!(question.study.proofs.len(), 1);
    assert!(question.study.speed_scale.is_none());
    let expected = [
        ("auditing the recordings", 0.0),
        ("propagating the noise", 0.05),
    ];
    assert_eq!(told, expected.map(|(what, share)| (what.to_owned(), share)));
}

#[test]
fn a_question_needs_sources_of_one_kind() {
    let motor = specimen::motor("");
    assert!(message(asked(&[], &motor).err()).contains("at least one"));
    let table = specimen::table_source(|_| ());
    let recording = Source::Recording(steady(0.3));
    for mixed in [
        [table.clone(), recording.clone()],
        [recording.clone(), table],
    ] {
        let told = message(asked(&mixed, &motor).err());
        assert!(told.contains("cannot prove each other"), "{told}");
    }
    assert!(asked(&[recording.clone(), recording], &motor).is_ok());
}

#[test]
fn wrong_effects_of_the_motor_file_are_told() {
    let mut motor = specimen::motor("");
    motor
        .effects
        .push(EffectEntry::with_numbers("phlogiston", []));
    let error = asked(&[specimen::table_source(|_| ())], &motor)
        .err()
        .expect("refused");
    assert!(matches!(error, Error::MotorFile(_)));
    assert!(error.to_string().contains("phlogiston"), "{error}");
}

/// Line voltages in the place of phase voltages: the audit refuses and says why.
#[test]
fn what_the_audit_refuses_is_no_question() {
    let wrong = scaled(&steady(0.5), &Channel::VOLTAGES, 3f64.sqrt());
    let good = Source::Recording(steady(0.5));
    let error = asked(&[good, Source::Recording(wrong)], &specimen::motor("")).err();
    let Some(Error::Unsupported(audit, why)) = error else {
        panic!("refused by the audit: {error:?}");
    };
    assert!(
        !audit.supported,
        "the audit is that of the recording that is refused"
    );
    let finding = audit.findings.iter().find(|f| f.refuses).expect("one");
    assert_eq!(
        (why.reason.as_str(), why.remedy.as_str()),
        (finding.detail.as_str(), "see the audit")
    );
    let error = Error::Unsupported(audit.clone(), why);
    assert_eq!(
        error.to_string(),
        format!("{}; see the audit", finding.detail)
    );
    let mut sound = audit;
    sound.findings.iter_mut().for_each(|f| f.refuses = false);
    assert_eq!(refusal(&sound), None);
}

#[test]
fn what_cannot_be_prepared_is_refused_with_the_first_audit() {
    let error = asked(&[Source::Recording(steady(0.19))], &specimen::motor("")).err();
    let Some(Error::Unsupported(audit, why)) = error else {
        panic!("too short: {error:?}");
    };
    assert!(audit.supported && why.reason.contains("shorter"));
    assert_eq!(
        Error::UnknownEffect("no such".to_owned()).to_string(),
        "no such"
    );
    assert_eq!(Error::Recordings("none".to_owned()).to_string(), "none");
}

/// A measured brake torque holds the friction of the load; friction alone, a table or no torque at all does not.
#[test]
fn a_measured_torque_takes_the_loads_friction_out_of_the_prior() {
    let mut motor = specimen::motor("");
    motor.mechanics.load_friction = 3e-4;
    let friction = |sources: &[Source]| {
        let question = asked(sources, &motor).expect("judged");
        question.study.prior.plant.mechanics.load_friction
    };
    let measured = steady(0.3);
    let mut declared = measured.clone();
    declared.metadata.load_torque = LoadTorque::Friction;
    let mut free = only(&measured, |c| c != Channel::TORQUE);
    free.metadata.load_torque = LoadTorque::Friction;
    assert_eq!(friction(&[Source::Recording(measured.clone())]), 0.0);
    assert_eq!(friction(&[Source::Recording(declared.clone())]), 3e-4);
    assert_eq!(friction(&[Source::Recording(free.clone())]), 3e-4);
    assert_eq!(friction(&[specimen::table_source(|_| ())]), 3e-4);
    let mixed = [free, measured].map(Source::Recording);
    assert_eq!(friction(&mixed), 0.0);
}

#[test]
fn a_clipping_probe_is_replaced_by_its_second() {
    let rec = steady(0.5);
    let [ia, ..] = Channel::CURRENTS;
    let limit = 0.7;
    let clipped = rec
        .channel(ia)
        .expect("recorded")
        .iter()
        .map(|x| x.clamp(-limit, limit))
        .collect();
    let whole = rec.channel(ia).expect("recorded").to_vec();
    let mut rec = rec
        .clone()
        .with_channel(ia, clipped)
        .and_then(|rec| rec.with_channel(Channel::second(ia.signal), whole.clone()))
        .expect("as long");
    rec.metadata.sensors.current_full_scale_amp = Some(limit);
    let motor = specimen::motor("");
    let source = Source::Recording(rec);
    let audit = audit_of(&source, &motor);
    let Ready::Recording(sound) = Ready::of(One::from(&source), &audit) else {
        panic!("a recording stays one");
    };
    assert_eq!(sound.channel(ia), Some(&whole[..]));
    let table = specimen::table_source(|_| ());
    let kept = Ready::of(One::from(&table), &audit_of(&table, &motor));
    assert!(matches!(kept, Ready::LoadTable(table) if table.len() == 12));
}

/// The channel shows 0.4 times the speed: the factor is what undoes that, fitted with everything at its prior.
#[test]
fn an_unknown_scale_is_fitted_before_anything_is_asked() {
    let rec = specimen::unknown_speed(0.5, 0.4);
    let question = asked(&[Source::Recording(rec)], &specimen::motor("")).expect("judged");
    let study = &question.study;
    let scale = study.speed_scale.expect("unknown");
    assert!((scale.factor * 0.4 - 1.0).abs() < 1e-3, "{scale:?}");
    let waveform = study.fitted.case.waveform().expect("a recording");
    assert!(waveform.speed_is_input || waveform.speed_scale_is_free);
    let omega = specimen::point(1.0).omega_mech;
    let seen = waveform.speed[1000];
    assert!((seen / omega - 1.0).abs() < 1e-3, "{seen} {omega}");
}

#[test]
fn scales_are_all_known_or_all_unknown() {
    let motor = specimen::motor("");
    let unknown = specimen::unknown_speed(0.5, 0.4);
    let mixed = [
        Source::Recording(steady(0.5)),
        Source::Recording(unknown.clone()),
    ];
    let told = message(asked(&mixed, &motor).err());
    assert!(
        told.contains("unknown in some recordings and known in others"),
        "{told}"
    );
    let both = [unknown.clone(), unknown.clone()].map(Source::Recording);
    assert_eq!(asked(&both, &motor).expect("judged").study.proofs.len(), 1);
    // A scale of what is not there does not matter.
    let mut without = only(&unknown, |c| c != Channel::SPEED);
    without
        .unknown_speed_scale
        .clone_from(&unknown.unknown_speed_scale);
    let question = asked(&[Source::Recording(without)], &motor).expect("judged");
    assert!(question.study.speed_scale.is_none());
}

#[test]
fn the_fitted_scale_and_one_in_the_motor_file_exclude_each_other() {
    let unknown = [Source::Recording(specimen::unknown_speed(0.5, 0.4))];
    let with = |effect: &str| specimen::motor(&format!("[[effects]]\n{effect}\n"));
    let told = message(
        asked(
            &unknown,
            &with("name = \"speed-scale\"\nspeed_scale = 1.01"),
        )
        .err(),
    );
    assert!(
        told.contains("the motor file holds `speed-scale`"),
        "{told}"
    );
    let other = with("name = \"windage\"\nwindage_nm_s2 = 1e-6");
    assert!(asked(&unknown, &other).is_ok());
}

#[test]
fn a_scale_without_steady_running_is_refused_with_the_audit() {
    let rec = specimen::unknown_speed(0.5, 0.4);
    let ramp: Vec<f64> = rec.t().iter().map(|t| 20.0 + 100.0 * t).collect();
    let restless = rec.with_channel(Channel::SPEED, ramp).expect("as long");
    let error = asked(&[Source::Recording(restless)], &specimen::motor("")).err();
    let Some(Error::Unsupported(_, why)) = error else {
        panic!("no scale: {error:?}");
    };
    assert!(why.reason.contains("scale"), "{why:?}");
}
