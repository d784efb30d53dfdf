//! The listeners of simulated boards: Modbus TCP, as a converter shows a line of boards.

use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use tokio::net::{TcpListener, TcpStream};
use tokio::time::{MissedTickBehavior, interval};

use super::plant::{Plan, Plant, Share};
use crate::wire::mbap::{self, Frame};

/// A second is divided into as many turns: boards are not switched on at the same moment.
const SLICES: usize = 10;
/// "Gateway target device failed to respond": what a converter says of an address at which nobody answers.
const NOBODY: u8 = 0x0B;

/// Answers questions from now on, in the background; time does not pass by itself.
///
/// # Errors
/// An address cannot be listened at.
pub async fn listen(plant: &Plant, plan: &Plan) -> io::Result<()> {
    let begin = Instant::now();
    for (listener, share) in plant.shares().iter().enumerate() {
        let address = plan.address(listener as u32);
        let socket = TcpListener::bind(address)
            .await
            .map_err(|error| named(address, &error))?;
        tokio::spawn(accept(socket, share.clone(), begin));
    }
    Ok(())
}

/// Answers questions, and lets time pass for `seconds` (for ever without); answers on behind that. Never returns without an
/// error.
///
/// # Errors
/// An address cannot be listened at, or what was produced cannot be written down.
pub async fn serve(mut plant: Plant, plan: &Plan, seconds: Option<u64>) -> io::Result<()> {
    listen(&plant, plan).await?;
    let mut turn = interval(Duration::from_secs(1) / SLICES as u32);
    // Numbers of seconds follow the clock, however late a turn is.
    turn.set_missed_tick_behavior(MissedTickBehavior::Burst);
    let turns = seconds.map_or(u64::MAX, |seconds| seconds * SLICES as u64);
    for slice in 0..turns {
        turn.tick().await;
        plant.tick((slice % SLICES as u64) as usize, SLICES)?;
    }
    std::future::pending().await
}

fn named(address: SocketAddr, error: &io::Error) -> io::Error {
    let remedy = "choose another --listen";
    io::Error::new(error.kind(), format!("{address}: {error}; {remedy}"))
}

async fn accept(socket: TcpListener, share: Share, begin: Instant) {
    loop {
        match socket.accept().await {
            Ok((stream, _)) => drop(tokio::spawn(converse(stream, share.clone(), begin))),
            // No more files may be open: connections that end free some.
            Err(_) => tokio::time::sleep(Duration::from_millis(100)).await,
        }
    }
}

async fn converse(mut stream: TcpStream, share: Share, begin: Instant) {
    // An answer is one small packet.
    let _ = stream.set_nodelay(true);
    while let Ok(Some(question)) = mbap::read(&mut stream).await {
        let now_ms = begin.elapsed().as_millis() as u32;
        let answer = share.answer(question.unit, now_ms, &question.content);
        let function = question.content.first().copied().unwrap_or(0);
        let content = answer.unwrap_or_else(|| vec![function | 0x80, NOBODY]);
        let answer = Frame {
            content,
            ..question
        };
        if mbap::write(&mut stream, &answer).await.is_err() {
            return;
        }
    }
}
