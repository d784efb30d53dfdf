//! Recorders, power analysers and data acquisition systems.

use super::text::{clock, comma, fixed, grouped, scientific, table, utf16, windows_1252};
use super::wave::Instant;
use super::{Device, Signal};

pub(super) fn devices() -> Vec<Device> {
    vec![
        Device {
            name: "Fluke 43x PowerLog",
            source: "tab-separated text with a date and a time column; by memory",
            file: "fluke.txt",
            step_s: 1e-3,
            flag: None,
            write: fluke,
            channels: &[(Signal::Voltages, 5e-3), (Signal::Currents, 5e-4)],
            clock_s: 5e-4,
            said: &[
                "separated by tabs",
                "t counts from the first time of day in Time",
                "column Voltage L1N is va, by its name",
                "column Date is not used",
            ],
        },
        Device {
            name: "Hioki MR/PW",
            source: "quoted titles with units in brackets, quoted numbers; by memory",
            file: "hioki.CSV",
            step_s: 2e-4,
            flag: None,
            write: hioki,
            channels: &[(Signal::Voltages, 5e-4), (Signal::Currents, 5e-5)],
            clock_s: 5e-6,
            said: &["are above the table", "column U1(V) is va, by its name"],
        },
        Device {
            name: "Yokogawa DL850",
            source: "block of labels TraceName, VUnit, HResolution, samples behind an empty first cell; by memory",
            file: "yokogawa_dl.csv",
            step_s: 1e-4,
            flag: None,
            write: yokogawa_dl,
            channels: &[(Signal::Voltages, 5e-4), (Signal::Currents, 5e-7)],
            clock_s: 1e-9,
            said: &[
                "10000 samples a second, as `HResolution`",
                "column Ua is va, by its name",
                "ia = Ia in mA, as the file declares",
            ],
        },
        Device {
            name: "Yokogawa WT5000 waveform",
            source: "Time,U1,I1,... of each element; by memory",
            file: "yokogawa_wt.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "\"Time\",\"U1\",\"U2\",\"U3\",\"I1\",\"I2\",\"I3\"\n\"s\",\"V\",\"V\",\"V\",\"A\",\"A\",\"A\"\n";
                table(head, wave, ",", "\r\n", |x| {
                    let v = x.v.map(|x| scientific(x, 5, 2));
                    let i = x.i.map(|x| scientific(x, 5, 2));
                    [vec![scientific(x.t, 5, 2)], v.to_vec(), i.to_vec()].concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Voltages, 5e-4), (Signal::Currents, 5e-6)],
            clock_s: 5e-8,
            said: &[
                "line 2 gives their units",
                "column U1 is va, by its name",
                "column I3 is ic, by its name",
            ],
        },
        Device {
            name: "Dewesoft X export",
            source: "tab-separated text, decimal comma, names with units in brackets; by memory",
            file: "dewesoft.txt",
            step_s: 5e-5,
            flag: None,
            write: dewesoft,
            channels: &[
                (Signal::Voltages, 5e-5),
                (Signal::Currents, 5e-6),
                (Signal::Speed, 1.1e-4),
                (Signal::Torque, 5e-5),
            ],
            clock_s: 5e-8,
            said: &[
                "the text is windows-1252",
                "separated by tabs",
                "written 3,7",
                "speed = Drehzahl [1/min] in rpm, as the file declares",
            ],
        },
        Device {
            name: "Gantner Q.station",
            source: "semicolons, date stamps with a decimal comma, trailing separator; by memory",
            file: "gantner.csv",
            step_s: 1e-3,
            flag: None,
            write: |wave| {
                let head = "Timestamp;U_L1 [V];U_L2 [V];U_L3 [V];I_L1 [A];I_L2 [A];I_L3 [A];Drehzahl [U/min];\n";
                table(head, wave, ";", "\r\n", |x| {
                    let stamp = format!("31.12.2023 {}", clock(86_399.9, x.t, 3).replace('.', ","));
                    let stamp = if x.t + 86_399.9 >= 86_400.0 - 1e-9 {
                        stamp.replace("31.12.2023", "01.01.2024")
                    } else {
                        stamp
                    };
                    let v = x.v.map(|x| comma(x, 4));
                    let i = x.i.map(|x| comma(x, 5));
                    [
                        vec![stamp],
                        v.to_vec(),
                        i.to_vec(),
                        vec![comma(rpm(x), 3), String::new()],
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[
                (Signal::Voltages, 5e-5),
                (Signal::Currents, 5e-6),
                (Signal::Speed, 1.1e-4),
            ],
            clock_s: 5e-4,
            said: &[
                "written 3,7",
                "t counts from the first date in Timestamp",
                "column U_L1 [V] is va, by its name",
            ],
        },
        Device {
            name: "Janitza GridVis waveform",
            source: "semicolons, German titles, Windows-1252; by memory",
            file: "janitza.csv",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "Ger\u{e4}t;UMG 512\nWellenform;01.03.2024\n\nZeit [\u{b5}s];Spannung L1 [V];Spannung L2 [V];Spannung L3 [V];Strom L1 [A];Strom L2 [A];Strom L3 [A]\n";
                let text = table(head, wave, ";", "\r\n", |x| {
                    let v = x.v.map(|x| comma(x, 2));
                    let i = x.i.map(|x| comma(x, 3));
                    [vec![fixed(1e6 * x.t, 0)], v.to_vec(), i.to_vec()].concat()
                });
                windows_1252(&text)
            },
            channels: &[(Signal::Voltages, 5e-3), (Signal::Currents, 5e-4)],
            clock_s: 5e-7,
            said: &[
                "the text is windows-1252",
                "in us, as the file declares",
                "column Strom L2 [A] is ib, by its name",
            ],
        },
        Device {
            name: "Chauvin Arnoux PEL/CA Transient",
            source: "French titles, UTF-16, tabs, thousands by narrow blanks; by memory",
            file: "pel.txt",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "Temps (ms)\tTension 1 (mV)\tTension 2 (mV)\tTension 3 (mV)\tCourant 1 (mA)\tCourant 2 (mA)\tCourant 3 (mA)\n";
                let text = table(head, wave, "\t", "\r\n", |x| {
                    let v = x.v.map(|x| grouped(1e3 * x, 1, "\u{202f}", ","));
                    let i = x.i.map(|x| grouped(1e3 * x, 1, "\u{202f}", ","));
                    [vec![comma(1e3 * x.t, 1)], v.to_vec(), i.to_vec()].concat()
                });
                utf16(&text, true)
            },
            channels: &[(Signal::Voltages, 5e-5), (Signal::Currents, 5e-5)],
            clock_s: 5e-5,
            said: &[
                "the text is UTF-16LE",
                "stands between thousands",
                "written 3,7",
                "va = Tension 1 (mV) in mV, as the file declares",
            ],
        },
        Device {
            name: "Dranetz HDPQ",
            source: "US stamps with AM and PM, phases A B C; by memory",
            file: "dranetz.csv",
            step_s: 1e-3,
            flag: None,
            write: |wave| {
                let head =
                    "Timestamp,A Voltage,B Voltage,C Voltage,A Current,B Current,C Current\n";
                table(head, wave, ",", "\r\n", |x| {
                    let stamp = clock(43_199.8, x.t, 4);
                    let half = if x.t + 43_199.8 >= 43_200.0 - 1e-9 {
                        "PM"
                    } else {
                        "AM"
                    };
                    let v = x.v.map(|x| fixed(x, 3));
                    let i = x.i.map(|x| fixed(x, 4));
                    [
                        vec![format!("3/4/2024 {stamp} {half}")],
                        v.to_vec(),
                        i.to_vec(),
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Voltages, 5e-4), (Signal::Currents, 5e-5)],
            clock_s: 5e-5,
            said: &[
                "t counts from the first date in Timestamp",
                "column A Voltage is va, by its name",
            ],
        },
    ]
}

pub fn rpm(x: &Instant) -> f64 {
    x.speed * 60.0 / std::f64::consts::TAU
}

fn fluke(wave: &[Instant]) -> Vec<u8> {
    let head =
        "Date\tTime\tVoltage L1N\tVoltage L2N\tVoltage L3N\tCurrent L1\tCurrent L2\tCurrent L3\n";
    table(head, wave, "\t", "\r\n", |x| {
        let v = x.v.map(|x| fixed(x, 2));
        let i = x.i.map(|x| fixed(x, 3));
        [
            vec!["3/1/2024".to_owned(), clock(86_399.9, x.t, 3)],
            v.to_vec(),
            i.to_vec(),
        ]
        .concat()
    })
    .into_bytes()
}

fn hioki(wave: &[Instant]) -> Vec<u8> {
    let head = "\"Title\",\"motor test\"\n\"Trigger Time\",\"24-03-01 12:00:00\"\n\n\
                \"Time(s)\",\"U1(V)\",\"U2(V)\",\"U3(V)\",\"I1(A)\",\"I2(A)\",\"I3(A)\"\n";
    let quoted = |text: String| format!("\"{text}\"");
    table(head, wave, ",", "\r\n", |x| {
        let v = x.v.map(|x| fixed(x, 3));
        let i = x.i.map(|x| fixed(x, 4));
        let cells = [vec![fixed(x.t, 5)], v.to_vec(), i.to_vec()].concat();
        cells.into_iter().map(quoted).collect()
    })
    .into_bytes()
}

fn yokogawa_dl(wave: &[Instant]) -> Vec<u8> {
    let head = "\"Header Size\",16\n\"Model Name\",\"DL850E\"\n\"Comment\",\"\"\n\"BlockNumber\",1\n\
                \"TraceName\",\"Ua\",\"Ub\",\"Uc\",\"Ia\",\"Ib\",\"Ic\"\n\"BlockSize\",400,400,400,400,400,400\n\
                \"VUnit\",\"V\",\"V\",\"V\",\"mA\",\"mA\",\"mA\"\n\"SampleRate\",10000,10000,10000,10000,10000,10000\n\
                \"HResolution\",1.0E-04,1.0E-04,1.0E-04,1.0E-04,1.0E-04,1.0E-04\n\
                \"Date\",\"2024/03/01\",\"2024/03/01\",\"2024/03/01\",\"2024/03/01\",\"2024/03/01\",\"2024/03/01\"\n";
    let head = head.replace("\"SampleRate\",10000,10000,10000,10000,10000,10000\n", "");
    table(&head, wave, ",", "\r\n", |x| {
        let v = x.v.map(|x| scientific(x, 5, 2));
        let i = x.i.map(|x| fixed(1e3 * x, 3));
        [vec![String::new()], v.to_vec(), i.to_vec()].concat()
    })
    .into_bytes()
}

fn dewesoft(wave: &[Instant]) -> Vec<u8> {
    let head = "Dateiname:\tPr\u{fc}fstand 3.dxd\nStartzeit:\t01.03.2024 12:00:00,000\n\n\
                Zeit [s]\tUa [V]\tUb [V]\tUc [V]\tIa [A]\tIb [A]\tIc [A]\tDrehzahl [1/min]\tDrehmoment [Nm]\n";
    let text = table(head, wave, "\t", "\r\n", |x| {
        let v = x.v.map(|x| comma(x, 4));
        let i = x.i.map(|x| comma(x, 5));
        let shaft = vec![comma(rpm(x), 3), comma(x.torque, 4)];
        [vec![comma(x.t, 7)], v.to_vec(), i.to_vec(), shaft].concat()
    });
    windows_1252(&text)
}
