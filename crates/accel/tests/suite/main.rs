//! What the crate promises, seen from outside.

mod answers;
mod bits;
mod degenerate;
mod oracle;
mod quadrics;
mod scenes;
mod watertight;
