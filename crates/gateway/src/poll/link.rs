//! One link and the motors on it.

use super::context::Context;
use super::motor::Watched;
use super::{asked, frames};
use crate::config::{LinkConfig, MotorConfig};

/// Follows the boards of a link until the gateway ends.
pub(crate) async fn follow(link: LinkConfig, motors: Vec<MotorConfig>, context: Context) {
    let mut watched: Vec<Watched> = motors.iter().map(Watched::new).collect();
    for motor in &mut watched {
        context.recall(motor);
        context.recall_time(motor);
    }
    let mut ended = context.ended.clone();
    let work = async {
        match link.kind.is_asked() {
            true => asked::follow(&link, &mut watched, &context).await,
            false => frames::follow(&link, &mut watched, &context).await,
        }
    };
    // Nothing is lost by an end in the middle: what was not posted is asked for again.
    tokio::select! {
        () = work => {}
        _ = ended.wait_for(|ended| *ended) => {}
    }
}
