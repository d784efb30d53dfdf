//! The firmware's log in words: defmt frames from the debugger's channel 0, decoded with the strings in the ELF.

use defmt_decoder::Table;

use crate::error::BoardError;

/// Joins the bytes of the log to lines.
pub(crate) struct Log {
    table: Table,
    rest: Vec<u8>,
}

impl Log {
    /// Reads the strings of a firmware file.
    pub fn parse(elf: &[u8]) -> Result<Self, BoardError> {
        let table = Table::parse(elf).map_err(|error| BoardError::Elf(error.to_string()))?;
        let table = table.ok_or_else(|| BoardError::Elf("it holds no defmt strings".into()))?;
        Ok(Log {
            table,
            rest: Vec::new(),
        })
    }

    /// The lines that are complete with these bytes; one that cannot be decoded says so.
    pub fn lines(&mut self, bytes: &[u8]) -> Vec<String> {
        self.rest.extend(bytes);
        let mut lines = Vec::new();
        while let Some(end) = self.rest.iter().position(|byte| *byte == 0) {
            let frame: Vec<u8> = self.rest.drain(..=end).collect();
            // Between two frames there may be more than one zero.
            if frame != [0] {
                lines.push(self.line(&frame));
            }
        }
        lines
    }

    fn line(&self, frame: &[u8]) -> String {
        let mut decoder = self.table.new_stream_decoder();
        decoder.received(frame);
        match decoder.decode() {
            Ok(frame) => frame.display_message().to_string(),
            Err(error) => format!("undecodable log frame {frame:02x?}: {error}"),
        }
    }
}
