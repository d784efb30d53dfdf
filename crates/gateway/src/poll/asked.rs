//! A link whose boards are asked, one after the other.

use std::time::{Duration, Instant};

use tokio::time::{MissedTickBehavior, interval, sleep};

use super::context::Context;
use super::motor::Watched;
use super::trouble::Trouble;
use super::visit::visit;
use crate::bus::Bus;
use crate::config::LinkConfig;

/// Visits all motors again and again.
pub(super) async fn follow(link: &LinkConfig, motors: &mut [Watched], context: &Context) {
    let Some(mut bus) = Bus::new(link) else {
        return;
    };
    let mut turn = interval(link.poll);
    turn.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut failures = 0;
    loop {
        turn.tick().await;
        match round(&mut bus, motors, context).await {
            Round::Done => failures = 0,
            Round::Broken => {
                let pause = Duration::from_secs(1 << failures.min(16));
                failures += 1;
                sleep(pause.min(context.patience.retry_most)).await;
            }
            Round::Ended => return,
        }
    }
}

/// How a round went.
enum Round {
    Done,
    /// The link itself is down.
    Broken,
    Ended,
}

async fn round(bus: &mut Bus, motors: &mut [Watched], context: &Context) -> Round {
    for k in 0..motors.len() {
        let motor = &mut motors[k];
        if !motor.health.is_due(Instant::now()) {
            continue;
        }
        match visit(bus, motor, context).await {
            Ok(()) => context.is_up(motor).await,
            Err(Trouble::Ended) => return Round::Ended,
            Err(Trouble::Other(why)) => context.is_down(motor, &why, true).await,
            Err(Trouble::Bus(error)) if error.is_of_link() => {
                all_down(motors, &error.to_string(), context).await;
                return Round::Broken;
            }
            Err(Trouble::Bus(error)) => context.is_down(motor, &error.to_string(), false).await,
        }
    }
    Round::Done
}

/// Nobody on a broken link is asked, and each of them is asked again as soon as it is whole.
async fn all_down(motors: &mut [Watched], why: &str, context: &Context) {
    for motor in motors {
        context.is_down(motor, why, false).await;
        motor.health.ask_again();
    }
}
