//! The motors of a configuration.

use std::collections::HashMap;
use std::path::Path;

use document::{Bounds, Section};
use fleet::{MotorId, MotorInfo};

use super::{LinkConfig, MotorConfig};

const UNIT: Bounds = Bounds::between(1.0, 247.0, "");
const LOG: Bounds = Bounds::between(1.0, 1_000.0, "");
/// Digits of a serial number of 96 bits.
const SERIAL_DIGITS: usize = 24;
/// Below this similarity (Jaro-Winkler, 0 to 1) two names are two names, not one misspelt.
const SIMILAR: f64 = 0.85;

/// Reads all of them. `links` is empty where no link could be read; a motor's link is not judged then. Relative paths begin in
/// `folder`.
pub(super) fn read(
    root: &Section<'_>,
    links: &[LinkConfig],
    folder: &Path,
) -> Option<Vec<MotorConfig>> {
    let sections = root.sections("motor")?;
    if sections.is_empty() {
        root.report(
            "motor",
            "is missing: add a section [[motor]] for each motor, with name, link and unit",
        );
        return None;
    }
    let places: HashMap<&str, usize> = (links.iter().enumerate())
        .map(|(k, link)| (link.name.as_str(), k))
        .collect();
    let mut seen = Seen::default();
    let mut motors = Vec::with_capacity(sections.len());
    for section in sections {
        let motor = of_section(&section, links, &places, folder);
        if let Some(motor) = &motor {
            seen.take(&section, motor, links);
        }
        section.finish();
        motors.push(motor);
    }
    motors.into_iter().collect()
}

/// Names and addresses so far, with their lines.
#[derive(Default)]
struct Seen {
    names: HashMap<MotorId, usize>,
    /// Names in lower case, each as it was written.
    folded: HashMap<String, MotorId>,
    units: HashMap<(usize, u8), usize>,
}

impl Seen {
    /// Reports what another motor has already.
    fn take(&mut self, section: &Section<'_>, motor: &MotorConfig, links: &[LinkConfig]) {
        let line = section.line();
        if let Some(before) = self.names.insert(motor.info.id.clone(), line) {
            let message = format!(
                "\"{}\" is the motor of line {before}, too: give each motor a name of its own",
                motor.info.id
            );
            section.report("name", message);
        }
        let folded = motor.info.id.as_str().to_ascii_lowercase();
        let before = self.folded.insert(folded, motor.info.id.clone());
        if let Some(before) = before.filter(|before| *before != motor.info.id) {
            let message = format!(
                "\"{}\" and \"{before}\" differ in case only: people and brokers take them for one motor; rename one of them",
                motor.info.id
            );
            section.report("name", message);
        }
        let place = (motor.link, motor.unit);
        let (Some(link), Some(before)) = (links.get(motor.link), self.units.insert(place, line))
        else {
            return;
        };
        let name = &link.name;
        match link.kind.is_asked() {
            true => section.report("unit", format!(
                "{} on link \"{name}\" is the motor of line {before}, too: each board of a link has its own address", motor.unit
            )),
            false => section.report("link", format!(
                "\"{name}\" carries the frames of one board, and that is the motor of line {before}: give this motor a link of its own"
            )),
        }
    }
}

fn of_section(
    section: &Section<'_>,
    links: &[LinkConfig],
    places: &HashMap<&str, usize>,
    folder: &Path,
) -> Option<MotorConfig> {
    let id = name(section);
    let link = section.text("link", "the name of its [[link]]");
    let link = link.and_then(|name| place(section, &name, links, places));
    let asked = link
        .and_then(|k| links.get(k))
        .is_none_or(|link| link.kind.is_asked());
    let unit = match asked {
        true => section.integer("unit", &UNIT, "the board's address on its line"),
        false => Some(0),
    };
    let serial = serial(section);
    let log = section.integer_or("log", &LOG, 1);
    let [title, nameplate, site, motor_file] =
        ["title", "nameplate", "place", "motor_file"].map(|key| section.optional_text(key));
    let id = id?;
    let (link, unit) = (link?, unit?);
    let to = links.get(link)?;
    Some(MotorConfig {
        info: MotorInfo {
            title: title?.unwrap_or_else(|| id.to_string()),
            nameplate: nameplate?.unwrap_or_default(),
            place: site?.unwrap_or_default(),
            link: match asked {
                true => format!("{} unit {unit}", to.kind),
                false => to.kind.to_string(),
            },
            motor_file: motor_file?.map(|file| absolute(folder, &file)),
            id,
        },
        link,
        unit: unit as u8,
        serial: serial?,
        log: log?,
    })
}

/// Who reads the store knows nothing of the configuration's folder, nor of the folder in which the gateway was started.
fn absolute(folder: &Path, file: &str) -> String {
    let path = folder.join(file);
    let path = std::path::absolute(&path).unwrap_or(path);
    path.display().to_string()
}

fn name(section: &Section<'_>) -> Option<MotorId> {
    let text = section.text("name", "the motor's name")?;
    let name = text.parse();
    name.map_err(|error| section.report("name", format!("{error}")))
        .ok()
}

fn place(
    section: &Section<'_>,
    name: &str,
    links: &[LinkConfig],
    places: &HashMap<&str, usize>,
) -> Option<usize> {
    let place = places.get(name).copied();
    if place.is_none() && !links.is_empty() {
        let close = links
            .iter()
            .map(|link| (strsim::jaro_winkler(name, &link.name), &link.name))
            .filter(|(similarity, _)| *similarity >= SIMILAR)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let remedy = match close {
            Some((_, meant)) => format!("did you mean \"{meant}\"?"),
            None => "add a [[link]] of this name, or use one that is there".to_owned(),
        };
        section.report(
            "link",
            format!("\"{name}\" is no link of this file: {remedy}"),
        );
    }
    place
}

fn serial(section: &Section<'_>) -> Option<Option<String>> {
    let Some(text) = section.optional_text("serial")? else {
        return Some(None);
    };
    let sound = text.len() == SERIAL_DIGITS && text.bytes().all(|byte| byte.is_ascii_hexdigit());
    if !sound {
        let message = format!(
            "\"{text}\" is not a serial number: write its 24 hexadecimal digits, as `drivemon board identify` shows them"
        );
        section.report("serial", message);
    }
    sound.then(|| Some(text.to_ascii_lowercase()))
}
