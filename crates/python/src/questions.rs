//! The questions of the commands.

use crate::answer::{Answer, Outcome};
use crate::errors::{
    of_file, of_monitor, of_recording, of_study, unsupported, unsupported_at, usage,
};
use crate::motor::Motor;
use crate::source::Recording;
use crate::work::{Told, run};
use discovery::{LAW, Laws, Shapes, Sources};
use document::read_text;
use pyo3::prelude::*;
use recording::Source;
use replay::calibrate::Surroundings;
use replay::operating_points::OperatingPoints;
use report::study::{
    Adopted, Calibration, Checkup, Compared, Explained, FALSE_ALARM_RATES, Inputs, Monitored,
    Typed, WINDING_KELVINS,
};
use scenario::{Scenario, simulate};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Adds the functions to the module.
pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(ask_simulate, module)?)?;
    module.add_function(wrap_pyfunction!(ask_monitor, module)?)?;
    module.add_function(wrap_pyfunction!(ask_check, module)?)?;
    module.add_function(wrap_pyfunction!(ask_compare, module)?)?;
    module.add_function(wrap_pyfunction!(ask_explain, module)?)?;
    module.add_function(wrap_pyfunction!(ask_adopt, module)?)?;
    module.add_function(wrap_pyfunction!(ask_calibrate, module)?)
}

type Progress<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// What a study is asked about, owned: it goes to another thread.
struct Asked {
    names: Vec<String>,
    sources: Vec<Source>,
    motor: Motor,
    /// The flags that all recordings were read with; nothing where a command could not read them again.
    flags: Option<String>,
}

impl Asked {
    fn new(recordings: Vec<Recording>, motor: Motor) -> Asked {
        let mut flags = recordings.first().and_then(|first| first.typed.clone());
        if recordings.iter().any(|one| one.typed != flags) || motor.path.is_none() {
            flags = None;
        }
        Asked {
            names: recordings.iter().map(|one| name(&one.source)).collect(),
            sources: recordings.into_iter().map(|one| one.source).collect(),
            motor,
            flags,
        }
    }

    fn inputs(&self) -> Inputs<'_> {
        Inputs {
            names: &self.names,
            sources: Sources::Whole(&self.sources),
            motor: &self.motor.known.motor,
            laws: Laws::default(),
            next_run: None,
        }
    }

    /// What a command line would ask; nothing where there is none.
    fn typed(&self) -> Option<Typed<'_>> {
        Some(Typed {
            names: &self.names,
            motor: self.motor.path.as_deref()?,
            flags: self.flags.as_deref()?,
        })
    }

    fn error(&self, error: &discovery::Error) -> PyErr {
        let first = self.names.first().map_or("", String::as_str);
        of_study(error, first)
    }
}

fn name(source: &Source) -> String {
    match source {
        Source::Recording(recording) => recording.name().to_owned(),
        Source::LoadTable(table) => table.name().to_owned(),
    }
}

#[pyfunction]
#[pyo3(name = "simulate")]
fn ask_simulate(
    py: Python<'_>,
    text: String,
    label: String,
    folder: PathBuf,
    seed: Option<u64>,
    progress: Progress<'_, '_>,
) -> PyResult<Recording> {
    let scenario = Scenario::parse(&text, &label, &folder).map_err(|error| of_file(&error))?;
    let mut scenario = scenario;
    scenario.seed = seed.unwrap_or(scenario.seed);
    let recorded = run(py, progress, move |told| {
        simulate::record(&scenario, |share| told.say("simulating", share))
    })?;
    let recording = recorded.map_err(|error| usage(format!("{label}: {error}")))?;
    Ok(Recording::new(Source::Recording(recording), None))
}

#[pyfunction]
#[pyo3(name = "monitor")]
fn ask_monitor(
    py: Python<'_>,
    recording: Recording,
    motor: Option<Motor>,
    progress: Progress<'_, '_>,
) -> PyResult<Answer> {
    let label = motor.as_ref().map(Motor::label);
    let outcome = run(py, progress, move |told| {
        let motor = motor.as_ref().map(|motor| &motor.known.motor);
        match &recording.source {
            Source::LoadTable(table) => Ok(Outcome::LoadTable(OperatingPoints::new(table, motor))),
            Source::Recording(recording) => {
                let all = recording.len().max(1) as f64;
                let mut tell = |done: usize| told.say("monitoring", done as f64 / all);
                let monitored = Monitored::new(recording, motor, &mut tell);
                monitored.map(|monitored| Outcome::Monitor(Box::new(monitored)))
            }
        }
    })?;
    let label = label.as_deref().unwrap_or("the recording");
    let outcome = outcome.map_err(|error| of_monitor(&error, label))?;
    Ok(Answer::new(outcome, None))
}

#[pyfunction]
#[pyo3(name = "check")]
fn ask_check(
    py: Python<'_>,
    recordings: Vec<Recording>,
    motor: Motor,
    healthy: Vec<Recording>,
    out: Option<PathBuf>,
    progress: Progress<'_, '_>,
) -> PyResult<Answer> {
    spare(out.as_deref(), &motor, recordings.iter().chain(&healthy))?;
    let judged = recordings.iter().map(|one| one.samples().cloned());
    let judged = judged.collect::<PyResult<Vec<_>>>()?;
    let healthy = healthy.iter().map(|one| one.samples().cloned());
    let healthy = healthy.collect::<PyResult<Vec<_>>>()?;
    let checked = run(py, progress, move |told| {
        let healthy: Vec<_> = healthy.iter().collect();
        let judged = judged.iter().map(|one| (one.name().to_owned(), one));
        let judged: Vec<_> = judged.collect();
        let mut tell = |what: &str, share: f64| told.say(what, share);
        Checkup::new(&motor.known, &healthy, &judged, &mut tell)
    })?;
    let (mut checkup, learnt) = checked.map_err(usage)?;
    let learnt = Motor::learnt(learnt, out.as_deref());
    if let Some(out) = &out {
        write(out, &learnt.text)?;
        checkup.motor_file = Some(out.display().to_string());
    }
    Ok(Answer::new(Outcome::Check(Box::new(checkup)), Some(learnt)))
}

#[pyfunction]
#[pyo3(name = "compare")]
fn ask_compare(
    py: Python<'_>,
    recordings: Vec<Recording>,
    motor: Motor,
    progress: Progress<'_, '_>,
) -> PyResult<Answer> {
    let asked = Asked::new(recordings, motor);
    let (asked, compared) = study(py, progress, asked, |asked, told| {
        let next = asked.typed().map(|typed| typed.line());
        let next = next.map_or_else(String::new, |line| format!("drivemon explain {line}"));
        let mut tell = |what: &str, share: f64| told.say(what, share);
        Compared::new(asked.inputs(), next, &mut tell)
    })?;
    let compared = compared.map_err(|error| asked.error(&error))?;
    Ok(Answer::new(Outcome::Compare(Box::new(compared)), None))
}

#[pyfunction]
#[pyo3(name = "explain")]
fn ask_explain(
    py: Python<'_>,
    recordings: Vec<Recording>,
    motor: Motor,
    shapes: Option<PathBuf>,
    progress: Progress<'_, '_>,
) -> PyResult<Answer> {
    let laws = laws(shapes.as_deref(), None)?;
    let asked = Asked::new(recordings, motor);
    let (asked, explained) = study(py, progress, asked, move |asked, told| {
        let more = shapes.as_deref().map_or_else(String::new, |path| {
            format!(
                " --shapes {}",
                recording::quoted(&path.display().to_string())
            )
        });
        let adopt = |name: &str, names: &[String]| {
            let more = if name == LAW { more.as_str() } else { "" };
            asked
                .typed()
                .map(|typed| Typed { names, ..typed }.adopt(name, more))
        };
        let inputs = Inputs {
            laws,
            ..asked.inputs()
        };
        let mut tell = |what: &str, share: f64| told.say(what, share);
        Explained::new(inputs, &adopt, &mut tell)
    })?;
    let explained = explained.map_err(|error| asked.error(&error))?;
    Ok(Answer::new(Outcome::Explain(Box::new(explained)), None))
}

/// What `adopt` takes beside effect, recordings and motor.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Adopting {
    shapes: Option<PathBuf>,
    formula: Option<usize>,
    out: Option<PathBuf>,
    anyway: bool,
}

#[pyfunction]
#[pyo3(name = "adopt")]
fn ask_adopt(
    py: Python<'_>,
    effect: String,
    recordings: Vec<Recording>,
    motor: Motor,
    how: Adopting,
    progress: Progress<'_, '_>,
) -> PyResult<Answer> {
    let Adopting {
        shapes,
        formula,
        out,
        anyway,
    } = how;
    match formula {
        Some(0) => return Err(usage("formula 0: formulas count from 1")),
        Some(_) if effect != LAW => {
            return Err(usage(format!(
                "formula belongs to \"{LAW}\": \"{effect}\" has no formulas to choose from"
            )));
        }
        _ => {}
    }
    let laws = laws(shapes.as_deref(), formula)?;
    spare(out.as_deref(), &motor, &recordings)?;
    let asked = Asked::new(recordings, motor);
    let (asked, adopted) = study(py, progress, asked, move |asked, told| {
        let inputs = Inputs {
            laws,
            ..asked.inputs()
        };
        let mut tell = |what: &str, share: f64| told.say(what, share);
        Adopted::new(&effect, inputs, &mut tell)
    })?;
    let (mut adopted, motor) = adopted.map_err(|error| asked.error(&error))?;
    if !(adopted.report.proven || anyway) {
        return Ok(Answer::new(Outcome::Adopt(Box::new(adopted)), None));
    }
    let motor = asked.motor.with(motor, out.as_deref());
    if let Some(out) = &out {
        write(out, &motor.text)?;
        adopted.report.motor_file = out.display().to_string();
        let typed = asked.typed().map(|typed| typed.with(out));
        adopted.next_command =
            typed.map_or_else(String::new, |line| format!("drivemon explain {line}"));
    }
    Ok(Answer::new(Outcome::Adopt(Box::new(adopted)), Some(motor)))
}

#[pyfunction]
#[pyo3(name = "calibrate")]
fn ask_calibrate(
    py: Python<'_>,
    recordings: Vec<Recording>,
    motor: Motor,
    surroundings: (f64, f64),
    out: Option<PathBuf>,
    progress: Progress<'_, '_>,
) -> PyResult<Answer> {
    let (winding_kelvin, false_alarm_rate) = surroundings;
    if !FALSE_ALARM_RATES.contains(&false_alarm_rate) {
        let message = format!("false_alarm_rate {false_alarm_rate} is outside 1e-12 to 0.01");
        return Err(usage(message));
    }
    if !WINDING_KELVINS.contains(&winding_kelvin) {
        let message = format!("winding_kelvin {winding_kelvin} is outside 0 to 200 K");
        return Err(usage(message));
    }
    spare(out.as_deref(), &motor, &recordings)?;
    let samples = recordings.iter().map(|one| one.samples().cloned());
    let samples = samples.collect::<PyResult<Vec<_>>>()?;
    let believed = motor.known.motor.clone();
    let surroundings = Surroundings {
        winding_kelvin,
        false_alarm_rate,
    };
    let learnt = run(py, progress, move |told| {
        told.say("calibrating", 0.0);
        let names = samples.iter().map(|one| one.name().to_owned()).collect();
        Calibration::new(names, &samples, &believed, &surroundings)
    })?;
    let (mut calibration, learnt) = learnt.map_err(|refusal| {
        let message = format!("not calibrated: {refusal}");
        unsupported_at(&refusal.recording, &message, &refusal.reason, "")
    })?;
    let learnt = motor.with(learnt, out.as_deref());
    if let Some(out) = &out {
        write(out, &learnt.text)?;
        calibration.motor_file = out.display().to_string();
    }
    Ok(Answer::new(
        Outcome::Calibrate(Box::new(calibration)),
        Some(learnt),
    ))
}

/// Works on what was asked, and gives it back with the outcome.
fn study<T: Send + 'static>(
    py: Python<'_>,
    progress: Progress<'_, '_>,
    asked: Asked,
    work: impl FnOnce(&Asked, &Told) -> T + Send + 'static,
) -> PyResult<(Asked, T)> {
    if asked.sources.is_empty() {
        return Err(unsupported("no recording: give at least one"));
    }
    run(py, progress, move |told| {
        let outcome = work(&asked, told);
        (asked, outcome)
    })
}

fn laws(shapes: Option<&Path>, formula: Option<usize>) -> PyResult<Laws> {
    let shapes = match shapes {
        None => Shapes::default(),
        Some(path) => {
            let text = read_text(path).map_err(|error| of_file(&error))?;
            let label = path.display().to_string();
            Shapes::with(&text, &label).map_err(|error| of_file(&error))?
        }
    };
    Ok(Laws { shapes, formula })
}

/// Refuses a motor file that would overwrite what it is made from.
fn spare<'r>(
    out: Option<&Path>,
    motor: &Motor,
    recordings: impl IntoIterator<Item = &'r Recording>,
) -> PyResult<()> {
    let Some(out) = out.and_then(|out| out.canonicalize().ok()) else {
        return Ok(());
    };
    let files = recordings.into_iter().filter(|one| one.typed.is_some());
    let read = files.map(|one| PathBuf::from(name(&one.source)));
    for read in read.chain(motor.path.clone()) {
        if read.canonicalize().is_ok_and(|read| read == out) {
            let read = read.display();
            return Err(usage(format!(
                "{read}: the new motor file would overwrite it; give it another name"
            )));
        }
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> PyResult<()> {
    let written = formats::write_whole(path, |file| file.write_all(text.as_bytes()));
    written.map_err(|error| {
        let name = path.display().to_string();
        let message = format!("cannot be written: {error}");
        let remedy = "name a path in a folder that exists and can be written";
        of_recording(&recording::Error::bad(&name, message, remedy))
    })
}
