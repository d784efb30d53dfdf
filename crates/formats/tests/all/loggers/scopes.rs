//! Oscilloscopes and USB recorders.

use super::text::{comma, fixed, scientific, table};
use super::wave::Instant;
use super::{Device, Signal};

pub(super) fn devices() -> Vec<Device> {
    vec![
        Device {
            name: "Tektronix MSO/DPO/TBS",
            source: "Tektronix, Waveform Data Formats, \"CSV\": block of labels, then TIME,CH1,...; by memory in detail",
            file: "tek0001.csv",
            step_s: 1e-4,
            flag: Some("--columns t,va,vb,vc,ia,ib,ic"),
            write: tektronix,
            channels: &[(Signal::Voltages, 5e-4), (Signal::Currents, 5e-6)],
            clock_s: 5e-9,
            said: &["names the columns", "are above the table", "CH1 is va"],
        },
        Device {
            name: "Keysight InfiniiVision",
            source: "mak2494/Elektronik-Labor- labor1.py reads scope_6.csv: two title rows, numbers with a leading +",
            file: "scope_6.csv",
            step_s: 1e-4,
            flag: Some("--columns t,ia,ib,ic"),
            write: keysight,
            channels: &[(Signal::Currents, 5e-6)],
            clock_s: 5e-9,
            said: &["line 2 gives their units"],
        },
        Device {
            name: "Rigol DS1000Z",
            source: "rigol CSV with X,CH1,...,Start,Increment and a row Sequence,Volt,...; by memory",
            file: "NewFile1.csv",
            step_s: 1e-4,
            flag: Some("--columns -,ia,ib,ic"),
            write: rigol,
            channels: &[(Signal::Currents, 5e-3)],
            clock_s: 1e-9,
            said: &["10000 samples a second, as `Increment` in line 1 says"],
        },
        Device {
            name: "Siglent SDS1000X-E",
            source: "MartinCowen/SigFyCSV README.md",
            file: "SDS00001.csv",
            step_s: 1e-4,
            flag: Some("--columns t,va,vb,vc"),
            write: siglent,
            channels: &[(Signal::Voltages, 5e-6)],
            clock_s: 5e-12,
            said: &["gives their units", "user's assumption"],
        },
        Device {
            name: "LeCroy WaveSurfer",
            source: "five lines above Time,Ampl, as skiprows in public readers of C1Trace00000.txt; by memory in detail",
            file: "C1Trace00000.csv",
            step_s: 1e-4,
            flag: Some("--column ia=Ampl"),
            write: lecroy,
            channels: &[],
            clock_s: 5e-11,
            said: &["line 5 names the columns", "column Time is t, by its name"],
        },
        Device {
            name: "PicoScope 6, German",
            source: "public reader of a PicoScope file: sep=; decimal=, skiprows=2 (Zeit;Kanal A;Kanal B and units)",
            file: "20251027-0003.csv",
            step_s: 1e-4,
            flag: Some("--columns t,va,vb,vc"),
            write: picoscope,
            channels: &[(Signal::Voltages, 5e-6)],
            clock_s: 5e-12,
            said: &[
                "separated by `;`",
                "written 3,7",
                "line 2 gives their units",
                "t = Zeit in ms",
            ],
        },
        Device {
            name: "Saleae Logic 2",
            source: "Saleae, Export Data: analog.csv begins with Time [s],Channel 0,...; by memory",
            file: "analog.csv",
            step_s: 1e-4,
            flag: Some("--columns t,ia,ib,ic"),
            write: |wave| {
                let head = "Time [s],Channel 0,Channel 1,Channel 2\n";
                table(head, wave, ",", "\n", |x| {
                    vec![
                        fixed(x.t, 9),
                        fixed(x.i[0], 15),
                        fixed(x.i[1], 15),
                        fixed(x.i[2], 15),
                    ]
                })
                .into_bytes()
            },
            channels: &[(Signal::Currents, 5e-16)],
            clock_s: 5e-10,
            said: &["Channel 0 is ia"],
        },
        Device {
            name: "Hantek DSO2000",
            source: "phmarek/hantek-dso2000 doc/csv.md",
            file: "foobar.tsv",
            step_s: 4e-5,
            flag: Some("--columns -,t,ia,ib,-,-"),
            write: |wave| {
                let head = "nr\ttime\tch1\tch2\tch1s\tch2s\n";
                table(head, wave, "\t", "\n", |x| {
                    let code = |x: f64| format!("{}", (x / 0.04).round());
                    vec![
                        x.k.to_string(),
                        format!("{:e}", (x.t * 1e9).round() / 1e9),
                        fixed(x.i[0], 2),
                        fixed(x.i[1], 2),
                        code(x.i[0]),
                        code(x.i[1]),
                    ]
                })
                .into_bytes()
            },
            channels: &[],
            clock_s: 1e-9,
            said: &["separated by tabs", "ch1 is ia"],
        },
        Device {
            name: "Red Pitaya streaming",
            source: "by memory: columns of codes without a header, no clock",
            file: "data_file_1.csv",
            step_s: 1e-4,
            flag: Some("--columns ia,ib,ic,t"),
            write: |wave| {
                table("", wave, ",", "\n", |x| {
                    vec![
                        fixed(x.i[0], 6),
                        fixed(x.i[1], 6),
                        fixed(x.i[2], 6),
                        fixed(x.t, 6),
                    ]
                })
                .into_bytes()
            },
            channels: &[(Signal::Currents, 5e-7)],
            clock_s: 5e-7,
            said: &["column 1 is ia", "user's assumption"],
        },
    ]
}

fn tektronix(wave: &[Instant]) -> Vec<u8> {
    let head = "Model,MSO46\nFirmware Version,1.28.8\n\nPoint Format,Y,\nHorizontal Units,S,\nHorizontal Scale,0.004,\n\
                Horizontal Delay,0,\nSample Interval,1E-04,\nRecord Length,400,\nGating,0.0% to 100.0%,\n\
                Probe Attenuation,1,1,1,1,1,1\nVertical Units,V,V,V,A,A,A\nVertical Offset,0,0,0,0,0,0\n\
                Label,,,,,,\nTIME,CH1,CH2,CH3,CH4,CH5,CH6\n";
    table(head, wave, ",", "\n", |x| {
        let v = x.v.map(|x| fixed(x, 3));
        let i = x.i.map(|x| scientific(x, 5, 2));
        [vec![scientific(x.t, 8, 2)], v.to_vec(), i.to_vec()].concat()
    })
    .into_bytes()
}

fn keysight(wave: &[Instant]) -> Vec<u8> {
    let signed = |x: f64| format!("{}{}", if x < 0.0 { "" } else { "+" }, scientific(x, 5, 2));
    table(
        "x-axis,1,2,3\nsecond,Ampere,Ampere,Ampere\n",
        wave,
        ",",
        "\n",
        |x| [vec![scientific(x.t - 0.02, 8, 2)], x.i.map(signed).to_vec()].concat(),
    )
    .into_bytes()
}

fn rigol(wave: &[Instant]) -> Vec<u8> {
    let head =
        "X,CH1,CH2,CH3,Start,Increment,\nSequence,Volt,Volt,Volt,-2.000000e-02,1.000000e-04\n";
    let head = head.replace("Volt", "Ampere");
    table(&head, wave, ",", "\n", |x| {
        let i = x.i.map(|x| format!("{x:.2e}"));
        [
            vec![x.k.to_string()],
            i.to_vec(),
            vec![String::new(), String::new()],
        ]
        .concat()
    })
    .into_bytes()
}

fn siglent(wave: &[Instant]) -> Vec<u8> {
    let head = "Record Length,Analog:400\nSample Rate,10000.0\nVertical Scale,CH1: 100.00\nVertical Offset,CH1:0.00000\n\
                Horizontal Scale, 0.002000000\nSecond,Volt,Volt,Volt\n";
    table(head, wave, ",", "\n", |x| {
        [
            vec![fixed(x.t - 0.02, 11)],
            x.v.map(|x| fixed(x, 5)).to_vec(),
        ]
        .concat()
    })
    .into_bytes()
}

fn lecroy(wave: &[Instant]) -> Vec<u8> {
    let head = "LECROYWS3024z,53562,Waveform\nSegments,1,SegmentSize,400\nSegment,TrigTime,TimeSinceSegment1\n\
                #1,20-Mar-2024 12:00:00,0\nTime,Ampl\n";
    table(head, wave, ",", "\r\n", |x| {
        vec![fixed(x.t - 0.02, 10), fixed(x.i[0], 6)]
    })
    .into_bytes()
}

fn picoscope(wave: &[Instant]) -> Vec<u8> {
    let head = "Zeit;Kanal A;Kanal B;Kanal C\n(ms);(V);(V);(V)\n\n";
    table(head, wave, ";", "\r\n", |x| {
        [
            vec![comma(1e3 * (x.t - 0.02), 8)],
            x.v.map(|x| comma(x, 5)).to_vec(),
        ]
        .concat()
    })
    .into_bytes()
}
