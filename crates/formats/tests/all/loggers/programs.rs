//! Programs: spreadsheets, simulators, scripts.

use super::instruments::rpm;
use super::text::{comma, fixed, grouped, table};
use super::wave::Instant;
use super::{Device, Signal};

const ALL: &[(Signal, f64)] = &[(Signal::Voltages, 5e-7), (Signal::Currents, 5e-7)];

fn electrical(x: &Instant, number: impl Fn(f64) -> String) -> Vec<String> {
    x.v.iter().chain(&x.i).map(|x| number(*x)).collect()
}

pub(super) fn devices() -> Vec<Device> {
    vec![
        Device {
            name: "MATLAB writetable",
            source: "MathWorks, writetable: names in the first row, commas",
            file: "matlab.txt",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "Time,Va,Vb,Vc,Ia,Ib,Ic,Speed_rpm\n";
                let digits = |x: f64| format!("{x}");
                table(head, wave, ",", "\n", |x| {
                    [
                        vec![digits(x.t)],
                        electrical(x, digits),
                        vec![digits(rpm(x))],
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[
                (Signal::Voltages, 1e-12),
                (Signal::Currents, 1e-12),
                (Signal::Speed, 1e-9),
            ],
            clock_s: 1e-15,
            said: &[
                "column Time is t, by its name",
                "column Va is va, by its name",
                "speed = Speed_rpm in rpm, as the file declares",
            ],
        },
        Device {
            name: "pandas to_csv",
            source: "pandas, DataFrame.to_csv: an index without a name in the first column",
            file: "pandas.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = ",t,va,vb,vc,ia,ib,ic\n";
                let digits = |x: f64| format!("{x}");
                table(head, wave, ",", "\n", |x| {
                    [vec![x.k.to_string(), digits(x.t)], electrical(x, digits)].concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Voltages, 1e-12), (Signal::Currents, 1e-12)],
            clock_s: 1e-15,
            said: &["column 1 is not used"],
        },
        Device {
            name: "numpy savetxt",
            source: "NumPy, savetxt: header behind `# `, blanks, %.18e",
            file: "numpy.txt",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "# t va vb vc ia ib ic\n";
                let digits = |x: f64| format!("{x:.18e}");
                table(head, wave, " ", "\n", |x| {
                    [vec![digits(x.t)], electrical(x, digits)].concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Voltages, 1e-12), (Signal::Currents, 1e-12)],
            clock_s: 1e-15,
            said: &["separated by blanks", "a comment, names the columns"],
        },
        Device {
            name: "Excel, German",
            source: "Excel, CSV UTF-8 in a German locale: mark, semicolons, decimal comma, points between thousands, empty last rows",
            file: "excel_de.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "\u{feff}Zeit (ms);Ua (mV);Ub (mV);Uc (mV);I1 (mA);I2 (mA);I3 (mA)\n";
                let milli = |x: f64| grouped(1e3 * x, 2, ".", ",");
                let text = table(head, wave, ";", "\r\n", |x| {
                    [vec![comma(1e3 * x.t, 1)], electrical(x, milli)].concat()
                });
                (text + ";;;;;;\r\n;;;;;;\r\n").into_bytes()
            },
            channels: &[(Signal::Voltages, 5e-6), (Signal::Currents, 5e-6)],
            clock_s: 5e-5,
            said: &[
                "separated by `;`",
                "written 3,7",
                "`.` stands between thousands",
                "have empty cells only",
                "in mA, as the file declares",
            ],
        },
        Device {
            name: "Excel, US",
            source: "Excel, CSV in a US locale: numbers with thousands are quoted",
            file: "excel_us.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "Time (s),Voltage A (mV),Voltage B (mV),Voltage C (mV),Current A (A),Current B (A),Current C (A)\n";
                let quoted = |x: f64| match x.abs() < 1.0 {
                    true => fixed(1e3 * x, 1),
                    false => format!("\"{}\"", grouped(1e3 * x, 1, ",", ".")),
                };
                table(head, wave, ",", "\r\n", |x| {
                    [
                        vec![fixed(x.t, 4)],
                        x.v.map(quoted).to_vec(),
                        x.i.map(|x| fixed(x, 6)).to_vec(),
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Voltages, 5.1e-5), (Signal::Currents, 5e-7)],
            clock_s: 5e-5,
            said: &[
                "`,` stands between thousands",
                "in mV, as the file declares",
            ],
        },
        Device {
            name: "LibreOffice Calc",
            source: "LibreOffice, Export Text File with \"Quote all text cells\"",
            file: "calc.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "\"t\";\"vab\";\"vcb\";\"ia\";\"ib\";\"ic\"\n";
                table(head, wave, ";", "\n", |x| {
                    let [ab, bc, _] = x.line();
                    [
                        vec![comma(x.t, 6), comma(ab, 6), comma(-bc, 6)],
                        x.i.map(|x| comma(x, 6)).to_vec(),
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Voltages, 1e-6), (Signal::Currents, 5e-7)],
            clock_s: 5e-7,
            said: &[
                "separated by `;`",
                "written 3,7",
                "computed from line voltages",
            ],
        },
        Device {
            name: "OpenModelica",
            source: "OpenModelica User's Guide, outputFormat csv: quoted names, trailing separator",
            file: "motor_res.csv",
            step_s: 1e-4,
            flag: Some("--columns t,va,vb,vc,ia,ib,ic,speed"),
            write: |wave| {
                let head = "\"time\",\"aimc.vs[1]\",\"aimc.vs[2]\",\"aimc.vs[3]\",\"aimc.is[1]\",\"aimc.is[2]\",\"aimc.is[3]\",\"aimc.wMechanical\",\n";
                let digits = |x: f64| format!("{x}");
                table(head, wave, ",", "\n", |x| {
                    [
                        vec![digits(x.t)],
                        electrical(x, digits),
                        vec![digits(x.speed), String::new()],
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[
                (Signal::Voltages, 1e-12),
                (Signal::Currents, 1e-12),
                (Signal::Speed, 1e-12),
            ],
            clock_s: 1e-15,
            said: &["aimc.vs[1] is va"],
        },
        Device {
            name: "PLECS",
            source: "PLECS, scope export as CSV: Time and quoted signal names; by memory",
            file: "plecs.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "\"Time / s\",\"Va\",\"Vb\",\"Vc\",\"Ia\",\"Ib\",\"Ic\"\n";
                table(head, wave, ",", "\n", |x| {
                    [
                        vec![format!("{:.15e}", x.t)],
                        electrical(x, |x| format!("{x:.15e}")),
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Voltages, 1e-12), (Signal::Currents, 1e-12)],
            clock_s: 1e-15,
            said: &["column Va is va, by its name"],
        },
        Device {
            name: "Simulink Data Inspector",
            source: "MathWorks, Import Data from a CSV File: the first column is called time",
            file: "sdi.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "time,Vab,Vbc,Vca,I_a,I_b,I_c,wm\n";
                let digits = |x: f64| format!("{x}");
                table(head, wave, ",", "\n", |x| {
                    let v = x.line().map(digits).to_vec();
                    [
                        vec![digits(x.t)],
                        v,
                        x.i.map(digits).to_vec(),
                        vec![digits(x.speed)],
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[
                (Signal::Voltages, 1e-12),
                (Signal::Currents, 1e-12),
                (Signal::Speed, 1e-12),
            ],
            clock_s: 1e-15,
            said: &[
                "column Vab is vab, by its name",
                "computed from line voltages",
                "column wm is speed, by its name",
            ],
        },
        Device {
            name: "ASAM/CANape ASCII",
            source: "names, then units, semicolons; by memory",
            file: "canape.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "time;i_u;i_v;i_w;torque;n\n[s];[A];[A];[A];[Nm];[rpm]\n";
                table(head, wave, ";", "\r\n", |x| {
                    [
                        vec![fixed(x.t, 6)],
                        x.i.map(|x| fixed(x, 6)).to_vec(),
                        vec![fixed(x.torque, 5), fixed(rpm(x), 4)],
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[
                (Signal::Currents, 5e-7),
                (Signal::Torque, 5e-6),
                (Signal::Speed, 1e-5),
            ],
            clock_s: 5e-7,
            said: &[
                "line 2 gives their units",
                "column i_u is ia, by its name",
                "column n is speed, by its name",
            ],
        },
        Device {
            name: "two files joined",
            source: "`cat a.csv b.csv`: the header appears twice",
            file: "joined.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "t,va,vb,vc,ia,ib,ic\n";
                let text = table(head, wave, ",", "\n", |x| {
                    [vec![fixed(x.t, 6)], electrical(x, |x| fixed(x, 6))].concat()
                });
                text.replacen("0.020000,", &format!("{head}0.020000,"), 1)
                    .into_bytes()
            },
            channels: ALL,
            clock_s: 5e-7,
            said: &["1 lines among the samples repeat the header"],
        },
    ]
}
