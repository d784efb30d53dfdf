//! Files of recorders, read and written: every kind in one program, because each program links every decoder.

mod common;
mod formats;
mod loggers;
mod malformed;
mod pieces;
mod random_input;
mod reading_real_files;
mod rounded_stamps;
mod writing;
