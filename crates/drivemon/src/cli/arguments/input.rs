//! Flags that say how a recording is to be read, shared by all commands that read one.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use motor::MotorFile;
use recording::{Flags, Follows, Mapping, Recording, Source};

use crate::cli::printing::failure::Failure;
use crate::cli::printing::output::DASH;
use crate::cli::printing::progress;
use crate::cli::printing::terminal::complain;
use report::study::effects_fit;

/// How the columns of the file become channels in SI units. A sidecar `x.toml` beside `x.csv.gz` says the same things.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "How to read the recording")]
pub struct InputArgs {
    /// Read a channel from another column, e.g. `ic=ic2` or `speed=speed_raw`; line voltages are `vab=U12`, or `vba=U21` the
    /// other way round
    #[arg(long, value_name = "CHANNEL=COLUMN")]
    column: Vec<String>,
    /// The columns in their order, with `-` for one that is not used, e.g. `t,va,vb,vc,-,ia`; for a file without names, or
    /// with names that mean nothing (CH1)
    #[arg(long, value_name = "CHANNEL,...", allow_hyphen_values = true)]
    columns: Option<String>,
    /// The sensor behind a column, as its plate says: `ia=100mV/A`, `va=1000:1`, `speed=60V/1000rpm`; `i=` means all currents,
    /// `v=` all voltages. The column then holds volts, or what --unit says
    #[arg(long, value_name = "CHANNEL=SCALE")]
    sensor: Vec<String>,
    /// Unit of a channel, e.g. `speed=rpm` or `ia=mA`; `speed=us/pulse` for the time between pulses of an encoder
    #[arg(long, value_name = "CHANNEL=UNIT")]
    unit: Vec<String>,
    /// Factor on a channel, applied after the offset: `scale x (raw - offset)`; `speed=unknown` lets compare, explain and
    /// adopt fit it
    #[arg(long, value_name = "CHANNEL=FACTOR")]
    scale: Vec<String>,
    /// Raw reading of a channel at zero
    #[arg(long, value_name = "CHANNEL=VALUE", allow_hyphen_values = true)]
    offset: Vec<String>,
    /// How much later than its row a channel was sampled, e.g. `ia=11.55us` of a recorder that samples one channel after the
    /// other; negative where a filter delays it
    #[arg(long, value_name = "CHANNEL=TIME", allow_hyphen_values = true)]
    delay: Vec<String>,
    /// Sampling rate of a file without a time column, Hz
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    /// The columns va vb vc hold line voltages v_ab v_bc v_ca
    #[arg(long)]
    line_voltages: bool,
    /// Leave out rows with empty or NaN cells instead of refusing the file
    #[arg(long)]
    skip_missing: bool,
    /// What separates the columns, where the file does not show it: `,` `;` `|` `tab` `space`
    #[arg(long, value_name = "CHARACTER")]
    delimiter: Option<String>,
    /// Numbers are written 3,7, where the file does not show it
    #[arg(long)]
    decimal_comma: bool,
    /// Separator of thousands, where `1,234` or `1.234` could be two numbers: `.` `,` `'` `space` `none`
    #[arg(long, value_name = "CHARACTER")]
    thousands: Option<String>,
    /// Order of day and month in dates such as 3/4/2024: `dmy` or `mdy`
    #[arg(long, value_name = "ORDER")]
    date_order: Option<String>,
    /// Pulses of the encoder in one turn, where the speed column holds its counts or the time between them
    #[arg(long, value_name = "N")]
    pulses_per_revolution: Option<u32>,
    /// The sidecar to use instead of the one beside the recording
    #[arg(long, value_name = "FILE")]
    sidecar: Option<PathBuf>,
    /// Write how the file was read into the sidecar beside it, so that no flag is needed the next time; an existing one is kept
    #[arg(long)]
    write_sidecar: bool,
}

/// What errors call standard input.
const STDIN: &str = "standard input";

impl InputArgs {
    /// The flags as they were typed, each with a blank before it: a command that reads the same file needs them too.
    pub fn typed(&self) -> String {
        self.flags().typed()
    }

    /// What the flags say.
    ///
    /// # Errors
    /// A flag that cannot be understood.
    pub fn mapping(&self) -> Result<Mapping, Failure> {
        Ok(self.flags().mapping()?)
    }

    /// The flags of a command that reads many files.
    ///
    /// # Errors
    /// `--write-sidecar`.
    pub fn unwritten(&self) -> Result<Flags, Failure> {
        match self.write_sidecar {
            false => Ok(self.flags()),
            true => Err(Failure::Usage(
                "--write-sidecar: this command writes no sidecars; leave it out".to_owned(),
            )),
        }
    }

    /// The flags by themselves.
    pub fn flags(&self) -> Flags {
        Flags {
            column: self.column.clone(),
            columns: self.columns.clone(),
            sensor: self.sensor.clone(),
            unit: self.unit.clone(),
            scale: self.scale.clone(),
            offset: self.offset.clone(),
            delay: self.delay.clone(),
            sample_rate: self.sample_rate,
            line_voltages: self.line_voltages,
            skip_missing: self.skip_missing,
            delimiter: self.delimiter.clone(),
            decimal_comma: self.decimal_comma,
            thousands: self.thousands.clone(),
            date_order: self.date_order.clone(),
            pulses_per_revolution: self.pulses_per_revolution,
            sidecar: self.sidecar.clone(),
        }
    }

    /// The sidecar that is named instead of the one beside the recording.
    pub fn sidecar(&self) -> Option<&PathBuf> {
        self.sidecar.as_ref()
    }

    /// Reads a recording or load table with a progress bar; `-` is standard input.
    ///
    /// # Errors
    /// Whatever is wrong with flags, file or sidecar.
    pub fn read(&self, path: &Path) -> Result<Source, Failure> {
        let mapping = self.mapping()?;
        let bar = progress::bar("reading", 0);
        let mut progress = progress::reading(&bar);
        let source = match path.as_os_str() == DASH {
            true => formats::read_stream(STDIN, std::io::stdin(), &mapping, &mut progress),
            false => formats::read_any(path, &mapping, &mut progress),
        }?;
        bar.finish_and_clear();
        tell_assumptions(&source);
        if self.write_sidecar {
            write_sidecar(path, &source)?;
        }
        Ok(source)
    }

    /// Reads a recording piece by piece with a progress bar called `title`; `take` gets each piece when the one before is
    /// done, and what follows it. The last piece comes back, and a load table as a whole.
    ///
    /// # Errors
    /// Whatever is wrong with flags, file or sidecar, and what `take` returns.
    pub fn read_in_pieces(
        &self,
        path: &Path,
        title: &'static str,
        take: &mut dyn FnMut(&Recording, Follows) -> Result<(), Failure>,
    ) -> Result<Source, Failure> {
        let mapping = self.mapping()?;
        let bar = progress::bar(title, 0);
        let mut progress = progress::reading(&bar);
        let rows = formats::PIECE_ROWS;
        let read = match path.as_os_str() == DASH {
            true => {
                let stdin = std::io::stdin();
                formats::read_stream_in_pieces(STDIN, stdin, &mapping, rows, &mut progress, take)
            }
            false => formats::read_in_pieces(path, &mapping, rows, &mut progress, take),
        }?;
        bar.finish_and_clear();
        tell_assumptions(&read);
        if self.write_sidecar {
            write_sidecar(path, &read)?;
        }
        Ok(read)
    }
}

/// One line on standard error for each thing that was assumed: standard output is the answer's.
fn tell_assumptions(source: &Source) {
    let (name, assumptions) = match source {
        Source::Recording(recording) => (recording.name(), &recording.assumptions),
        Source::LoadTable(table) => (table.name(), &table.assumptions),
    };
    for assumption in assumptions {
        complain(format_args!("{name}: assumed: {assumption}"));
    }
}

/// Writes the sidecar of a recording, where it has none.
fn write_sidecar(path: &Path, source: &Source) -> Result<(), Failure> {
    let usage = |message: String| Err(Failure::Usage(message));
    let Source::Recording(recording) = source else {
        return usage("--write-sidecar: a load table has no sidecar".to_owned());
    };
    if path.as_os_str() == DASH {
        return usage(
            "--write-sidecar: standard input has no place for a sidecar; name a file".to_owned(),
        );
    }
    let sidecar = recording::sidecar_path(path);
    if sidecar.exists() {
        let name = sidecar.display();
        return usage(format!(
            "--write-sidecar: {name} exists and is kept; rename or remove it first"
        ));
    }
    let text = formats::reading_text(recording);
    let written = formats::write_whole(&sidecar, |file| file.write_all(text.as_bytes()));
    written.or_else(|error| {
        usage(format!(
            "--write-sidecar: {} cannot be written: {error}",
            sidecar.display()
        ))
    })
}

/// Reads and validates a motor file, its effects included.
///
/// # Errors
/// Everything that is wrong with it.
pub fn read_motor(path: &Path) -> Result<MotorFile, Failure> {
    let motor = MotorFile::read(path)?;
    effects_fit(&path.display().to_string(), &motor).map_err(Failure::Usage)?;
    Ok(motor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Reading {
        #[command(flatten)]
        input: InputArgs,
    }

    #[test]
    fn the_flags_are_repeated_as_they_were_typed() {
        let line = "x --column ic=ic2 --column speed=n --sensor i=100mV/A --unit speed=rpm --scale speed=unknown --offset va=-4.1 \
                    --delay ia=11.55us --sample-rate 5000 --columns t,va,-,ia --delimiter \";\" --thousands none --date-order dmy --pulses-per-revolution 1024 --sidecar a.toml --line-voltages \
                    --skip-missing --decimal-comma";
        let words = line.split(' ').map(|word| word.trim_matches('"'));
        let typed = Reading::parse_from(words).input.typed();
        assert_eq!(format!("x{typed}"), line);
        assert_eq!(InputArgs::default().typed(), "");
    }
}
