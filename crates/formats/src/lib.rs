//! Reads and writes the files of recorders: text, Parquet, MAT, COMTRADE, Excel, WAV.
//!
//! [`read_recording`] turns a file into a [`Recording`](recording::Recording) in SI units, with every
//! assumption that this took written down beside it. Whatever is wrong with a file becomes an
//! [`Error`](recording::Error) that names file, line, column and remedy.
//!
//! ```
//! use formats::read_recording;
//! use recording::Mapping;
//!
//! let file = "../../tests/data/peer/none/recording.csv.gz".as_ref();
//! let recording = read_recording(file, &Mapping::default(), &mut |_| {}).expect("readable");
//! assert!((recording.t_sample() - 1e-4).abs() < 1e-12);
//! ```

mod contained;
mod read;
mod rows;
mod seal;
mod write;

pub use read::{
    MemoryTable, PIECE_ROWS, Preview, Progress, preview, read_any, read_in_pieces, read_load_table,
    read_recording, read_stream, read_stream_in_pieces, read_table, with_most_numbers,
    workbook_text,
};
pub use rows::{RowsWriter, read_rows, write_rows};
pub use write::{
    reading_text, sidecar_text, write_csv, write_in_pieces, write_parquet, write_recording,
    write_whole,
};
