//! The stream to a broker: TCP, or TLS over it (rustls with ring).

use std::path::Path;
use std::sync::Arc;

use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName};
use rustls::{ClientConfig, RootCertStore};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;

use super::error::LineError;
use super::{MqttConfig, TlsConfig};

/// What an encrypted and a plain line have in common.
pub(super) trait Both: AsyncRead + AsyncWrite + Unpin + Send {}
impl<T: AsyncRead + AsyncWrite + Unpin + Send> Both for T {}

/// Bytes to and from a broker.
pub(super) type Stream = Box<dyn Both>;

/// Opens the stream to a broker as the configuration says.
pub(super) async fn open(
    config: &MqttConfig,
    (host, port): (&str, u16),
) -> Result<Stream, LineError> {
    let plain = TcpStream::connect((host, port)).await?;
    plain.set_nodelay(true)?;
    let Some(tls) = &config.tls else {
        return Ok(Box::new(plain));
    };
    let name = ServerName::try_from(host.to_owned())
        .map_err(|_| LineError::Refused(format!("{host} is no name for TLS")))?;
    let encrypted = TlsConnector::from(client(tls)?)
        .connect(name, plain)
        .await?;
    Ok(Box::new(encrypted))
}

/// Whether the files of the configuration can be used.
///
/// # Errors
/// The file, and what is wrong with it.
pub(super) fn check_files(tls: &TlsConfig) -> Result<(), LineError> {
    client(tls).map(|_| ())
}

fn client(tls: &TlsConfig) -> Result<Arc<ClientConfig>, LineError> {
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let roots = match &tls.ca_file {
        Some(file) => roots_of_file(file)?,
        None => roots_of_system(),
    };
    let config = ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(|error| LineError::Protocol(error.to_string()))?
        .with_root_certificates(roots);
    let config = match &tls.own {
        None => config.with_no_client_auth(),
        Some(own) => {
            let (certificate, key) = (&own.certificate_file, &own.key_file);
            let certificates = certificates(certificate)?;
            let secret = PrivateKeyDer::from_pem_file(key).map_err(|e| wrong(key, &e))?;
            let with_own = config.with_client_auth_cert(certificates, secret);
            with_own.map_err(|error| wrong(certificate, &in_words(&error)))?
        }
    };
    Ok(Arc::new(config))
}

/// rustls names an old certificate by the variant of its type alone.
fn in_words(error: &rustls::Error) -> String {
    match error.to_string() {
        told if told.contains("UnsupportedCertVersion") => {
            "is a certificate of X.509 version 1, and TLS takes version 3: sign it with extensions (openssl x509 -req ... -extfile FILE, \
             where FILE has basicConstraints=CA:FALSE)"
                .to_owned()
        }
        told => told,
    }
}

fn wrong(file: &Path, error: &dyn std::fmt::Display) -> LineError {
    LineError::File {
        path: file.display().to_string(),
        error: error.to_string(),
    }
}

fn certificates(file: &Path) -> Result<Vec<CertificateDer<'static>>, LineError> {
    let found = CertificateDer::pem_file_iter(file).map_err(|error| wrong(file, &error))?;
    let found: Result<Vec<_>, _> = found.collect();
    let found = found.map_err(|error| wrong(file, &error))?;
    match found.is_empty() {
        true => Err(wrong(file, &"holds no certificate in PEM")),
        false => Ok(found),
    }
}

fn roots_of_file(file: &Path) -> Result<RootCertStore, LineError> {
    let mut roots = RootCertStore::empty();
    for certificate in certificates(file)? {
        roots
            .add(certificate)
            .map_err(|error| wrong(file, &error))?;
    }
    Ok(roots)
}

/// Certificates that the system believes and that can be read; without any, no broker is believed.
fn roots_of_system() -> RootCertStore {
    let mut roots = RootCertStore::empty();
    roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
    roots
}
