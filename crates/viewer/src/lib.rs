//! A running render, shown to those who watch: who renders gives a [`Frame`] now and then, and never
//! waits for anybody who looks at it.

mod frame;

pub use frame::Frame;
