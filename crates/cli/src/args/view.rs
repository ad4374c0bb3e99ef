//! The flags of `bidir view`.

use super::render::FilmArgs;
use super::{SceneArgs, ThreadsArgs, values};
use bidir::settings::Request;
use clap::Args;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};

/// The scene and its settings, and the address of the page.
#[derive(Args, Debug)]
#[command(after_long_help = include_str!("view.txt").trim_end())]
pub(crate) struct ViewArgs {
    /// Port; 0 is any free one [default: 8080, or one of the next ten].
    #[arg(long, value_name = "N", help_heading = "Server")]
    #[arg(value_parser = values::count::<u16>(0..=u16::MAX.into()))]
    pub(crate) port: Option<u16>,
    /// Address that the page is served on.
    ///
    /// For any other address than the loopback, the URL carries a random token that every request
    /// needs. The connection is not encrypted: use a tunnel across networks that are not yours.
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    #[arg(help_heading = "Server")]
    pub(crate) bind: IpAddr,
    /// The image's geometry.
    #[command(flatten)]
    pub(crate) film: FilmArgs,
    /// Stop rendering at this number of samples per pixel; the page stays [default: unlimited].
    #[arg(long, env = "BIDIR_SPP", value_name = "N", help_heading = "Stopping")]
    #[arg(value_parser = values::count::<u64>(1..=u64::MAX))]
    pub(crate) spp: Option<u64>,
    /// The settings of the estimator.
    #[command(flatten)]
    pub(crate) estimator: Request,
    /// The scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// The number of threads.
    #[command(flatten, next_help_heading = "Scene and machine")]
    pub(crate) threads: ThreadsArgs,
    /// Print only the URL, warnings and errors.
    #[arg(short, long, help_heading = "Server")]
    pub(crate) quiet: bool,
}

/// Reads the address of a server: `8080`, `:8080`, `192.0.2.1:8080`, `[::1]:8080`.
pub(super) fn serve_address(text: &str) -> Result<SocketAddr, String> {
    let port = text.strip_prefix(':').unwrap_or(text).parse::<u16>();
    let address = match port {
        Ok(port) => Ok(SocketAddr::new(Ipv4Addr::LOCALHOST.into(), port)),
        Err(_) => text.parse(),
    };
    address.map_err(|_| "expected [ADDRESS:]PORT, such as 8080 or 0.0.0.0:8080".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, expected: Option<&str>) {
        let address = serve_address(text).ok().map(|address| address.to_string());
        assert_eq!(address.as_deref(), expected);
    }

    #[test]
    fn the_default_address_is_the_loopback() {
        check("8080", Some("127.0.0.1:8080"));
        check(":0", Some("127.0.0.1:0"));
        check("0.0.0.0:80", Some("0.0.0.0:80"));
        check("[::1]:8080", Some("[::1]:8080"));
        for wrong in ["", ":", "65536", "localhost", "example.org:80", "1.2.3.4"] {
            check(wrong, None);
        }
    }
}
