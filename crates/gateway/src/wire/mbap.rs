//! Frames of Modbus TCP: seven bytes before what the serial line carries between address and checksum
//! (MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 3.1).

use std::io::{Error, ErrorKind, Result};

use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};

/// Transaction, protocol, length, unit.
const HEADER_BYTES: usize = 7;
/// Function and data, at most.
const MOST_BYTES: usize = 253;
/// The only protocol there is.
const MODBUS: u16 = 0;

/// One frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Frame {
    /// An answer has that of its question.
    pub transaction: u16,
    /// Who is asked, or answers.
    pub unit: u8,
    /// Function and data.
    pub content: Vec<u8>,
}

/// The next frame; `None` where the other side has closed the connection between two frames.
///
/// # Errors
/// The connection broke, or what comes is not Modbus TCP: nothing that follows can be trusted then.
pub(crate) async fn read(stream: &mut (impl AsyncRead + Unpin)) -> Result<Option<Frame>> {
    let mut header = [0; HEADER_BYTES];
    if stream.read(&mut header[..1]).await? == 0 {
        return Ok(None);
    }
    stream.read_exact(&mut header[1..]).await?;
    let [t0, t1, p0, p1, l0, l1, unit] = header;
    let length = usize::from(u16::from_be_bytes([l0, l1]));
    // The length counts the unit.
    if u16::from_be_bytes([p0, p1]) != MODBUS || !(2..=MOST_BYTES + 1).contains(&length) {
        return Err(Error::new(ErrorKind::InvalidData, "this is not Modbus TCP"));
    }
    let mut content = vec![0; length - 1];
    stream.read_exact(&mut content).await?;
    Ok(Some(Frame {
        transaction: u16::from_be_bytes([t0, t1]),
        unit,
        content,
    }))
}

/// Sends a frame of at most 253 bytes of content.
///
/// # Errors
/// The connection broke.
pub(crate) async fn write(stream: &mut (impl AsyncWrite + Unpin), frame: &Frame) -> Result<()> {
    let length = frame.content.len() as u16 + 1;
    let [[t0, t1], [p0, p1], [l0, l1]] = [frame.transaction, MODBUS, length].map(u16::to_be_bytes);
    let mut bytes = vec![t0, t1, p0, p1, l0, l1, frame.unit];
    bytes.extend_from_slice(&frame.content);
    stream.write_all(&bytes).await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test(flavor = "current_thread")]
    async fn a_frame_comes_back_and_lies_as_the_guide_says() {
        let frame = Frame {
            transaction: 0x1501,
            unit: 0xFF,
            content: vec![3, 0, 4, 0, 1],
        };
        let mut bytes = Vec::new();
        write(&mut bytes, &frame).await.expect("memory");
        // The guide's own example, 4.4.2.
        assert_eq!(bytes, [0x15, 1, 0, 0, 0, 6, 0xFF, 3, 0, 4, 0, 1]);
        let mut stream = &bytes[..];
        assert_eq!(read(&mut stream).await.expect("a frame"), Some(frame));
        assert_eq!(read(&mut stream).await.expect("the end"), None);
    }

    #[tokio::test(flavor = "current_thread")]
    async fn what_is_no_frame_is_refused() {
        let cases: [&[u8]; 4] = [
            b"GET / HTTP/1.1\r\n\r\n",
            &[0, 1, 0, 0, 0, 1, 1],
            &[0, 1, 0, 0, 0xFF, 0xFF, 1],
            &[0, 1, 0],
        ];
        for mut bytes in cases {
            assert!(read(&mut bytes).await.is_err());
        }
    }
}
