//! `cargo xtask lab`: builds the lab page as one HTML file and checks its size.

mod browse;

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::debian;
use crate::disk::{make_folder, read_bytes};
use crate::failure::{Failure, Outcome};
use crate::run::{command, read, run, target_folder, works};
use crate::toolchain::{Target, Toolchain};

pub(crate) use browse::{bench, test};

/// Sources of the page; npm installs the bundler and the test tools there.
const PAGE: &str = "lab/page";
/// Modules built from `lab/wasm`: the feature that selects it and the optimisation level of
/// `lab/wasm` itself. Generic code gets its caller's level, so the module that computes while a gait is dragged has a high one.
const MODULES: [(&str, &str); 2] = [("explore", "2"), ("robot", "'z'")];
/// Limits of the sizes in bytes.
const LARGEST_MODULE: usize = 2_000_000;
/// Loads within a second from a disk or a local network; words for symbols and hints took the page past 1.6 MB.
const LARGEST_PAGE: usize = 1_700_000;
/// Optimisation level of the standard library's sines and exponentials. Only this build compiles that crate.
const FAST: &str = "profile.lab.package.compiler_builtins.opt-level=3";
/// Features of WebAssembly that the compiler may have used, for `wasm-opt`.
const FEATURES: [&str; 7] = [
    "--enable-bulk-memory",
    "--enable-simd",
    "--enable-nontrapping-float-to-int",
    "--enable-sign-ext",
    "--enable-mutable-globals",
    "--enable-reference-types",
    "--enable-multivalue",
];

/// Builds modules and page. Returns the path of the page.
///
/// # Errors
/// Node, npm or the compiler is not available, a source has an error, or a file exceeds its limit.
pub(crate) fn build() -> Outcome<PathBuf> {
    install()?;
    let next = "fix what the type checker reports above";
    run(tool("tsc").arg("--noEmit"), next)?;
    let toolchain = Toolchain::find_or_make(Target::Page)?;
    println!("{}", toolchain.describe());
    let modules = MODULES
        .iter()
        .map(|(name, level)| module(&toolchain, name, level))
        .collect::<Outcome<Vec<_>>>()?;
    let packed = modules
        .iter()
        .map(|module| packed(module))
        .collect::<Outcome<Vec<_>>>()?;
    let page = target_folder()?.join("lab/swimmer-lab.html");
    let (version, hash) = (env!("CARGO_PKG_VERSION"), commit());
    run(
        command("node")
            .arg("build.mjs")
            .arg(&page)
            .args([version, &hash])
            .args(&packed)
            .current_dir(PAGE),
        "fix what the bundler reports above",
    )?;
    for ((name, _), module) in MODULES.iter().zip(&modules) {
        weigh(&format!("module {name}"), module, LARGEST_MODULE)?;
    }
    weigh("page", &page, LARGEST_PAGE)?;
    println!("{}", page.display());
    Ok(page)
}

/// Installs the packages of `package-lock.json` if it changed since the last installation.
///
/// # Errors
/// Node or npm is not available, or a package cannot be fetched.
pub(crate) fn install() -> Outcome {
    debian::ensure_tool(command("node").arg("--version"), &["nodejs"])?;
    let (wanted, installed) = ("package-lock.json", "node_modules/.installed-lock.json");
    let lock = read_bytes(&Path::new(PAGE).join(wanted))?;
    if std::fs::read(Path::new(PAGE).join(installed)).is_ok_and(|there| there == lock) {
        return Ok(());
    }
    debian::ensure_tool(command("npm").arg("--version"), &["npm"])?;
    run(
        command("npm")
            .args(["ci", "--no-audit", "--no-fund"])
            .current_dir(PAGE),
        "check the network and npm's registry, and repeat the command",
    )?;
    crate::disk::write(&Path::new(PAGE).join(installed), lock)
}

/// Program installed by npm, to be run in the page's folder.
fn tool(name: &str) -> Command {
    let mut tool = command("node");
    tool.arg(format!("node_modules/.bin/{name}"))
        .current_dir(PAGE);
    tool
}

/// Compiles a module and reduces its size.
fn module(toolchain: &Toolchain, name: &str, level: &str) -> Outcome<PathBuf> {
    run(
        toolchain.cargo("build").args([
            "-p",
            "swimmer-lab",
            "--no-default-features",
            "--features",
            name,
            "--config",
            &format!("profile.lab.package.swimmer-lab.opt-level={level}"),
            "--config",
            FAST,
        ]),
        "fix what the compiler reports above",
    )?;
    let target = target_folder()?;
    let built = target
        .join(Target::Page.triple())
        .join("lab/swimmer_lab.wasm");
    let folder = target.join("lab");
    make_folder(&folder)?;
    let small = folder.join(format!("{name}.wasm"));
    // Cargo writes both modules to one path, and updates the file only if it compiled or copied it.
    let kept = folder.join(format!("{name}.built"));
    let bytes = read_bytes(&built)?;
    if small.is_file() && std::fs::read(&kept).is_ok_and(|before| before == bytes) {
        return Ok(small);
    }
    run(
        tool("wasm-opt")
            .args(FEATURES)
            // The second pass optimises the merged functions. Functions that are called often get short indices.
            .args([
                "--strip-debug",
                "-Oz",
                "--merge-similar-functions",
                "-Oz",
                "--reorder-functions",
                "-o",
            ])
            .args([&small, &built]),
        "fix what wasm-opt reports above",
    )?;
    crate::disk::write(&kept, bytes)?;
    Ok(small)
}

/// Compresses a module for the page: gzip, which every browser can unpack, by Zopfli, which packs it about 4 % smaller than zlib.
fn packed(module: &Path) -> Outcome<PathBuf> {
    let small = module.with_extension("wasm.gz");
    let modified = |path: &Path| std::fs::metadata(path).and_then(|data| data.modified());
    if let (Ok(built), Ok(packed)) = (modified(module), modified(&small))
        && built < packed
    {
        return Ok(small);
    }
    let mut bytes = Vec::new();
    zopfli::compress(
        zopfli::Options::default(),
        zopfli::Format::Gzip,
        read_bytes(module)?.as_slice(),
        &mut bytes,
    )
    .map_err(|error| {
        Failure::new(
            format!("compressing {}", module.display()),
            error.to_string(),
            "check free memory and disk, and repeat the command",
        )
    })?;
    crate::disk::write(&small, bytes)?;
    Ok(small)
}

/// Current commit, marked if the checkout has changes; `unknown` outside a repository.
fn commit() -> String {
    let next = "";
    let Ok(hash) = read(
        command("git").args(["rev-parse", "--short=12", "HEAD"]),
        next,
    ) else {
        return "unknown".to_owned();
    };
    let clean = works(command("git").args(["diff", "--quiet", "HEAD"]));
    format!("{}{}", hash.trim(), if clean { "" } else { "+" })
}

fn weigh(name: &str, path: &Path, most: usize) -> Outcome {
    let size = read_bytes(path)?.len();
    println!("{name}: {size} bytes of {most} promised");
    if size <= most {
        return Ok(());
    }
    Err(Failure::new(
        format!("weighing {}", path.display()),
        format!("{size} bytes, and {most} are promised"),
        "reduce the size, or raise the limit with a reason in ARCHITECTURE.md",
    ))
}
