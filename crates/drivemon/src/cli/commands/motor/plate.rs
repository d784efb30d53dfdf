//! A nameplate from a file, flags and questions.

use std::io::{BufRead, IsTerminal, Write};
use std::path::PathBuf;

use clap::Args;
use nameplate::plate::{PlateFile, QUESTIONS, Question};

use crate::cli::printing::failure::Failure;

/// The nameplate: from a file, from flags, which win over the file, or from questions.
#[derive(Debug, Args)]
pub struct PlateArgs {
    /// Plate as TOML: power_kw = 5.5, voltage_volt = 400, ... (the flags below without their dashes)
    #[arg(long, value_name = "PLATE.toml")]
    plate: Option<PathBuf>,
    /// Rated shaft power, kW
    #[arg(long, value_name = "KW", conflicts_with = "power_hp")]
    power_kw: Option<String>,
    /// Rated shaft power, hp
    #[arg(long, value_name = "HP")]
    power_hp: Option<String>,
    /// Line voltage, V rms
    #[arg(long, value_name = "V")]
    voltage_volt: Option<String>,
    /// Frequency, Hz
    #[arg(long, value_name = "HZ")]
    frequency_hz: Option<String>,
    /// Rated speed, rpm
    #[arg(long, value_name = "RPM")]
    speed_rpm: Option<String>,
    /// Rated line current, A rms
    #[arg(long, value_name = "A")]
    current_amp: Option<String>,
    /// Power factor (cos phi) at rated load
    #[arg(long, value_name = "PF")]
    power_factor: Option<String>,
    /// Efficiency at rated load, percent
    #[arg(long, value_name = "PERCENT")]
    efficiency_percent: Option<String>,
    /// Breakdown torque over rated torque (Mk/Mn, Tmax/Tn)
    #[arg(long, value_name = "RATIO")]
    breakdown_torque_ratio: Option<String>,
    /// Locked-rotor torque over rated torque (Ma/Mn, Tst/Tn)
    #[arg(long, value_name = "RATIO")]
    locked_rotor_torque_ratio: Option<String>,
    /// Locked-rotor current over rated current (Ia/In, Ist/In)
    #[arg(long, value_name = "RATIO")]
    locked_rotor_current_ratio: Option<String>,
    /// NEMA code letter, which is the locked-rotor current
    #[arg(
        long,
        value_name = "LETTER",
        conflicts_with = "locked_rotor_current_ratio"
    )]
    nema_code: Option<String>,
    /// Connection at this voltage: star or delta
    #[arg(long, value_name = "star|delta")]
    connection: Option<String>,
    /// Inertia of everything on the shaft, kg m2
    #[arg(long, value_name = "KG_M2")]
    inertia_kg_m2: Option<String>,
    /// Bars of the cage, where they are known: the slot harmonics then give the speed
    #[arg(long, value_name = "BARS")]
    rotor_bars: Option<String>,
    /// Resistance between two terminals, measured with direct current, ohm (mean of the three pairs)
    #[arg(long, value_name = "OHM")]
    dc_resistance_ohm: Option<String>,
    /// Temperature of the winding at that measurement, degC; 20 where it is not given
    #[arg(
        long,
        value_name = "DEGC",
        requires = "dc_resistance_ohm",
        allow_hyphen_values = true
    )]
    dc_resistance_degc: Option<String>,
    /// What people call the motor
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Ask for every number that is not given
    #[arg(long)]
    ask: bool,
}

impl PlateArgs {
    /// The plate; questions go to the terminal where nothing at all was given, or `--ask` was.
    ///
    /// # Errors
    /// A file that cannot be read, or text that is not a number, with the flag or the line.
    pub fn read(&self) -> Result<PlateFile, Failure> {
        let mut file = match &self.plate {
            Some(path) => {
                let label = path.display().to_string();
                let text = document::read_text(path)?;
                PlateFile::parse(&text, &label).map_err(Failure::Usage)?
            }
            None => PlateFile::default(),
        };
        self.set(&mut file)?;
        let nothing = file == PlateFile::default();
        if self.ask || (nothing && std::io::stdin().is_terminal()) {
            ask(&mut file)?;
        } else if nothing {
            return Err(Failure::Usage(
                "no plate: give --plate PLATE.toml, flags such as --power-kw 5.5, or --ask"
                    .to_owned(),
            ));
        }
        Ok(file)
    }

    /// The first flag of a plate that was given.
    pub fn given(&self) -> Option<String> {
        let flags = self.flags().into_iter();
        let mut typed = flags.filter_map(|(key, text)| text.map(|_| key));
        let flag = match (&self.plate, self.ask) {
            (Some(_), _) => Some("plate"),
            (None, true) => Some("ask"),
            (None, false) => typed.next(),
        };
        flag.map(|key| format!("--{}", key.replace('_', "-")))
    }

    /// A plate from elsewhere with the flags over it.
    ///
    /// # Errors
    /// Text that is not a number, with the flag.
    pub fn over(&self, mut file: PlateFile) -> Result<PlateFile, Failure> {
        self.set(&mut file)?;
        Ok(file)
    }

    fn set(&self, file: &mut PlateFile) -> Result<(), Failure> {
        for (key, text) in self.flags() {
            if let Some(text) = text {
                let flag = key.replace('_', "-");
                file.set(key, text)
                    .map_err(|problem| Failure::Usage(format!("--{flag}: {problem}")))?;
            }
        }
        Ok(())
    }

    /// Files that are read.
    pub fn file(&self) -> Option<&PathBuf> {
        self.plate.as_ref()
    }

    /// Keys and texts; the code letter last, since it needs power, voltage and current.
    fn flags(&self) -> [(&'static str, Option<&String>); 18] {
        [
            ("name", self.name.as_ref()),
            ("power_kw", self.power_kw.as_ref()),
            ("power_hp", self.power_hp.as_ref()),
            ("voltage_volt", self.voltage_volt.as_ref()),
            ("frequency_hz", self.frequency_hz.as_ref()),
            ("speed_rpm", self.speed_rpm.as_ref()),
            ("current_amp", self.current_amp.as_ref()),
            ("power_factor", self.power_factor.as_ref()),
            ("efficiency_percent", self.efficiency_percent.as_ref()),
            (
                "breakdown_torque_ratio",
                self.breakdown_torque_ratio.as_ref(),
            ),
            (
                "locked_rotor_torque_ratio",
                self.locked_rotor_torque_ratio.as_ref(),
            ),
            (
                "locked_rotor_current_ratio",
                self.locked_rotor_current_ratio.as_ref(),
            ),
            ("connection", self.connection.as_ref()),
            ("inertia_kg_m2", self.inertia_kg_m2.as_ref()),
            ("rotor_bars", self.rotor_bars.as_ref()),
            ("dc_resistance_ohm", self.dc_resistance_ohm.as_ref()),
            ("dc_resistance_degc", self.dc_resistance_degc.as_ref()),
            ("nema_code", self.nema_code.as_ref()),
        ]
    }
}

/// Asks for what is missing; an empty answer leaves it out, a wrong one is asked again.
fn ask(file: &mut PlateFile) -> Result<(), Failure> {
    let mut lines = std::io::stdin().lock().lines();
    for question in QUESTIONS.iter().filter(|question| is_asked(question)) {
        if has(file, question.key) {
            continue;
        }
        let Question {
            words,
            range,
            missing,
            ..
        } = question;
        let unit = match question.unit {
            "" => String::new(),
            unit => format!(", {unit}"),
        };
        loop {
            eprint!("{words}{unit} [{range}; empty: {missing}]: ");
            let _ = std::io::stderr().flush();
            let Some(answer) = lines.next().transpose().unwrap_or(None) else {
                return Ok(());
            };
            let answer = answer.trim().replace(',', ".");
            if answer.is_empty() {
                break;
            }
            match file.set(question.key, &answer) {
                Ok(()) => break,
                Err(problem) => eprintln!("  {problem}"),
            }
        }
    }
    Ok(())
}

/// Numbers of plates and catalogues, and the connection; what else is known has flags.
fn is_asked(question: &Question) -> bool {
    question.key == "connection" || nameplate::COLUMN_KEYS.contains(&question.key)
}

fn has(file: &PlateFile, key: &str) -> bool {
    let place = nameplate::COLUMN_KEYS
        .iter()
        .position(|known| *known == key);
    place.is_some_and(|place| file.plate.numbers()[place].is_some())
}
