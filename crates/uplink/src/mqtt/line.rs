//! A connection to a broker (MQTT 3.1.1): bytes in and out; the protocol is `mqtt-protocol-core`'s.

use std::collections::VecDeque;

use mqtt_protocol_core::mqtt;
use mqtt_protocol_core::mqtt::connection::{ConnectionOptions, Event};
use mqtt_protocol_core::mqtt::packet::{
    GenericPacket, GenericPacketTrait, Qos, SubEntry, SubOpts, v3_1_1,
};
use mqtt_protocol_core::mqtt::result_code::MqttError;
use mqtt_protocol_core::mqtt::role::Client;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::time::timeout;

use super::MqttConfig;
use super::error::{LineError, PATIENCE};
use super::tls::{Stream, open};
use crate::sparkplug::Message;

/// Largest packet that is taken from a broker, bytes: a command, a STATE message.
const LARGEST: u32 = 128 * 1024;
/// Bytes that are collected before they are sent.
const MOST_AT_ONCE: usize = 64 * 1024;

/// What came from the broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Arrived {
    /// The subscriptions are in force.
    Subscribed,
    /// A message.
    Message {
        /// Its topic.
        topic: String,
        /// Its payload.
        payload: Vec<u8>,
    },
    /// The answer to a ping: the broker has taken everything that was sent before it.
    Pong,
}

/// A connection to a broker.
pub struct Line {
    stream: Stream,
    /// What is to be sent and was not yet.
    out: Vec<u8>,
    protocol: mqtt::Connection<Client>,
    arrived: VecDeque<Arrived>,
    buffer: Box<[u8]>,
}

impl Line {
    /// Connects, with a will, and subscribes.
    ///
    /// # Errors
    /// The broker cannot be reached, does not answer, or refuses.
    pub async fn open(
        config: &MqttConfig,
        broker: (&str, u16),
        will: &Message,
        topics: &[String],
    ) -> Result<Line, LineError> {
        let stream = within(open(config, broker)).await?;
        let options = ConnectionOptions::new().maximum_packet_size_recv(LARGEST);
        let mut protocol = mqtt::Connection::with_options(mqtt::Version::V3_1_1, options);
        protocol.set_auto_pub_response(true);
        let mut line = Line {
            stream,
            out: Vec::new(),
            protocol,
            arrived: VecDeque::new(),
            buffer: vec![0; 16 * 1024].into_boxed_slice(),
        };
        line.send(connect(config, will)?.into())?;
        // The protocol's state lets nothing be sent before the answer: no subscription either.
        while !within(line.receive_connack()).await? {}
        line.subscribe(topics)?;
        while within(line.next()).await? != Arrived::Subscribed {}
        Ok(line)
    }

    fn subscribe(&mut self, topics: &[String]) -> Result<(), LineError> {
        let at_least_once = SubOpts::new().set_qos(Qos::AtLeastOnce);
        let entries: Result<Vec<SubEntry>, MqttError> = topics
            .iter()
            .map(|topic| SubEntry::new(topic.as_str(), at_least_once))
            .collect();
        let packet = v3_1_1::Subscribe::builder()
            .packet_id(self.protocol.acquire_packet_id()?)
            .entries(entries?)
            .build()?;
        self.send(packet.into())
    }

    /// Sends messages, in their order.
    ///
    /// # Errors
    /// The line broke.
    pub async fn publish(&mut self, messages: &[Message]) -> Result<(), LineError> {
        for message in messages {
            let builder = v3_1_1::Publish::builder()
                .topic_name(message.topic.as_str())?
                .payload(message.payload.clone());
            let builder = if message.at_least_once {
                let id = self.protocol.acquire_packet_id()?;
                builder.qos(Qos::AtLeastOnce).packet_id(id)
            } else {
                builder.qos(Qos::AtMostOnce)
            };
            self.send(builder.build()?.into())?;
            if self.out.len() > MOST_AT_ONCE {
                within(self.flush()).await?;
            }
        }
        within(self.flush()).await
    }

    /// Asks for a [`Arrived::Pong`]. A broker works off what comes over one line in its order.
    ///
    /// # Errors
    /// The line broke.
    pub async fn ping(&mut self) -> Result<(), LineError> {
        self.send(v3_1_1::Pingreq::new().into())?;
        within(self.flush()).await
    }

    /// Ends the connection: the broker drops the will.
    ///
    /// # Errors
    /// The line broke before.
    pub async fn disconnect(mut self) -> Result<(), LineError> {
        // The protocol asks to close the line behind it; what it gave out before is sent.
        match self.send(v3_1_1::Disconnect::new().into()) {
            Ok(()) | Err(LineError::Closed) => {}
            Err(error) => return Err(error),
        }
        within(self.flush()).await?;
        within(async { Ok(self.stream.shutdown().await?) }).await
    }

    /// What comes next. May be dropped while it waits; nothing is lost then.
    ///
    /// # Errors
    /// The line broke, or the broker does not keep to MQTT.
    pub async fn next(&mut self) -> Result<Arrived, LineError> {
        loop {
            if let Some(arrived) = self.arrived.pop_front() {
                return Ok(arrived);
            }
            // An answer that the protocol gave to what came before.
            self.flush().await?;
            let count = self.stream.read(&mut self.buffer).await?;
            for event in self.read(count)? {
                self.work_off(event)?;
            }
        }
    }

    async fn receive_connack(&mut self) -> Result<bool, LineError> {
        self.flush().await?;
        let count = self.stream.read(&mut self.buffer).await?;
        let mut accepted = false;
        for event in self.read(count)? {
            if let Event::NotifyPacketReceived(GenericPacket::V3_1_1Connack(connack)) = &event {
                let code = connack.return_code();
                if !code.is_success() {
                    return Err(LineError::Refused(format!("{code:?}")));
                }
                accepted = true;
            }
            self.work_off(event)?;
        }
        Ok(accepted)
    }

    /// Sends what is to be sent. Dropped while it waits, it goes on where it was the next time.
    async fn flush(&mut self) -> Result<(), LineError> {
        while !self.out.is_empty() {
            let count = self.stream.write(&self.out).await?;
            if count == 0 {
                return Err(LineError::Closed);
            }
            self.out.drain(..count);
        }
        Ok(self.stream.flush().await?)
    }

    fn read(&mut self, count: usize) -> Result<Vec<Event>, LineError> {
        let bytes = self.buffer.get(..count).unwrap_or_default();
        if bytes.is_empty() {
            return Err(LineError::Closed);
        }
        let mut cursor = mqtt::common::Cursor::new(bytes);
        let mut events = Vec::new();
        while (cursor.position() as usize) < bytes.len() {
            events.extend(self.protocol.recv(&mut cursor));
            if let Some(Event::NotifyError(error)) = events.last() {
                return Err((*error).into());
            }
        }
        Ok(events)
    }

    fn send(&mut self, packet: GenericPacket<u16>) -> Result<(), LineError> {
        let events = self.protocol.send(packet);
        events
            .into_iter()
            .try_for_each(|event| self.work_off(event))
    }

    fn work_off(&mut self, event: Event) -> Result<(), LineError> {
        match event {
            Event::RequestSendPacket { packet, .. } => {
                self.out.extend(packet.to_continuous_buffer());
            }
            Event::NotifyPacketReceived(packet) => self.arrive(packet)?,
            Event::NotifyError(error) => return Err(error.into()),
            Event::RequestClose => return Err(LineError::Closed),
            // The keep-alive is the caller's; nothing else needs an answer.
            _ => {}
        }
        Ok(())
    }

    fn arrive(&mut self, packet: GenericPacket<u16>) -> Result<(), LineError> {
        match packet {
            GenericPacket::V3_1_1Publish(publish) => self.arrived.push_back(Arrived::Message {
                topic: publish.topic_name().to_owned(),
                payload: publish.payload().as_slice().to_vec(),
            }),
            GenericPacket::V3_1_1Pingresp(_) => self.arrived.push_back(Arrived::Pong),
            GenericPacket::V3_1_1Suback(suback) => {
                if !suback.return_codes().iter().all(|code| code.is_success()) {
                    return Err(LineError::Refused("a subscription".to_owned()));
                }
                self.arrived.push_back(Arrived::Subscribed);
            }
            _ => {}
        }
        Ok(())
    }
}

async fn within<T>(work: impl Future<Output = Result<T, LineError>>) -> Result<T, LineError> {
    timeout(PATIENCE, work)
        .await
        .map_err(|_| LineError::Silent)?
}

fn connect(config: &MqttConfig, will: &Message) -> Result<v3_1_1::Connect, LineError> {
    let qos = if will.at_least_once {
        Qos::AtLeastOnce
    } else {
        Qos::AtMostOnce
    };
    let builder = v3_1_1::Connect::builder()
        .client_id(config.client_id.as_str())?
        .clean_session(true)
        .keep_alive(config.keep_alive_s)
        .will_message(will.topic.as_str(), will.payload.clone(), qos, false)?;
    let builder = match &config.user {
        Some((user, file)) => builder
            .user_name(user.as_str())?
            .password(password(file)?.into_bytes())?,
        None => builder,
    };
    Ok(builder.build()?)
}

/// First line of a file.
pub(super) fn password(file: &std::path::Path) -> Result<String, LineError> {
    let text = std::fs::read_to_string(file).map_err(|error| LineError::File {
        path: file.display().to_string(),
        error: error.to_string(),
    })?;
    Ok(text.lines().next().unwrap_or_default().to_owned())
}
