//! The beginning of a stream, looked at before the stream is read from the beginning.

use std::io::{self, Cursor, Read};

/// Reads up to `most` bytes and gives them back with a reader of the whole stream.
///
/// An error behind the first bytes is met again where the file is read that far.
pub(super) fn peek(mut stream: Box<dyn Read>, most: u64) -> (Vec<u8>, Box<dyn Read>) {
    let mut head = Vec::new();
    let ended = stream.by_ref().take(most).read_to_end(&mut head);
    let rest = Once(ended.err()).chain(stream);
    let whole = Cursor::new(head.clone()).chain(rest);
    (head, Box::new(whole))
}

/// An error that is met once.
struct Once(Option<io::Error>);

impl Read for Once {
    fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
        self.0.take().map_or(Ok(0), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_stream_is_read_again_and_so_is_its_error() {
        let broken = Once(Some(io::Error::other("torn")));
        let (head, mut whole) = peek(Box::new(Cursor::new(b"abc").chain(broken)), 100);
        assert_eq!(head, b"abc");
        let mut text = Vec::new();
        assert!(whole.read_to_end(&mut text).is_err());
        assert_eq!(text, b"abc");
        let (head, mut whole) = peek(Box::new(Cursor::new(b"abc")), 2);
        let mut text = String::new();
        whole.read_to_string(&mut text).unwrap();
        assert_eq!((head.as_slice(), text.as_str()), (b"ab".as_slice(), "abc"));
    }
}
