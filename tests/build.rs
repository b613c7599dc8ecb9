//! Sets `cfg(shared)` if the real recordings lie next to the clone. Without them, the tests that need them are ignored.

use std::path::Path;

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/optitrack");
    println!("cargo::rustc-check-cfg=cfg(shared)");
    // A folder that is missing is looked for in every build, so that it is noticed once it is there; only this small package is
    // built again for it.
    println!("cargo::rerun-if-changed={}", folder.display());
    if folder.is_dir() {
        println!("cargo::rustc-cfg=shared");
    }
}
