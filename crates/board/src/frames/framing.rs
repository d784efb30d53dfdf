//! How anything travels to a computer: postcard, CRC-32, COBS, a zero byte behind.
//!
//! COBS keeps zeros out of a frame, so that a reader that comes in the middle waits for the next zero.

use serde::Serialize;

use crate::checksum::crc32;

/// What the fields mean; a reader refuses every other number.
pub(crate) const SCHEMA: u8 = 2;
/// Bytes of the longest frame, zero byte included: 102 of content at most, 4 of checksum, 2 of COBS and end.
pub const MAX_FRAME_BYTES: usize = 112;
const CHECKSUM_BYTES: usize = 4;

/// Writes `value` and returns the bytes with the zero behind. Empty when it does not fit; the longest values are tested to.
pub(crate) fn encode<'a>(
    value: &impl Serialize,
    buffer: &'a mut [u8; MAX_FRAME_BYTES],
) -> &'a [u8] {
    let mut plain = [0; MAX_FRAME_BYTES - 2];
    let length =
        write_plain(value, &mut plain).and_then(|used| write_encoded(plain.get(..used)?, buffer));
    buffer.get(..length.unwrap_or(0)).unwrap_or_default()
}

fn write_encoded(plain: &[u8], buffer: &mut [u8; MAX_FRAME_BYTES]) -> Option<usize> {
    let encoded = cobs::try_encode(plain, buffer).ok()?;
    *buffer.get_mut(encoded)? = 0;
    Some(encoded + 1)
}

fn write_plain(value: &impl Serialize, plain: &mut [u8]) -> Option<usize> {
    let used = postcard::to_slice(value, plain).ok()?.len();
    let checksum = crc32(plain.get(..used)?).to_le_bytes();
    let end = used + CHECKSUM_BYTES;
    plain.get_mut(used..end)?.copy_from_slice(&checksum);
    Some(end)
}

/// The content of a frame, its checksum verified; the zero byte behind it may be there or not.
pub(crate) fn decode<'a>(
    bytes: &[u8],
    plain: &'a mut [u8; MAX_FRAME_BYTES],
) -> Result<&'a [u8], FrameError> {
    let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
    let length = cobs::decode(bytes, plain).map_err(|_| FrameError::Framing)?;
    let plain = plain.get(..length).ok_or(FrameError::Framing)?;
    let (content, checksum) = plain
        .split_last_chunk::<CHECKSUM_BYTES>()
        .ok_or(FrameError::Framing)?;
    if crc32(content) == u32::from_le_bytes(*checksum) {
        Ok(content)
    } else {
        Err(FrameError::Checksum)
    }
}

/// Frame decoding error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// Not COBS, or too short or too long.
    Framing,
    /// Damaged on the way.
    Checksum,
    /// From another version of the firmware.
    Schema(u8),
    /// The checksum holds and the content does not.
    Content,
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            FrameError::Framing => f.write_str("not a frame: wrong framing or length"),
            FrameError::Checksum => f.write_str("damaged frame: wrong checksum"),
            FrameError::Schema(other) => write!(
                f,
                "frame of schema {other}, this reader knows {SCHEMA}: use the drivemon of the same version as the firmware"
            ),
            FrameError::Content => f.write_str("frame with unreadable content"),
        }
    }
}

impl core::error::Error for FrameError {}
