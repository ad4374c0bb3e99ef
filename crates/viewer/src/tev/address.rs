//! Where tev listens.

use std::fmt;
use std::net::Ipv6Addr;
use std::str::FromStr;
use thiserror::Error;

/// tev's own port.
const PORT: u16 = 14158;

/// The host and the port on which tev listens: `127.0.0.1:14158`, `desk.example`, `[::1]:14158`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TevAddress {
    pub(super) host: String,
    pub(super) port: u16,
}

/// A text that is no address.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("expected HOST or HOST:PORT, such as 127.0.0.1:{PORT} or [::1]:{PORT}")]
pub struct InvalidAddress;

impl FromStr for TevAddress {
    type Err = InvalidAddress;

    fn from_str(text: &str) -> Result<Self, InvalidAddress> {
        let (host, port) = match text.strip_prefix('[') {
            Some(rest) => {
                let (host, port) = rest.split_once(']').ok_or(InvalidAddress)?;
                host.parse::<Ipv6Addr>().map_err(|_| InvalidAddress)?;
                (host, port)
            }
            // Without brackets colons are those of an address of version 6, or precede the port.
            None if text.parse::<Ipv6Addr>().is_ok() => (text, ""),
            None => {
                let end = text.find(':').unwrap_or(text.len());
                let (host, port) = text.split_at(end);
                let is_name = |c: char| c.is_alphanumeric() || "-._%".contains(c);
                if host.is_empty() || !host.chars().all(is_name) {
                    return Err(InvalidAddress);
                }
                (host, port)
            }
        };
        Ok(Self {
            host: host.to_owned(),
            port: port_of(port)?,
        })
    }
}

/// The port in what follows the host: nothing, or a colon and a number.
fn port_of(text: &str) -> Result<u16, InvalidAddress> {
    if text.is_empty() {
        return Ok(PORT);
    }
    let port = text.strip_prefix(':').ok_or(InvalidAddress)?;
    let port = port.parse().map_err(|_| InvalidAddress)?;
    if port == 0 {
        Err(InvalidAddress)
    } else {
        Ok(port)
    }
}

impl fmt::Display for TevAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.host.contains(':') {
            write!(f, "[{}]:{}", self.host, self.port)
        } else {
            write!(f, "{}:{}", self.host, self.port)
        }
    }
}
