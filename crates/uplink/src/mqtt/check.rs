//! What can be said of a broker's configuration before there is a line.

use super::error::LineError;
use super::line::password;
use super::{MqttConfig, tls};

/// Reads the password, the authority and the own certificate with its key, as each session will.
///
/// # Errors
/// The first file that cannot be used, and what is wrong with it.
pub fn check_files(config: &MqttConfig) -> Result<(), LineError> {
    if let Some((_, file)) = &config.user {
        password(file)?;
    }
    config.tls.as_ref().map_or(Ok(()), tls::check_files)
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};
    use std::process::Command;

    use super::*;
    use crate::mqtt::{OwnCertificate, TlsConfig};
    use crate::sparkplug::Names;

    fn openssl(folder: &Path, arguments: &str) {
        let mut command = Command::new("openssl");
        let command = command.current_dir(folder).args(arguments.split(' '));
        let done = command.output().expect("openssl");
        assert!(done.status.success(), "{arguments}: {done:?}");
    }

    const KEY: &str = "-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=gateway";

    /// A certificate that signed itself, with its key.
    fn authority(folder: &Path) {
        openssl(
            folder,
            &format!("req -x509 {KEY} -keyout ca.key -out ca.pem"),
        );
    }

    /// One that the authority signed, of X.509 version 1 or 3.
    fn signed(folder: &Path, version: u8) {
        openssl(folder, &format!("req {KEY} -keyout own.key -out own.csr"));
        std::fs::write(folder.join("extensions"), "basicConstraints=CA:FALSE\n").expect("written");
        let sign = "x509 -req -in own.csr -CA ca.pem -CAkey ca.key -CAcreateserial -out own.pem";
        match version {
            3 => openssl(folder, &format!("{sign} -extfile extensions")),
            // OpenSSL 3.2 and later write version 3 unasked.
            _ => openssl(folder, sign),
        }
    }

    fn config(folder: &Path, key: &str) -> MqttConfig {
        let names = Names::new("Hall", "gateway").expect("sound");
        let mut config = MqttConfig::new("broker", 8883, names);
        let file = |name: &str| -> PathBuf { folder.join(name) };
        config.tls = Some(TlsConfig {
            ca_file: Some(file("ca.pem")),
            own: Some(OwnCertificate {
                certificate_file: file("own.pem"),
                key_file: file(key),
            }),
        });
        config
    }

    fn told(config: &MqttConfig) -> String {
        check_files(config).expect_err("wrong").to_string()
    }

    #[test]
    fn files_that_fit_pass_and_others_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        authority(folder);
        signed(folder, 3);
        let sound = config(folder, "own.key");
        check_files(&sound).expect("sound");
        assert!(told(&config(folder, "missing.key")).contains("missing.key: "));
        // The authority's key does not belong to this certificate.
        assert!(told(&config(folder, "ca.key")).contains("own.pem: "));
        std::fs::write(folder.join("ca.pem"), "no certificate\n").expect("written");
        assert!(told(&sound).ends_with("ca.pem: holds no certificate in PEM"));
    }

    #[test]
    fn an_old_certificate_is_told_with_what_to_do() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        authority(folder);
        signed(folder, 1);
        match check_files(&config(folder, "own.key")) {
            Err(error) => {
                let told = error.to_string();
                assert!(
                    told.contains("own.pem: is a certificate of X.509 version 1"),
                    "{told}"
                );
                assert!(told.contains("-extfile"), "{told}");
            }
            // This OpenSSL does not write such certificates.
            Ok(()) => {
                let text = Command::new("openssl")
                    .args(["x509", "-noout", "-text", "-in"])
                    .arg(folder.join("own.pem"))
                    .output()
                    .expect("openssl");
                assert!(String::from_utf8_lossy(&text.stdout).contains("Version: 3"));
            }
        }
    }

    #[test]
    fn a_password_that_is_not_there_is_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut config = config(folder.path(), "own.key");
        config.user = Some(("gateway".to_owned(), folder.path().join("password")));
        assert!(told(&config).contains("password: "));
    }
}
