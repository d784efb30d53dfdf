//! The demonstration as a person reads it.

use std::fmt::{Display, Formatter, Result};

use super::{Demo, FaultMatrix, FaultRow, HealthyRow};

impl Display for Demo {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let noise = 100.0 * self.noise_sigma_fraction_of_full_scale;
        let [r1, r2, r3, r4] = self.threshold_percent;
        writeln!(f, "{}", self.motor)?;
        writeln!(
            f,
            "simulated at 10 kHz, {noise:.1} % noise, {} bit, through the board's core; fault in at 2.0 s, out at 3.5 s",
            self.adc_bits
        )?;
        writeln!(
            f,
            "one set of thresholds: r1 {r1} %, r2 {r2} %, r3 {r3} %, r4 {r4} % of each residual's scale\n"
        )?;
        for matrix in &self.matrices {
            writeln!(f, "{matrix}")?;
        }
        healthy(f, &self.healthy)
    }
}

impl Display for FaultMatrix {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let plant = match self.plant {
            "linear" => "the paper's linear model",
            _ => "the full three-phase motor",
        };
        writeln!(
            f,
            "Table 1 on {plant}, {} frame: {} of {} patterns as published",
            self.frame, self.agree, self.of
        )?;
        writeln!(
            f,
            "  fault          r1 r2 r3 r4   published      r1       r2       r3       r4  %   this fault   delay"
        )?;
        self.table.iter().try_for_each(|row| writeln!(f, "{row}"))
    }
}

impl Display for FaultRow {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let lamps: Vec<&str> = self.measured.chars().map(lamp).collect();
        let mark = if self.agrees() { "=" } else { "x" };
        write!(
            f,
            "  {:<3} {:+4.0} %     {}    {mark} {}  ",
            self.fault,
            self.change_percent,
            lamps.join("  "),
            self.expected
        )?;
        for r in self.r_percent {
            write!(f, " {r:8.2}")?;
        }
        write!(f, "        {:3.0} %", 100.0 * self.probability)?;
        match self.delay_s {
            Some(delay) => write!(f, "   {:3.0} ms", 1000.0 * delay),
            None => write!(f, "        -"),
        }
    }
}

fn lamp(digit: char) -> &'static str {
    if digit == '1' { "●" } else { "○" }
}

fn healthy(f: &mut Formatter<'_>, rows: &[HealthyRow]) -> Result {
    writeln!(f, "Healthy full motor, exact parameters, load declared:")?;
    writeln!(
        f,
        "  load   frame             r1       r2       r3       r4  %   lamps lit"
    )?;
    for row in rows {
        write!(f, "  {:3.0} %  {:<11}", row.load_percent, row.frame)?;
        for r in row.r_percent {
            write!(f, " {r:8.2}")?;
        }
        let lit = if row.lit.is_empty() {
            "none".to_owned()
        } else {
            row.lit.join(" ")
        };
        writeln!(f, "      {lit}")?;
    }
    let worst = |frame: &str| {
        let of_frame = rows.iter().filter(|row| row.frame == frame);
        of_frame.fold(0.0_f64, |worst, row| worst.max(row.r_percent[0].abs()))
    };
    write!(
        f,
        "Across these loads r1 of the healthy motor reaches {:.2} % in the voltage frame and {:.2} % in the rotor-flux frame.",
        worst("voltage"),
        worst("rotor-flux")
    )
}
