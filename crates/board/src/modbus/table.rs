//! The register map itself: addresses and their contents, in order of address.

use super::entry::{Entry, FIELDS, Field, Kind, Meaning};
use crate::health::reset::RESET_CAUSES;

const fn entry(field: Field, kind: Kind, unit: &'static str, meaning: &'static str) -> Entry {
    Entry {
        field,
        kind,
        unit,
        meaning: Meaning::Words(meaning),
    }
}

const fn numbered(field: Field, meaning: Meaning) -> Entry {
    Entry {
        field,
        kind: Kind::Word,
        unit: "",
        meaning,
    }
}

/// Every input register, in order of address.
pub const MAP: [Entry; FIELDS] = {
    use Field::*;
    use Kind::*;
    [
        entry(
            MapVersion,
            Word,
            "",
            "2; grows when an address changes its meaning",
        ),
        entry(
            MotorIdentification,
            Long,
            "",
            "checksum of the motor constants in flash",
        ),
        numbered(ResetCause, Meaning::Numbers(&RESET_CAUSES)),
        entry(
            Lamps,
            Long,
            "",
            "two bits per lamp from the lowest, in the order RUN r1 r2 r3 r4 SENSOR LINE LOAD FAULT: 0 off, 1 on, 2 blinking",
        ),
        numbered(NotJudged, Meaning::Reasons),
        numbered(
            Verdict,
            Meaning::Numbers(&[
                (
                    0,
                    "not judged yet, SENSOR lit or something does not fit in motion",
                ),
                (1, "healthy"),
                (2, "FAULT lit"),
            ]),
        ),
        numbered(LikelyFault, Meaning::Faults),
        entry(FaultProbability, Word, "per mille", "its probability"),
        entry(Windows, Long, "", "windows since the start"),
        entry(WindowsJudged, Long, "", "of these judged"),
        entry(Residual1, Float, "", "r1, share of its scale"),
        entry(Residual2, Float, "", "r2"),
        entry(Residual3, Float, "", "r3"),
        entry(Residual4, Float, "", "r4"),
        entry(Threshold1, Float, "", "threshold of r1, share of its scale"),
        entry(Threshold2, Float, "", "of r2"),
        entry(Threshold3, Float, "", "of r3"),
        entry(Threshold4, Float, "", "of r4"),
        entry(Voltage, Float, "V", "phase voltage, positive sequence, RMS"),
        entry(VoltageA, Float, "V", "phase a, fundamental, RMS"),
        entry(VoltageB, Float, "V", "phase b"),
        entry(VoltageC, Float, "V", "phase c"),
        entry(Current, Float, "A", "phase current, positive sequence, RMS"),
        entry(CurrentA, Float, "A", "phase a, fundamental, RMS"),
        entry(CurrentB, Float, "A", "phase b"),
        entry(CurrentC, Float, "A", "phase c"),
        entry(SupplyFrequency, Float, "Hz", "of the supply"),
        entry(Speed, Float, "1/min", "of the shaft"),
        entry(
            Temperature,
            Float,
            "degC",
            "of the chip, some 5 K uncertain; not of the motor",
        ),
        entry(
            ConverterSupply,
            Word,
            "mV",
            "supply of the converters, 3300 is nominal",
        ),
        numbered(
            Calibration,
            Meaning::Numbers(&[
                (0, "motor file's values"),
                (1, "learnt ones"),
                (2, "learnt ones lost"),
                (3, "learnt ones are another motor's"),
            ]),
        ),
        numbered(Learning, Meaning::Learning),
        entry(
            LearnedWindows,
            Word,
            "",
            "windows judged while learning, 600 are needed",
        ),
        numbered(
            Capture,
            Meaning::Numbers(&[
                (0, "waiting for an alarm"),
                (1, "taking the samples around it"),
                (2, "complete"),
            ]),
        ),
        entry(
            CurrentLag,
            Float,
            "degree",
            "current behind voltage, positive sequence, -180 to 180, to 0.2; beyond 90 the machine gives power, or its currents are measured the wrong way round",
        ),
        Entry {
            field: Doubts,
            kind: Long,
            unit: "",
            meaning: Meaning::Doubts,
        },
        numbered(Relay, Meaning::Numbers(&[(0, "open"), (1, "energised")])),
        entry(Uptime, Long, "s", "since the start"),
        entry(
            Stack,
            Word,
            "byte",
            "deepest stack since the start, of 20 480",
        ),
        entry(
            Crashes,
            Word,
            "",
            "crashes without a quiet minute between them; from 3 on nothing is computed until somebody acknowledges",
        ),
        Entry {
            field: CrashCause,
            kind: Word,
            unit: "",
            meaning: Meaning::Crashes,
        },
        entry(
            CrashProgramCounter,
            Long,
            "",
            "of the last crash: program counter",
        ),
        entry(CrashLink, Long, "", "link register"),
        entry(CrashStatus, Long, "", "program status register"),
        entry(CrashFaults, Long, "", "fault status (CFSR)"),
        entry(CrashHardFault, Long, "", "hard fault status (HFSR)"),
        entry(
            CrashAddress,
            Long,
            "",
            "address that could not be reached or that failed; of a panic where the name of its file lies; of the watchdog the marks that were missing: 1 block, 2 Modbus, 4 self-test",
        ),
        entry(CrashStack, Long, "", "stack pointer"),
        entry(CrashLine, Word, "", "line of a panic"),
        entry(CrashLength, Word, "byte", "length of its file's name"),
        entry(CrashUptime, Long, "ms", "from the start to the crash"),
        entry(
            ProgramLength,
            Long,
            "byte",
            "of the program in flash, 0 where it was not sealed",
        ),
        entry(
            ProgramChecksum,
            Long,
            "",
            "CRC-32 of the program, as it was sealed",
        ),
        entry(
            StoredDataErrors,
            Word,
            "",
            "double words of stored data that failed their error correction since the start; checksums decided",
        ),
        entry(
            SerialHigh,
            Long,
            "",
            "the chip's serial number of 96 bits: the highest 32",
        ),
        entry(SerialMiddle, Long, "", "the middle 32"),
        entry(SerialLow, Long, "", "the lowest 32"),
        entry(
            CalibrationIdentification,
            Long,
            "",
            "checksum of the learnt values that hold, 0 where there are none",
        ),
        entry(
            LastEvent,
            Long,
            "",
            "number of the newest event of the log; they count from 1; 0: no event yet",
        ),
        numbered(
            Configuration,
            Meaning::Numbers(&[
                (0, "compiled in"),
                (1, "confirmed"),
                (2, "on trial"),
                (
                    3,
                    "line as confirmed and motor as compiled in, because the program was flashed with another motor since or cannot compute with the confirmed one",
                ),
                (4, "compiled in, because the confirmed one is lost"),
            ]),
        ),
        numbered(ConfigurationRefused, Meaning::Refusals),
        entry(
            TrialSeconds,
            Word,
            "s",
            "until the configuration on trial is given up, 0 without a trial",
        ),
        entry(
            StartNumber,
            Long,
            "",
            "which run of the program: the number that its first event gets",
        ),
        entry(
            LastSecond,
            Long,
            "",
            "number of the newest second of this run; they count from 1; 0: no second yet",
        ),
        numbered(Motion, Meaning::Motion),
        numbered(Update, Meaning::Updates),
        numbered(UpdateRefused, Meaning::UpdateRefusals),
        entry(
            UpdateBytes,
            Long,
            "byte",
            "of a program received since the last first piece; 0 after a start",
        ),
        entry(
            UpdateTrial,
            Word,
            "s",
            "until the new program confirms itself if nothing happens, 0 without a trial",
        ),
        entry(
            ProgramVersion,
            Long,
            "",
            "of the program: two numbers of 8 bits, the third of 16, the first in the highest",
        ),
    ]
};
