//! TLS on the listener (rustls with ring).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustls::ServerConfig;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio_rustls::TlsAcceptor;

/// What the listener proves itself by.
#[derive(Clone, Debug)]
pub struct TlsFiles {
    /// Certificates in PEM: the server's own first, then those between it and the authority.
    pub certificates: PathBuf,
    /// Its private key in PEM.
    pub key: PathBuf,
}

/// Why there is no TLS.
#[derive(Debug, thiserror::Error)]
pub enum TlsError {
    /// No certificates.
    #[error(
        "--tls-cert {path}: {error}; give a file with certificates in PEM, the server's own first"
    )]
    Certificates {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: String,
    },
    /// No key.
    #[error(
        "--tls-key {path}: {error}; give a file with the certificate's private key in PEM, without a password"
    )]
    Key {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: String,
    },
    /// They do not belong together, or cannot be used.
    #[error(
        "--tls-cert {certificates} and --tls-key {key}: {error}; both must come from the same request for a certificate"
    )]
    Pair {
        /// The file of certificates.
        certificates: PathBuf,
        /// The file of the key.
        key: PathBuf,
        /// What is wrong.
        error: rustls::Error,
    },
}

/// What answers TLS with these files, read once: a new certificate takes a new start.
///
/// # Errors
/// Files that cannot be read, hold something else or do not belong together.
pub fn acceptor(files: &TlsFiles) -> Result<TlsAcceptor, TlsError> {
    let chain = certificates(&files.certificates).map_err(|error| TlsError::Certificates {
        path: files.certificates.clone(),
        error,
    })?;
    let key = PrivateKeyDer::from_pem_file(&files.key).map_err(|error| TlsError::Key {
        path: files.key.clone(),
        error: error.to_string(),
    })?;
    let pair = |error| TlsError::Pair {
        certificates: files.certificates.clone(),
        key: files.key.clone(),
        error,
    };
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let mut config = ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(pair)?
        .with_no_client_auth()
        .with_single_cert(chain, key)
        .map_err(pair)?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(TlsAcceptor::from(Arc::new(config)))
}

fn certificates(file: &Path) -> Result<Vec<CertificateDer<'static>>, String> {
    let all = CertificateDer::pem_file_iter(file).map_err(|error| error.to_string())?;
    let all: Vec<_> = all
        .collect::<Result<_, _>>()
        .map_err(|error| error.to_string())?;
    if all.is_empty() {
        return Err("holds no certificate in PEM".to_owned());
    }
    Ok(all)
}
