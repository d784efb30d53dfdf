//! Many simulated boards: which is where, and the configuration with which a gateway finds them.

use std::fmt::Write as _;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};

use rand::seq::index;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

use super::board::{Recipe, SimulatedBoard};
use super::capture::MOTOR_FILE_NAME;
use super::truth::Truth;

/// Addresses of a Modbus line.
const MOST_UNITS: u32 = 247;

/// What is simulated.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Boards.
    pub boards: u32,
    /// Address of the first listener; the others have the ports behind it.
    pub listen: SocketAddr,
    /// Boards behind one listener, 1 to 247.
    pub per_port: u32,
    /// All chances follow from it.
    pub seed: u64,
    /// Motors that begin to fail.
    pub faulty: u32,
    /// They begin within this time, s.
    pub faults_within_s: u32,
    /// Mean time between two losses of a board's power, s; `None`: none loses it.
    pub restart_s: Option<u32>,
}

/// Why nothing can be simulated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// No board.
    #[error("0 boards: simulate one or more")]
    None,
    /// More faults than motors.
    #[error("{faulty} of {boards} boards cannot fail: leave --faulty at {boards} or below")]
    Faulty {
        /// Asked for.
        faulty: u32,
        /// There are.
        boards: u32,
    },
    /// More boards on a line than it has addresses.
    #[error("{0} boards at one port: a Modbus line has addresses for 1 to 247")]
    PerPort(u32),
    /// More listeners than ports.
    #[error(
        "{boards} boards need {listeners} ports from {first} on, and ports end at 65535: begin lower or put more boards behind a port"
    )]
    Ports {
        /// Boards.
        boards: u32,
        /// Listeners.
        listeners: u32,
        /// First port.
        first: u16,
    },
}

impl Plan {
    /// Listeners.
    pub fn listeners(&self) -> u32 {
        self.boards.div_ceil(self.per_port)
    }

    /// Address of a listener.
    pub fn address(&self, listener: u32) -> SocketAddr {
        let port = u32::from(self.listen.port()) + listener;
        SocketAddr::new(self.listen.ip(), port as u16)
    }

    /// The boards behind a listener.
    fn units(&self, listener: u32) -> impl Iterator<Item = (u32, u8)> {
        let from = listener * self.per_port;
        let to = (from + self.per_port).min(self.boards);
        (from..to).map(move |board| (board, (board - from + 1) as u8))
    }

    /// The configuration of a gateway that reads all of them; [`super::MOTOR_FILE`] belongs beside it.
    pub fn configuration(&self, store: &str) -> String {
        let mut text = format!(
            "# {} simulated boards\n[store]\npath = \"{store}\"\n",
            self.boards
        );
        for listener in 0..self.listeners() {
            let address = self.address(listener);
            // Into memory.
            let _ = write!(
                text,
                "\n[[link]]\nname = \"port-{}\"\nkind = \"modbus-tcp\"\naddress = \"{address}\"\n",
                address.port()
            );
            for (board, unit) in self.units(listener) {
                let (name, link) = (name(board), address.port());
                let _ = write!(
                    text,
                    "\n[[motor]]\nname = \"{name}\"\nlink = \"port-{link}\"\nunit = {unit}\nmotor_file = \"{MOTOR_FILE_NAME}\"\n"
                );
            }
        }
        text
    }

    fn check(&self) -> Result<(), PlanError> {
        if self.boards == 0 {
            return Err(PlanError::None);
        }
        if self.faulty > self.boards {
            return Err(PlanError::Faulty {
                faulty: self.faulty,
                boards: self.boards,
            });
        }
        if !(1..=MOST_UNITS).contains(&self.per_port) {
            return Err(PlanError::PerPort(self.per_port));
        }
        let (first, listeners) = (self.listen.port(), self.listeners());
        match u32::from(first) + listeners - 1 > u32::from(u16::MAX) {
            true => Err(PlanError::Ports {
                boards: self.boards,
                listeners,
                first,
            }),
            false => Ok(()),
        }
    }
}

/// Name of a simulated motor.
fn name(board: u32) -> String {
    format!("m{:05}", board + 1)
}

/// The boards behind one listener; every clone has the same.
#[derive(Clone)]
pub struct Share(Arc<Mutex<Vec<SimulatedBoard>>>);

impl Share {
    fn new(boards: Vec<SimulatedBoard>) -> Self {
        Share(Arc::new(Mutex::new(boards)))
    }

    /// Does something with the boards.
    pub(super) fn with<T>(&self, what: impl FnOnce(&mut [SimulatedBoard]) -> T) -> T {
        what(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// As if somebody had exchanged all boards for those of another line.
    pub fn exchange(&self, other: &Share) {
        self.with(|boards| other.with(|others| boards.swap_with_slice(others)));
    }

    /// What the boards of a serial line answer to a frame; empty where all of them keep silent.
    pub(super) fn respond(&self, now_ms: u32, request: &[u8]) -> Vec<u8> {
        self.with(|boards| {
            let mut answers = boards
                .iter_mut()
                .map(|board| board.respond(now_ms, request));
            answers
                .find(|answer| !answer.is_empty())
                .unwrap_or_default()
        })
    }

    /// What a board answers; `None` where there is no board with this address, or where it keeps silent.
    pub(super) fn answer(&self, unit: u8, now_ms: u32, content: &[u8]) -> Option<Vec<u8>> {
        self.with(|boards| {
            // Units count from 1.
            let board = boards.get_mut(usize::from(unit).checked_sub(1)?)?;
            board.answer(now_ms, content)
        })
    }
}

/// All boards.
pub struct Plant {
    shares: Vec<Share>,
    truth: Option<Truth>,
}

impl Plant {
    /// Switches all boards on.
    ///
    /// # Errors
    /// A plan that contradicts itself.
    pub fn new(plan: &Plan, truth: Option<Truth>) -> Result<Self, PlanError> {
        plan.check()?;
        let mut rng = Pcg32::seed_from_u64(plan.seed);
        let failing = index::sample(&mut rng, plan.boards as usize, plan.faulty as usize);
        let failing: std::collections::HashSet<_> = failing.into_iter().collect();
        let mut build = |(board, unit): (u32, u8)| {
            let fails = failing.contains(&(board as usize));
            let at = rng.random_range(0..plan.faults_within_s.max(1));
            SimulatedBoard::new(Recipe {
                name: name(board),
                unit,
                serial: [0x5349_4D00, plan.seed as u32, board + 1],
                seed: rng.random(),
                fault_s: fails.then_some(at),
                restart_s: plan.restart_s,
            })
        };
        let shares = (0..plan.listeners())
            .map(|listener| Share::new(plan.units(listener).map(&mut build).collect()))
            .collect();
        Ok(Plant { shares, truth })
    }

    /// The boards, listener by listener.
    pub fn shares(&self) -> &[Share] {
        &self.shares
    }

    /// A second passes for those boards whose turn is `slice` of `slices`.
    ///
    /// # Errors
    /// What was produced cannot be written down.
    pub fn tick(&mut self, slice: usize, slices: usize) -> std::io::Result<()> {
        let truth = &mut self.truth;
        for share in &self.shares {
            share.with(|boards| {
                let due = boards.iter_mut().skip(slice).step_by(slices);
                due.into_iter()
                    .try_for_each(|board| tick(board, truth.as_mut()))
            })?;
        }
        truth.as_mut().map_or(Ok(()), Truth::flush)
    }
}

fn tick(board: &mut SimulatedBoard, truth: Option<&mut Truth>) -> std::io::Result<()> {
    let mut all = Vec::new();
    board.tick(|produced| all.push(produced));
    match truth {
        Some(truth) => all
            .iter()
            .try_for_each(|produced| truth.take(board.name(), produced)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(boards: u32) -> Plan {
        Plan {
            boards,
            listen: "127.0.0.1:15020".parse().expect("an address"),
            per_port: 200,
            seed: 1,
            faulty: 0,
            faults_within_s: 60,
            restart_s: None,
        }
    }

    #[test]
    fn boards_are_dealt_to_ports_and_units() {
        let plan = plan(450);
        assert_eq!(plan.listeners(), 3);
        assert_eq!(plan.address(2).port(), 15_022);
        assert_eq!(plan.units(2).last(), Some((449, 50)));
        let plant = Plant::new(&plan, None).expect("a sound plan");
        let count = |share: &Share| share.with(|boards| boards.len());
        assert_eq!(
            plant.shares().iter().map(count).collect::<Vec<_>>(),
            [200, 200, 50]
        );
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let refused = |plan: Plan| Plant::new(&plan, None).err();
        assert_eq!(refused(plan(0)), Some(PlanError::None));
        assert_eq!(
            refused(Plan {
                per_port: 248,
                ..plan(5)
            }),
            Some(PlanError::PerPort(248))
        );
        assert!(matches!(
            refused(Plan {
                faulty: 6,
                ..plan(5)
            }),
            Some(PlanError::Faulty { .. })
        ));
        let listen = "127.0.0.1:65535".parse().expect("an address");
        assert!(matches!(
            refused(Plan {
                listen,
                ..plan(201)
            }),
            Some(PlanError::Ports { .. })
        ));
        assert!(
            refused(Plan {
                listen,
                ..plan(200)
            })
            .is_none()
        );
    }
}
