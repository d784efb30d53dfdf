//! The signals of one part of the recording, every sample.

use std::sync::Arc;

use axum::Json;
use axum::extract::{Query, State};
use axum::response::{IntoResponse, Response};
use discovery::SpeedScaleReport;
use motor::MotorFile;
use recording::Source;
use serde::Deserialize;

use super::desk::Bench;
use super::refused;
use crate::running::shared::Refusal;
use report::overlay::{Model, Overlay};
use report::study::in_fitted_scale;

/// From where to where, s.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct Part {
    from_s: f64,
    to_s: f64,
}

/// The scale of the speed that fits the motor file, where it is unknown.
fn fitted_scale(source: &Source, motor: &MotorFile) -> Option<SpeedScaleReport> {
    let unknown =
        matches!(source, Source::Recording(recording) if recording.unknown_speed_scale.is_some());
    let compared =
        unknown.then(|| discovery::compare(std::slice::from_ref(source), motor, &mut |_, _| {}));
    compared?.ok()?.speed_scale
}

/// Measured and modelled signals of the first recording, with the motor file as it is.
pub(super) async fn region(State(bench): State<Arc<Bench>>, Query(part): Query<Part>) -> Response {
    let (_, sources) = bench.desk().sources();
    let Some((source, motor)) = sources.into_iter().next().zip(bench.motor()) else {
        return refused(&Refusal::of(
            "load a recording and choose a motor file first",
        ));
    };
    let work = move || {
        let models = [Model::believed(&motor.motor)];
        let scale = fitted_scale(&source, &motor.motor);
        let source = in_fitted_scale(&source, scale.as_ref());
        Overlay::part(&source, &models, part.from_s, part.to_s)
    };
    match tokio::task::spawn_blocking(work).await.ok().flatten() {
        Some(traces) => Json(traces).into_response(),
        None => refused(&Refusal::of("the recording has no samples there")),
    }
}
