//! Files that appear whole or not at all.

use std::fs::{File, Permissions};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// Writes beside the file and renames when everything is on the disk: a reader sees the old file or the new one, and where
/// there is no room the old one stays. What is no file (a terminal, a pipe) is written in place; a link goes on pointing
/// to its file, whose permissions stay.
///
/// # Errors
/// Whatever the system refuses; nothing is left behind then.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let old = std::fs::metadata(path).ok();
    if old.as_ref().is_some_and(|old| !old.is_file()) {
        return fill(path, None, write);
    }
    let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let part = part_of(&path);
    let permissions = old.map(|old| old.permissions());
    let done = fill(&part, permissions, write).and_then(|()| std::fs::rename(&part, &path));
    if done.is_err() {
        // The error is the news; a leftover that cannot be removed is not.
        let _ = std::fs::remove_file(&part);
    }
    done
}

fn fill(
    path: &Path,
    permissions: Option<Permissions>,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    write(&mut file)?;
    // A buffer that is dropped keeps its error to itself.
    let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Some(permissions) = permissions {
        file.set_permissions(permissions)?;
    }
    match file.metadata()?.is_file() {
        true => file.sync_all(),
        false => Ok(()),
    }
}

fn part_of(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("whole-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        folder
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let name = |entry: io::Result<std::fs::DirEntry>| entry.expect("an entry").file_name();
        let mut names: Vec<_> = entries
            .map(|entry| name(entry).to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn what_fails_half_way_leaves_the_old_file_and_nothing_else() {
        let folder = folder("fails");
        let path = folder.join("motor.toml");
        std::fs::write(&path, "old").expect("written");
        let failed = write_whole(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::other("no room"))
        });
        assert_eq!(failed.expect_err("refused").to_string(), "no room");
        assert_eq!(std::fs::read_to_string(&path).expect("there"), "old");
        assert_eq!(names(&folder), ["motor.toml"]);
        write_whole(&path, |file| file.write_all(b"new")).expect("written");
        assert_eq!(std::fs::read_to_string(&path).expect("there"), "new");
        assert_eq!(names(&folder), ["motor.toml"]);
        std::fs::remove_dir_all(folder).expect("removed");
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay_and_a_device_is_written_in_place() {
        use std::os::unix::fs::PermissionsExt;
        let folder = folder("links");
        let (file, link) = (folder.join("file"), folder.join("link"));
        std::fs::write(&file, "old").expect("written");
        std::fs::set_permissions(&file, Permissions::from_mode(0o640)).expect("set");
        std::os::unix::fs::symlink(&file, &link).expect("linked");
        write_whole(&link, |out| out.write_all(b"new")).expect("written");
        assert!(
            std::fs::symlink_metadata(&link)
                .expect("there")
                .is_symlink()
        );
        assert_eq!(std::fs::read_to_string(&file).expect("there"), "new");
        let mode = std::fs::metadata(&file)
            .expect("there")
            .permissions()
            .mode();
        assert_eq!(mode & 0o777, 0o640);
        std::fs::remove_dir_all(folder).expect("removed");

        let full = Path::new("/dev/full");
        if full.exists() {
            let refused = write_whole(full, |out| out.write_all(b"no room"));
            assert!(refused.is_err(), "the buffer's error is told");
            let device = std::fs::metadata(full).expect("there");
            assert!(!device.is_file(), "the device is still one");
        }
    }
}
