//! Builders and helpers that several test modules use.

use surefoot::rig::{Rig, load_bytes, mannequin::BUILTIN};

/// The rig inside of the program.
pub fn builtin() -> Rig {
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    load_bytes("builtin", BUILTIN, &alone, None).expect("the built-in rig loads")
}
