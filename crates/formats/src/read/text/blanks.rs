//! Runs of blanks and tabs as single tabs.

use std::io::{self, Read};

/// A stream in which each run of blanks and tabs within a line is one tab, and none begins or ends a line.
pub(super) struct Blanks<R> {
    stream: R,
    /// Whether something but blanks was in the line.
    began: bool,
    /// Whether blanks were met that a cell may follow.
    pending: bool,
    ready: Vec<u8>,
}

impl<R: Read> Blanks<R> {
    pub fn new(stream: R) -> Blanks<R> {
        Blanks {
            stream,
            began: false,
            pending: false,
            ready: Vec::new(),
        }
    }

    fn pass(&mut self, byte: u8) {
        match byte {
            b' ' | b'\t' => self.pending = self.began,
            b'\n' => {
                (self.began, self.pending) = (false, false);
                self.ready.push(byte);
            }
            _ => {
                if std::mem::take(&mut self.pending) {
                    self.ready.push(b'\t');
                }
                self.began = true;
                self.ready.push(byte);
            }
        }
    }
}

impl<R: Read> Read for Blanks<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.ready.is_empty() {
            let n = self.stream.read(buffer)?;
            if n == 0 {
                return Ok(0);
            }
            buffer[..n].iter().for_each(|byte| self.pass(*byte));
        }
        let n = self.ready.len().min(buffer.len());
        buffer[..n].copy_from_slice(&self.ready[..n]);
        self.ready.drain(..n);
        Ok(n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_become_single_tabs() {
        let mut text = String::new();
        let stream = Blanks::new("  0.1  \t1 2 \n\n a\n".as_bytes());
        stream.take(100).read_to_string(&mut text).unwrap();
        assert_eq!(text, "0.1\t1\t2\n\na\n");
    }
}
