//! Places of connections: their number, and the connection that leaves when all are taken.
//!
//! A connection is idle while its peer has sent no whole request, or none since the last answer. Where
//! a new one finds no place, the one that was idle for longest makes room, of the peers that have the
//! most. So connections that only wait do not keep others out, and one address does not take the places of
//! others.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::Notify;

/// Connections at once.
const PLACES: usize = 256;
/// The places of one address among them. It is enough for all clients behind one proxy.
const SHARE: usize = 128;

/// All places.
#[derive(Default)]
pub(super) struct Places(Mutex<Taken>);

#[derive(Default)]
struct Taken {
    /// Counts what happens, so that the order is known without a clock.
    now: u64,
    holders: BTreeMap<u64, Holder>,
}

/// A connection.
struct Holder {
    peer: IpAddr,
    /// A request is answered.
    is_answering: bool,
    /// Bytes wait until the peer takes them.
    is_sending: bool,
    /// When it was last neither.
    idle_since: u64,
    leave: Arc<Notify>,
}

/// The place of a connection, which is free again without it.
pub(super) struct Place {
    places: Arc<Places>,
    number: u64,
    leave: Arc<Notify>,
}

impl Places {
    /// Returns a place for a connection from `address`. None: all are taken by connections that are busy.
    pub(super) fn take(self: &Arc<Self>, address: IpAddr) -> Option<Place> {
        let peer = peer(address);
        let mut taken = self.lock();
        let of_peer = taken.count(peer);
        if of_peer >= SHARE || taken.holders.len() >= PLACES {
            taken.free(|holder| of_peer < SHARE || holder.peer == peer)?;
        }
        let leave = Arc::new(Notify::new());
        let number = taken.tick();
        let holder = Holder {
            peer,
            is_answering: false,
            is_sending: false,
            idle_since: number,
            leave: Arc::clone(&leave),
        };
        taken.holders.insert(number, holder);
        Some(Place {
            places: Arc::clone(self),
            number,
            leave,
        })
    }

    /// Ends an idle connection, where there is one.
    pub(super) fn free_one(&self) {
        self.lock().free(|_| true);
    }

    fn lock(&self) -> MutexGuard<'_, Taken> {
        // No change of it can be half done.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Taken {
    fn tick(&mut self) -> u64 {
        self.now += 1;
        self.now
    }

    /// Returns the number of places of a peer.
    fn count(&self, peer: IpAddr) -> usize {
        let of_peer = self.holders.values().filter(|holder| holder.peer == peer);
        of_peer.count()
    }

    /// Ends the connection that was idle for longest among those of the peer that has the most places,
    /// of those that `may_end`. None: none is idle.
    fn free(&mut self, may_end: impl Fn(&Holder) -> bool) -> Option<()> {
        let idle = self.holders.iter().filter(|(_, holder)| {
            let is_busy = holder.is_answering || holder.is_sending;
            !is_busy && may_end(holder)
        });
        let (&number, _) =
            idle.max_by_key(|(_, holder)| (self.count(holder.peer), Reverse(holder.idle_since)))?;
        let holder = self.holders.remove(&number)?;
        holder.leave.notify_one();
        Some(())
    }
}

impl Place {
    /// Notes whether a request is answered, for good where the connection becomes another.
    pub(super) fn set_answering(&self, is_answering: bool) {
        self.set(|holder| &mut holder.is_answering, is_answering);
    }

    /// Notes whether bytes wait until the peer takes them.
    pub(super) fn set_sending(&self, is_sending: bool) {
        self.set(|holder| &mut holder.is_sending, is_sending);
    }

    fn set(&self, flag: impl FnOnce(&mut Holder) -> &mut bool, value: bool) {
        let mut taken = self.places.lock();
        let now = taken.tick();
        if let Some(holder) = taken.holders.get_mut(&self.number) {
            *flag(holder) = value;
            holder.idle_since = now;
        }
    }

    /// Notified when the connection has to end.
    pub(super) fn leave(&self) -> Arc<Notify> {
        Arc::clone(&self.leave)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.lock().holders.remove(&self.number);
    }
}

/// Returns the network that counts as one peer: an address, of IPv6 the network that one host usually has to itself.
fn peer(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => {
            let network = u128::from(address) >> 64 << 64;
            Ipv6Addr::from(network).into()
        }
        address @ IpAddr::V4(_) => address,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(192, 0, 2, 1));
    const B: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(192, 0, 2, 2));
    const C: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(192, 0, 2, 3));

    fn has(place: &Place) -> bool {
        place.places.lock().holders.contains_key(&place.number)
    }

    fn fill(places: &Arc<Places>, address: IpAddr, count: usize) -> Vec<Place> {
        let take = || places.take(address).unwrap();
        std::iter::repeat_with(take).take(count).collect()
    }

    #[test]
    fn an_address_makes_room_within_its_share() {
        let places = Arc::new(Places::default());
        let other = fill(&places, B, 1);
        let held = fill(&places, A, SHARE);
        held[0].set_answering(true);
        held[1].set_sending(true);
        // It was idle before the others, and is again since.
        held[2].set_answering(true);
        held[2].set_answering(false);
        let next = places.take(A).unwrap();
        assert!(has(&next) && has(&other[0]));
        let gone = held.iter().position(|place| !has(place));
        assert_eq!(gone, Some(3));
        assert_eq!(places.lock().count(A), SHARE);
    }

    #[test]
    fn the_address_with_most_makes_room() {
        let places = Arc::new(Places::default());
        let few = fill(&places, B, 2);
        let many = [
            fill(&places, A, SHARE),
            fill(&places, C, PLACES - SHARE - 2),
        ];
        assert!(places.take(B).is_some_and(|place| has(&place)));
        assert!(few.iter().all(has) && many[1].iter().all(has));
        assert!(!has(&many[0][0]) && many[0][1..].iter().all(has));
    }

    #[test]
    fn busy_connections_stay() {
        let places = Arc::new(Places::default());
        let held = fill(&places, A, SHARE);
        for place in &held {
            place.set_answering(true);
        }
        assert!(places.take(A).is_none());
        assert!(places.take(B).is_some());
        places.free_one();
        assert!(held.iter().all(has));
        drop(held);
        assert!(places.take(A).is_some());
    }

    #[tokio::test(flavor = "current_thread")]
    async fn a_connection_that_has_to_leave_is_notified() {
        let places = Arc::new(Places::default());
        let place = places.take(A).unwrap();
        places.free_one();
        assert!(!has(&place));
        place.leave().notified().await;
    }

    #[test]
    fn a_network_of_ipv6_is_one_peer() {
        let peers = ["2001:db8::1", "2001:db8::2:3", "2001:db8:0:1::1"];
        let [a, b, c] = peers.map(|address| peer(address.parse().unwrap()));
        assert!(a == b && a != c);
        assert_eq!(peer("::ffff:192.0.2.1".parse().unwrap()), A);
    }
}
