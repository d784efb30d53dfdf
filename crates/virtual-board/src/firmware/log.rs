//! The firmware's log in words: defmt frames from the debugger's channel 0, decoded with the strings in the ELF.

use defmt_decoder::Table;
use live::LogSplitter;

use crate::error::BoardError;

/// Joins the bytes of the log to lines and frames.
pub(crate) struct Log {
    table: Table,
    splitter: LogSplitter,
    messages: Vec<u8>,
    frames: Vec<u8>,
}

impl Log {
    /// Reads the strings of a firmware file.
    pub fn parse(elf: &[u8]) -> Result<Self, BoardError> {
        let table = Table::parse(elf).map_err(|error| BoardError::Elf(error.to_string()))?;
        let table = table.ok_or_else(|| BoardError::Elf("it holds no defmt strings".into()))?;
        Ok(Log {
            table,
            splitter: LogSplitter::default(),
            messages: Vec::new(),
            frames: Vec::new(),
        })
    }

    /// Takes what the debugger's channel held.
    pub fn take(&mut self, bytes: &[u8]) {
        let parts = self.splitter.take(bytes);
        self.messages.extend(parts.messages);
        self.frames.extend(parts.frames);
    }

    /// The frames since the last call.
    pub fn frames(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.frames)
    }

    /// The lines since the last call; one that cannot be decoded says so.
    pub fn lines(&mut self) -> Vec<String> {
        let messages = std::mem::take(&mut self.messages);
        // Between two messages there may be more than one zero.
        let whole = messages.split_inclusive(|byte| *byte == 0);
        let said = whole.filter(|message| *message != [0]);
        said.map(|message| self.line(message)).collect()
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
