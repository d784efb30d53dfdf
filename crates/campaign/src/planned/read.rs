//! Plan files.

use std::path::{Path, PathBuf};

use document::{Bounds, Document, FileError, Section, Value, read_text};
use motor::MotorFile;
use twox_hash::XxHash64;

use crate::planned::axis::{AXES, DESCRIBED, Described, Grid};
use crate::planned::check;
use crate::planned::fault::{FAULTS, FaultKind};
use crate::planned::plan::{Block, Case, LoadKnowledge, MotorPair, Plan, Target};
use scenario::Start;

/// Whole numbers that a TOML float holds exactly.
const SEED: Bounds = Bounds::between(0.0, 4_294_967_295.0, "");
const REPEATS: Bounds = Bounds::between(1.0, 1e9, "");
const SECONDS: Bounds = Bounds::above(0.0, 3600.0, "s");
const PERCENT: Bounds = Bounds::between(-100.0, 1000.0, "percent");
const TARGET: Bounds = Bounds::above(0.0, 1000.0, "percent");
const MOST_RUNS: u64 = 1_000_000_000;
const LOADS: [(&str, LoadKnowledge); 2] = [
    ("friction", LoadKnowledge::Friction),
    ("free", LoadKnowledge::Free),
];
const STARTS: [(&str, Start); 2] = [
    ("standstill", Start::Standstill),
    ("running", Start::Running),
];
const MOTOR: &str = "the path of a motor file, seen from the plan's folder";

impl Plan {
    /// Reads a plan; the motor files that it names are looked up beside it.
    ///
    /// # Errors
    /// An unreadable file, or all problems of the plan or of its motor files with file, line, key and remedy.
    pub fn read(path: impl AsRef<Path>) -> Result<Plan, FileError> {
        let path = path.as_ref();
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        Plan::parse(&read_text(path)?, &path.display().to_string(), &folder)
    }

    /// Validates the text of a plan; `folder` is where the paths of motor files begin.
    ///
    /// # Errors
    /// All problems of the plan or of its motor files with file, line, key and remedy.
    pub fn parse(text: &str, file_label: &str, folder: &Path) -> Result<Plan, FileError> {
        let document = Document::parse(text, file_label)?;
        let root = document.root();
        let motors = motors(&document, &root, folder)?;
        let plan = plan(&root, motors, text);
        if let Some(plan) = &plan {
            check::runs(&root, plan, MOST_RUNS);
        }
        root.finish();
        document.finish(plan)
    }
}

fn plan(root: &Section<'_>, motors: Option<Vec<MotorPair>>, text: &str) -> Option<Plan> {
    let name = root.text("name", "what this campaign is called");
    let seed = root.integer_or("seed", &SEED, 0);
    let sections = root.sections("blocks")?;
    if sections.is_empty() {
        root.report("blocks", "no [[blocks]]: add at least one");
    }
    let known = motors.as_deref().unwrap_or_default();
    let blocks: Vec<_> = sections
        .into_iter()
        .map(|section| block(section, known))
        .collect();
    let (blocks, motors) = (blocks.into_iter().collect::<Option<_>>()?, motors?);
    Some(Plan {
        fingerprint: fingerprint(text, &motors),
        name: name?,
        seed: u64::from(seed?),
        motors,
        blocks,
    })
}

/// What decides about a run beside its index.
fn fingerprint(text: &str, motors: &[MotorPair]) -> u64 {
    let mut all = format!("{}\n{text}", env!("CARGO_PKG_VERSION"));
    for pair in motors {
        all += &pair.monitor.to_toml();
        all += &pair.plant.to_toml();
    }
    XxHash64::oneshot(0, all.as_bytes())
}

fn motors(
    document: &Document,
    root: &Section<'_>,
    folder: &Path,
) -> Result<Option<Vec<MotorPair>>, FileError> {
    let Some(sections) = root.sections("motors") else {
        return Ok(None);
    };
    if sections.is_empty() {
        root.report(
            "motors",
            format!("no [[motors]]: add [[motors]] with file = {MOTOR}"),
        );
    }
    let mut pairs = Some(Vec::new());
    for section in sections {
        let pair = motor_pair(document, &section, folder)?;
        section.finish();
        match (&mut pairs, pair) {
            (Some(pairs), Some(pair)) => pairs.push(pair),
            _ => pairs = None,
        }
    }
    Ok(pairs)
}

fn motor_pair(
    document: &Document,
    section: &Section<'_>,
    folder: &Path,
) -> Result<Option<MotorPair>, FileError> {
    let file = section.text("file", MOTOR);
    let plant = section.optional_text("plant").flatten();
    let Some(file) = file else {
        return Ok(None);
    };
    let plant_file = plant.unwrap_or_else(|| file.clone());
    let read = |key: &str, name: &str| {
        let path = folder.join(name);
        if path.is_file() {
            return MotorFile::read(path).map(Some);
        }
        let message = format!("there is no file {}: write {MOTOR}", path.display());
        section.report(key, message);
        Ok(None)
    };
    let (Some(monitor), Some(plant)) = (read("file", &file)?, read("plant", &plant_file)?) else {
        return Ok(None);
    };
    let stem = Path::new(&file).file_stem().unwrap_or_default();
    let pair = MotorPair {
        name: stem.to_string_lossy().into_owned(),
        monitor,
        plant,
        files: [&file, &plant_file].map(|name| folder.join(name)),
    };
    check::motor(section, &pair);
    Ok(document.is_clean().then_some(pair))
}

fn block(section: Section<'_>, motors: &[MotorPair]) -> Option<Block> {
    let block = block_values(&section, motors);
    section.finish();
    block
}

fn block_values(section: &Section<'_>, motors: &[MotorPair]) -> Option<Block> {
    let name = section.text("name", "what this block is called");
    let load = section.choice("load_kind", &LOADS);
    let start = section.choice_or("start", &STARTS, Start::Running);
    let in_motion = section.flag_or("in_motion", false);
    let healthy = section.number("healthy_s", &SECONDS, "healthy time of a run");
    let faulty = section.number_or("faulty_s", &SECONDS, 1.0);
    let draws = section.optional_number("draws", &REPEATS);
    let repetitions = section.integer_or("repetitions", &REPEATS, 1);
    let drawn = section.has("draws");
    let grids = DESCRIBED.each_ref().map(|axis| grid(section, axis, drawn));
    let faults = faults(section, name.as_deref().unwrap_or_default());
    if drawn && section.has("repetitions") {
        section.report(
            "repetitions",
            "is given together with draws: keep one of the two",
        );
    }
    let (cases, targets) = faults?;
    let grids: Vec<Grid> = grids.into_iter().collect::<Option<_>>()?;
    let block = Block {
        name: name?,
        load: load?,
        start: start?,
        in_motion: in_motion?,
        healthy_s: healthy?,
        faulty_s: faulty?,
        grids: grids.try_into().ok()?,
        drawn,
        repeats: draws?.map_or(u64::from(repetitions?), |draws| draws as u64),
        cases,
        targets,
    };
    check::block(section, &block, motors);
    Some(block)
}

/// A number, a list of numbers, or `{ from = .., to = .. }`.
fn grid(section: &Section<'_>, axis: &Described, drawn: bool) -> Option<Grid> {
    let entries = section.entries().iter();
    let value = entries
        .filter(|entry| entry.key == axis.key)
        .map(|entry| &entry.value)
        .next();
    match value {
        Some(Value::Array(_)) => {
            let values = section.list(axis.key, &axis.bounds)?;
            if values.is_empty() {
                section.report(axis.key, "is an empty list: write at least one value");
                return None;
            }
            Some(Grid::Values(values))
        }
        Some(Value::Table(_)) => {
            let range = section.optional_section(axis.key)??;
            let from = range.number("from", &axis.bounds, "the lower limit");
            let to = range.number("to", &axis.bounds, "the upper limit");
            range.finish();
            between(section, axis.key, from?, to?, drawn)
        }
        _ => {
            let value = section.number_or(axis.key, &axis.bounds, axis.default)?;
            Some(Grid::Values(vec![value]))
        }
    }
}

fn between(section: &Section<'_>, key: &str, from: f64, to: f64, drawn: bool) -> Option<Grid> {
    if !drawn {
        let remedy = "needs random draws: add draws = N to the block, or write a list of values";
        section.report(key, remedy);
        return None;
    }
    if from >= to {
        let message = format!("goes from {from} to {to}: write the smaller one first");
        section.report(key, message);
        return None;
    }
    Some(Grid::Between(from, to))
}

type Faults = (Vec<Case>, Vec<Target>);

fn faults(section: &Section<'_>, block: &str) -> Option<Faults> {
    let (mut cases, mut targets) = (Vec::new(), Vec::new());
    let mut complete = true;
    for fault in section.sections("faults")? {
        match read_fault(&fault, block) {
            Some((sizes, target)) => {
                cases.extend(sizes);
                targets.push(target);
            }
            None => complete = false,
        }
        fault.finish();
    }
    complete.then_some((cases, targets))
}

fn read_fault(section: &Section<'_>, block: &str) -> Option<(Vec<Case>, Target)> {
    let names: [(&str, &'static FaultKind); FAULTS.len()] =
        std::array::from_fn(|k| (FAULTS[k].name, &FAULTS[k]));
    let kind = section.choice("fault", &names);
    let sizes = section.list("change_percent", &PERCENT);
    let target = section.optional_number("target_percent", &TARGET);
    let limit = section.optional_text("limit");
    let pair_limit = section.optional_text("pair_limit");
    let (kind, sizes) = (kind?, sizes?);
    check::sizes(section, kind, &sizes)?;
    let target = Target {
        block: block.to_owned(),
        fault: kind.name.to_owned(),
        percent: target?,
        limit: limit?.unwrap_or_default(),
        pair_limit: pair_limit?.unwrap_or_default(),
    };
    let case = |percent| Case { kind, percent };
    Some((sizes.into_iter().map(case).collect(), target))
}

/// One grid for every axis.
const _: () = assert!(DESCRIBED.len() == AXES);
