//! Access control: only pages of this server have access, and clients on other machines need the token.
//!
//! A page of another site could send requests to this server from a browser on this machine. Browsers
//! keep it from reading the answers, but not those of WebSockets, nor after DNS rebinding, which makes
//! the name of the site point to this machine. So if the server is on the loopback, the `Host` of a
//! request has to be the server's own, and an `Origin` has to match the `Host`.

use super::error::Refusal;
use axum::http::{HeaderMap, StatusCode, Uri, header};
use std::fmt::Write;
use std::io;
use std::net::SocketAddr;
use subtle::ConstantTimeEq;

/// Size of a token. Unit: bytes.
const TOKEN: usize = 16;

/// The credentials that requests need.
#[derive(Debug)]
pub(super) struct Access {
    address: SocketAddr,
    /// The token. None: the server is on the loopback.
    token: Option<String>,
}

impl Access {
    /// Returns the access to a server on `address`.
    ///
    /// Errors: the system has no random numbers.
    pub(super) fn new(address: SocketAddr) -> io::Result<Self> {
        let is_open = !address.ip().is_loopback();
        let token = is_open.then(random_token).transpose()?;
        Ok(Self { address, token })
    }

    /// Returns the URL that a user opens. It has the loopback instead of an unspecified address, such as 0.0.0.0.
    pub(super) fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(match address {
                SocketAddr::V4(_) => std::net::Ipv4Addr::LOCALHOST.into(),
                SocketAddr::V6(_) => std::net::Ipv6Addr::LOCALHOST.into(),
            });
        }
        match &self.token {
            Some(token) => format!("http://{address}/?token={token}"),
            None => format!("http://{address}/"),
        }
    }

    /// Refuses requests without access.
    pub(super) fn check(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = text(headers, header::HOST).unwrap_or_default();
        if self.token.is_none() && !self.is_own(host) {
            return Err(forbidden("the Host is not this server"));
        }
        if headers.contains_key(header::ORIGIN) {
            let origin = text(headers, header::ORIGIN).unwrap_or_default();
            let plain = origin.strip_prefix("http://");
            let site = plain.or_else(|| origin.strip_prefix("https://"));
            if !site.is_some_and(|site| site.eq_ignore_ascii_case(host)) {
                return Err(forbidden("the Origin is another site"));
            }
        }
        // Embedded files are no secret, and modules load each other without a token.
        if super::assets::is_asset(uri.path()) || self.has_token(uri.query().unwrap_or_default()) {
            return Ok(());
        }
        Err(forbidden(
            "the token is missing or wrong: use the URL that was printed",
        ))
    }

    fn is_own(&self, host: &str) -> bool {
        let port = self.address.port();
        let names = ["localhost", "127.0.0.1", "[::1]"].map(|name| format!("{name}:{port}"));
        let own = names.into_iter().chain([self.address.to_string()]);
        own.into_iter().any(|own| own.eq_ignore_ascii_case(host))
    }

    fn has_token(&self, query: &str) -> bool {
        let Some(token) = &self.token else {
            return true;
        };
        let given = query
            .split('&')
            .find_map(|pair| pair.strip_prefix("token="));
        let shown = given.unwrap_or_default();
        bool::from(shown.as_bytes().ct_eq(token.as_bytes()))
    }
}

/// Returns the value of a header. None: it is missing or not plain text.
fn text(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

fn forbidden(message: &str) -> Refusal {
    Refusal::new(StatusCode::FORBIDDEN, message)
}

/// Returns 128 random bits in hexadecimal.
fn random_token() -> io::Result<String> {
    let mut bytes = [0; TOKEN];
    getrandom::fill(&mut bytes).map_err(io::Error::other)?;
    let mut token = String::new();
    for byte in bytes {
        // Writing to a string cannot fail.
        let _ = write!(token, "{byte:02x}");
    }
    Ok(token)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn access(address: &str) -> Access {
        Access::new(address.parse().unwrap()).unwrap()
    }

    #[track_caller]
    fn check(access: &Access, uri: &str, headers: &[(&'static str, &str)], allowed: bool) {
        let headers = headers.iter().map(|(name, value)| {
            let name = header::HeaderName::from_static(name);
            (name, value.parse().unwrap())
        });
        let checked = access.check(&uri.parse().unwrap(), &headers.collect());
        assert_eq!(checked.is_ok(), allowed, "{uri}");
    }

    #[test]
    fn on_the_loopback_the_host_is_its_own() {
        let access = access("127.0.0.1:8080");
        assert_eq!(access.url(), "http://127.0.0.1:8080/");
        for host in ["127.0.0.1:8080", "localhost:8080", "LocalHost:8080"] {
            check(&access, "/status", &[("host", host)], true);
        }
        for host in ["127.0.0.1", "localhost:80", "example.org:8080", ""] {
            check(&access, "/status", &[("host", host)], false);
        }
        check(&access, "/status", &[], false);
    }

    #[test]
    fn pages_of_others_are_refused() {
        let access = access("127.0.0.1:8080");
        let check = |origin, allowed| {
            let headers = [("host", "localhost:8080"), ("origin", origin)];
            check(&access, "/live", &headers, allowed);
        };
        check("http://localhost:8080", true);
        for origin in [
            "http://localhost:8081",
            "http://example.org",
            "null",
            "",
            "localhost:8080",
        ] {
            check(origin, false);
        }
    }

    #[test]
    fn elsewhere_the_token_is_asked_for() {
        let access = access("192.0.2.1:8080");
        let url = access.url();
        let (_, token) = url.split_once("?token=").unwrap();
        assert_eq!(token.len(), 32);
        let host = [("host", "render.example.org")];
        check(&access, &format!("/status?token={token}"), &host, true);
        check(&access, &format!("/pixel?x=1&token={token}"), &host, true);
        check(&access, "/assets/main.js", &host, true);
        for query in [
            "",
            "?token=",
            &format!("?token={}", &token[1..]),
            "?token=0",
        ] {
            check(&access, &format!("/status{query}"), &host, false);
        }
        assert_ne!(
            url,
            Access::new("192.0.2.1:8080".parse().unwrap())
                .unwrap()
                .url()
        );
    }
}
