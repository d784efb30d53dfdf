//! Controllers, drives, and the tools around them.

use super::instruments::rpm;
use super::text::{clock, comma, fixed, table, utf16};
use super::wave::Instant;
use super::{Device, Signal};

pub(super) fn devices() -> Vec<Device> {
    vec![
        Device {
            name: "NI LabVIEW .lvm",
            source: "NI, Specification for the LabVIEW Measurement File (tutorial 4139)",
            file: "test.lvm",
            step_s: 1e-4,
            flag: Some("--columns t,ia,ib,ic"),
            write: lvm,
            channels: &[(Signal::Currents, 5e-7)],
            clock_s: 5e-7,
            said: &[
                "separated by tabs",
                "names the columns",
                "X_Value is t",
                "Untitled 1 is ib",
            ],
        },
        Device {
            name: "NI DIAdem text",
            source: "rows of channel names and units above the samples; by memory",
            file: "diadem.asc",
            step_s: 1e-4,
            flag: None,
            write: |wave| {
                let head = "Time\tU_1\tU_2\tU_3\tI_1\tI_2\tI_3\ns\tV\tV\tV\tA\tA\tA\n";
                table(head, wave, "\t", "\r\n", |x| {
                    let v = x.v.map(|x| fixed(x, 5));
                    let i = x.i.map(|x| fixed(x, 6));
                    [vec![fixed(x.t, 6)], v.to_vec(), i.to_vec()].concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Voltages, 5e-6), (Signal::Currents, 5e-7)],
            clock_s: 5e-7,
            said: &["line 2 gives their units", "column U_1 is va, by its name"],
        },
        Device {
            name: "Arduino serial monitor",
            source: "what a sketch prints: blanks, no header, milliseconds; repeated banner lines behind #",
            file: "serial.log",
            step_s: 1e-3,
            flag: Some("--columns t,ia,ib,ic"),
            write: |wave| {
                let head = "# motor logger 1.2\n";
                let text = table(head, wave, "   ", "\r\n", |x| {
                    [vec![fixed(x.t, 3)], x.i.map(|x| fixed(x, 2)).to_vec()].concat()
                });
                text.replacen("0.200 ", "# still alive\r\n0.200 ", 1)
                    .into_bytes()
            },
            channels: &[(Signal::Currents, 5e-3)],
            clock_s: 5e-4,
            said: &["separated by blanks", "column 1 is t"],
        },
        Device {
            name: "Siemens S7 trace",
            source: "Siemens, trace and logic analyzer: export as CSV; layout by memory",
            file: "trace.csv",
            step_s: 1e-3,
            flag: None,
            write: |wave| {
                let head = "sep=;\nMeasurement;Trace_1\nTimestamp;I_L1;I_L2;I_L3;ActualSpeed\nms;A;A;A;rpm\n";
                table(head, wave, ";", "\r\n", |x| {
                    let i = x.i.map(|x| comma(x, 5));
                    [
                        vec![comma(1e3 * x.t, 3)],
                        i.to_vec(),
                        vec![comma(rpm(x), 4)],
                    ]
                    .concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Currents, 5e-6), (Signal::Speed, 1e-5)],
            clock_s: 5e-7,
            said: &[
                "line 4 gives their units",
                "t = Timestamp in ms, as the file declares",
                "speed = ActualSpeed in rpm",
            ],
        },
        Device {
            name: "Beckhoff TwinCAT Scope",
            source: "Beckhoff, TE13xx Scope View, Export to csv: milliseconds since the first sample, EOF tag",
            file: "scope.csv",
            step_s: 1e-3,
            flag: Some("--columns t,ia,ib,ic"),
            write: |wave| {
                let head = "Name\tmotor\nFile\tC:\\scope.svdx\nStarttime of export\t133539120000000000\n\n\
                            Time\tMain.fCurrentU\tMain.fCurrentV\tMain.fCurrentW\n";
                let text = table(head, wave, "\t", "\r\n", |x| {
                    [vec![fixed(x.t, 4)], x.i.map(|x| fixed(x, 6)).to_vec()].concat()
                });
                (text + "EOF\r\n").into_bytes()
            },
            channels: &[(Signal::Currents, 5e-7)],
            clock_s: 5e-5,
            said: &["separated by tabs", "Main.fCurrentU is ia"],
        },
        Device {
            name: "CODESYS trace",
            source: "semicolons, UTF-16 without a mark, microseconds; by memory",
            file: "codesys.csv",
            step_s: 5e-4,
            flag: None,
            write: |wave| {
                let head = "Time [us];ia;ib;ic;speed [rpm]\n";
                let text = table(head, wave, ";", "\r\n", |x| {
                    [
                        vec![fixed(1e6 * x.t, 0)],
                        x.i.map(|x| fixed(x, 6)).to_vec(),
                        vec![fixed(rpm(x), 4)],
                    ]
                    .concat()
                });
                utf16(&text, false)
            },
            channels: &[(Signal::Currents, 5e-7), (Signal::Speed, 1e-5)],
            clock_s: 5e-7,
            said: &[
                "the text is UTF-16LE",
                "t = Time [us] in us, as the file declares",
            ],
        },
        Device {
            name: "data logger with clamps",
            source: "a logger that stores the volts of its inputs: clamps of 100 mV/A, ISO stamps with zone",
            file: "logger.csv",
            step_s: 1e-3,
            flag: Some("--sensor i=100mV/A"),
            write: |wave| {
                let head = "timestamp,I1 [mV],I2 [mV],I3 [mV]\n";
                table(head, wave, ",", "\n", |x| {
                    let stamp = format!("2024-03-31T{}+02:00", clock(3600.0, x.t, 6));
                    [vec![stamp], x.i.map(|x| fixed(100.0 * x, 3)).to_vec()].concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Currents, 5e-6)],
            clock_s: 5e-7,
            said: &[
                "t counts from the first date in timestamp",
                "in mV through a sensor of 100mV/A",
            ],
        },
        Device {
            name: "cloud historian",
            source: "nanoseconds since 1970, as time-series databases export them",
            file: "influx.csv",
            step_s: 1e-3,
            flag: None,
            write: |wave| {
                let head = "time,i_l1,i_l2,i_l3\n";
                table(head, wave, ",", "\n", |x| {
                    let ns = 1_709_290_800_000_000_000u64 + u64::from(x.k) * 1_000_000;
                    [vec![ns.to_string()], x.i.map(|x| fixed(x, 6)).to_vec()].concat()
                })
                .into_bytes()
            },
            channels: &[(Signal::Currents, 5e-7)],
            clock_s: 1e-9,
            said: &[
                "time counts ns since 1970",
                "column i_l1 is ia, by its name",
            ],
        },
    ]
}

fn lvm(wave: &[Instant]) -> Vec<u8> {
    let head = "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n\
                Multi_Headings\tNo\nX_Columns\tOne\nTime_Pref\tAbsolute\nOperator\tlab\nDate\t2024/03/01\nTime\t12:00:00.1234567\n\
                ***End_of_Header***\t\n\t\nChannels\t3\t\t\t\nSamples\t400\t400\t400\t\nDate\t2024/03/01\t2024/03/01\t2024/03/01\t\n\
                Time\t12:00:00.1\t12:00:00.1\t12:00:00.1\t\nY_Unit_Label\tAmps\tAmps\tAmps\t\nX_Dimension\tTime\tTime\tTime\t\n\
                X0\t0.0000000000000000E+0\t0.0000000000000000E+0\t0.0000000000000000E+0\t\n\
                Delta_X\t0.000100\t0.000100\t0.000100\t\n***End_of_Header***\t\t\t\t\n\
                X_Value\tUntitled\tUntitled 1\tUntitled 2\tComment\n";
    table(head, wave, "\t", "\r\n", |x| {
        [vec![fixed(x.t, 6)], x.i.map(|x| fixed(x, 6)).to_vec()].concat()
    })
    .into_bytes()
}
