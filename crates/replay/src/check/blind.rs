//! What a recording and a motor file cannot show.

use motor::FaultId;
use motor::MotorFile;
use motor::motor_file::LoadKind;
use recording::{Channel, Recording};
use schemars::JsonSchema;
use serde::Serialize;

use crate::Verdict;

/// Something that cannot be seen, and what would show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct BlindSpot {
    /// What cannot be seen.
    pub unseen: &'static str,
    /// What would show it.
    pub needs: &'static str,
}

/// What the channels that a recording lacks leave dark.
pub fn channels_missing(recording: &Recording, motor: &MotorFile) -> Vec<BlindSpot> {
    let by_channels = |spot: &BlindSpot| ![NOT_CALIBRATED, WARM].contains(spot);
    let all = blind_spots(recording, motor, false);
    all.into_iter().filter(by_channels).collect()
}

/// What a motor that was never seen in good order leaves dark.
pub(super) const NOT_CALIBRATED: BlindSpot = BlindSpot {
    unseen: "which phase is at fault, and faults smaller than the plate's uncertainty",
    needs: "a recording of the motor in good order",
};

/// A fit holds where it was made.
pub(super) const BEYOND: BlindSpot = BlindSpot {
    unseen: "small faults where load, voltage or frequency lie beyond what the recording in good order shows",
    needs: "the motor in good order there, too",
};

/// Both resistances rise as the motor warms: by some 40 % over 100 K.
const WARM: BlindSpot = BlindSpot {
    unseen: "a resistance of all phases or of the rotor that has grown by as much as heat makes it grow, up to some 40 %",
    needs: "the winding's temperature: compare recordings of the same temperature",
};

/// What these channels and this motor file leave dark.
pub fn blind_spots(
    recording: &Recording,
    motor: &MotorFile,
    speed_is_estimated: bool,
) -> Vec<BlindSpot> {
    let mut spots = Vec::new();
    let mut add = |missing: bool, unseen, needs| {
        if missing {
            spots.push(BlindSpot { unseen, needs });
        }
    };
    let voltages = recording.voltages().is_some();
    let currents = recording.currents().is_some();
    add(
        !voltages,
        "resistances, inductances and the supply",
        "three voltages",
    );
    add(
        currents && !voltages && motor.healthy.is_some(),
        "an unbalance of the currents no larger than a supply's makes that has changed by 2 %, at the load of the recording in good order; elsewhere more",
        "three voltages",
    );
    add(!currents, "unbalance and shorted turns", "three currents");
    add(
        speed_is_estimated || recording.speed().is_none(),
        "the rotor's resistance, and the speed sensor itself",
        "the speed from an encoder",
    );
    add(
        recording.channel(Channel::TORQUE).is_none() && motor.load != LoadKind::Friction,
        "friction and the load",
        "the shaft torque",
    );
    add(motor.healthy.is_some() && voltages, WARM.unseen, WARM.needs);
    add(
        motor.healthy.is_none(),
        NOT_CALIBRATED.unseen,
        NOT_CALIBRATED.needs,
    );
    spots
}

/// A speed that was computed from voltages and currents accuses neither the speed sensor nor the rotor.
pub(super) fn forget_speed(verdict: &mut Verdict) {
    let told = |fault: FaultId| !matches!(fault, FaultId::SpeedSensor | FaultId::RotorResistance);
    verdict.candidates.retain(|candidate| told(candidate.fault));
    verdict.tied = crate::causes::tied(&verdict.candidates);
}
