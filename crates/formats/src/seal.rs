//! One checksum over everything that a Parquet file of ours says: its pages have their own, its footer has none.

use flate2::Crc;

/// Who writes such files; a file that another program has written since holds what that program made of it.
pub(crate) const CREATED_BY: &str = "drive-monitor";
/// Under which key the checksum stands among the metadata.
pub(crate) const KEY: &str = "drive-monitor.crc32";

/// The checksum (CRC-32) of columns in their order, names and bits, that come in blocks of rows.
pub(crate) struct Seal {
    columns: Vec<(String, Crc)>,
    bytes: Vec<u8>,
}

impl Seal {
    /// Of columns of these names, without a row so far.
    pub fn new<'n>(names: impl Iterator<Item = &'n str>) -> Seal {
        Seal {
            columns: names.map(|name| (name.to_owned(), Crc::new())).collect(),
            bytes: Vec::new(),
        }
    }

    /// Takes the next rows of every column.
    pub fn add<C: AsRef<[f64]>>(&mut self, block: &[C]) {
        for ((_, crc), values) in self.columns.iter_mut().zip(block) {
            self.bytes.clear();
            let bytes = values.as_ref().iter().flat_map(|x| x.to_le_bytes());
            self.bytes.extend(bytes);
            crc.update(&self.bytes);
        }
    }

    /// The checksum of all `rows` rows that were taken.
    pub fn sum(&self, rows: u64) -> String {
        let mut all = Crc::new();
        for (name, values) in &self.columns {
            all.update(name.as_bytes());
            all.update(&rows.to_le_bytes());
            all.combine(values);
        }
        format!("{:08x}", all.sum())
    }
}

#[cfg(test)]
mod tests {
    use super::{Crc, Seal};

    #[test]
    fn blocks_of_rows_have_the_checksum_of_the_whole() {
        let columns = [
            ("t", vec![0.0, 0.1, 0.2]),
            ("ia", vec![1.0, -2.0, f64::NAN]),
        ];
        let mut whole = Crc::new();
        for (name, values) in &columns {
            whole.update(name.as_bytes());
            whole.update(&3_u64.to_le_bytes());
            values.iter().for_each(|x| whole.update(&x.to_le_bytes()));
        }
        let mut seal = Seal::new(columns.iter().map(|(name, _)| *name));
        for rows in [0..2, 2..3] {
            let block: Vec<&[f64]> = columns.iter().map(|(_, x)| &x[rows.clone()]).collect();
            seal.add(&block);
        }
        assert_eq!(seal.sum(3), format!("{:08x}", whole.sum()));
        assert_ne!(seal.sum(2), seal.sum(3));
    }
}
