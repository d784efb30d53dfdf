//! The stream to a broker: TCP, or TLS over it (rustls with ring).

use std::path::Path;
use std::sync::Arc;

use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, ServerName};
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

/// Opens the stream that the configuration names.
pub(super) async fn open(config: &MqttConfig) -> Result<Stream, LineError> {
    let plain = TcpStream::connect((config.host.as_str(), config.port)).await?;
    plain.set_nodelay(true)?;
    let Some(tls) = &config.tls else {
        return Ok(Box::new(plain));
    };
    let name = ServerName::try_from(config.host.clone())
        .map_err(|_| LineError::Refused(format!("{} is no name for TLS", config.host)))?;
    let encrypted = TlsConnector::from(client(tls)?)
        .connect(name, plain)
        .await?;
    Ok(Box::new(encrypted))
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
        .with_root_certificates(roots)
        .with_no_client_auth();
    Ok(Arc::new(config))
}

fn roots_of_file(file: &Path) -> Result<RootCertStore, LineError> {
    let wrong = |error: String| LineError::File {
        path: file.display().to_string(),
        error,
    };
    let mut roots = RootCertStore::empty();
    let found = CertificateDer::pem_file_iter(file).map_err(|error| wrong(error.to_string()))?;
    for certificate in found {
        let certificate = certificate.map_err(|error| wrong(error.to_string()))?;
        roots
            .add(certificate)
            .map_err(|error| wrong(error.to_string()))?;
    }
    if roots.is_empty() {
        return Err(wrong("holds no certificate in PEM".to_owned()));
    }
    Ok(roots)
}

/// Certificates that the system believes and that can be read; without any, no broker is believed.
fn roots_of_system() -> RootCertStore {
    let mut roots = RootCertStore::empty();
    roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
    roots
}
