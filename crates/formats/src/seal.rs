//! One checksum over everything that a Parquet file of ours says: its pages have their own, its footer has none.

use flate2::Crc;

/// Who writes such files; a file that another program has written since holds what that program made of it.
pub(crate) const CREATED_BY: &str = "drive-monitor";
/// Under which key the checksum stands among the metadata.
pub(crate) const KEY: &str = "drive-monitor.crc32";

/// The checksum (CRC-32) of columns in their order: names and bits.
pub(crate) fn of<'c>(columns: impl IntoIterator<Item = (&'c str, &'c [f64])>) -> String {
    let mut crc = Crc::new();
    for (name, values) in columns {
        crc.update(name.as_bytes());
        crc.update(&(values.len() as u64).to_le_bytes());
        values.iter().for_each(|x| crc.update(&x.to_le_bytes()));
    }
    format!("{:08x}", crc.sum())
}
