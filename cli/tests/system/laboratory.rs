//! A folder to work in: what commands read, as it should be and as it should not.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::binary::typed;

/// A folder with `good.gait`, `good.toml`, `good.key`, `page.html`, `good.mcap`, `image.uf2`, `run.csv`, `wide.csv`, `campaign.toml`, `spec.toml` with its finished sweep `swept`, and a boot loader's `drive`, and a `wrong.*`
/// for each kind.
pub(crate) fn laboratory() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    for ending in ["toml", "gait", "csv", "uf2", "mcap", "key", "html"] {
        write(&format!("wrong.{ending}"), "this is\nsomething else\n");
    }
    write(
        "good.toml",
        "[links]\nmiddle = 0.071\nside = 0.137\n[drag]\nchi = 3.598\nc_t = { log_aspect = 4.543 }\n",
    );
    let mut circle = String::new();
    for at in 0..=64 {
        let (sin, cos) = (f64::from(at % 64) * std::f64::consts::TAU / 64.0).sin_cos();
        writeln!(circle, "{:?},{cos:?},{sin:?}", f64::from(at) / 64.0).unwrap();
    }
    write(
        "good.gait",
        &format!("# swimmer gait file, version 1\nu,phi1,phi2\n{circle}"),
    );
    write(
        "page.html",
        "<meta name=\"swimmer-lab\" content=\"0.1.0 0123456\">\n",
    );
    write("good.key", "000102030405060708090a0b0c0d0e0f\n");
    for (name, track) in ["run.csv", "wide.csv"].iter().zip(tracks()) {
        write(name, track);
    }
    write(
        "campaign.toml",
        "swimmer = \"good.toml\"\n[reflectors]\nfront = { point = \"Front\", at = [0.0355, 0.0] }\nback = { point = \"Back\", at = [-0.0355, 0.0] }\n[[run]]\ntrack = \"wide.csv\"\ngait = \"circle:90deg\"\nperiod_s = 30.0\n[[run]]\ntrack = \"run.csv\"\ngait = \"circle:50deg\"\nperiod_s = 30.0\n",
    );
    write(
        "spec.toml",
        "swimmer = \"good.toml\"\nobjective = \"stub\"\n[[axis]]\nname = \"drag.chi\"\nvalues = [2, 3, 4]\n[[axis]]\nname = \"sphere.radius\"\nvalues = [0, 0.1]\n",
    );
    for words in ["sweep plan spec.toml -o swept", "sweep run swept"] {
        typed(folder.path(), words).with_status(0);
    }
    std::fs::write(folder.path().join("image.uf2"), uf2()).unwrap();
    std::fs::create_dir(folder.path().join("drive")).unwrap();
    write(
        "drive/INFO_UF2.TXT",
        "UF2 Bootloader v3.0\nModel: Raspberry Pi RP2\nBoard-ID: RPI-RP2\n",
    );
    std::fs::copy(recorded(), folder.path().join("good.mcap")).unwrap();
    folder
}

/// Two reflectors on the middle link through three cycles of a circle, small and wide.
fn tracks() -> &'static [String; 2] {
    static TRACKS: OnceLock<[String; 2]> = OnceLock::new();
    TRACKS.get_or_init(|| ["50deg", "90deg"].map(track))
}

fn track(amplitude: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let line =
        format!("simulate --swimmer robot --gait circle:{amplitude} --cycles 3 --trajectory t.csv");
    typed(folder.path(), &line).with_status(0);
    let text = std::fs::read_to_string(folder.path().join("t.csv")).unwrap();
    let mut track = "t,Front x,Front y,Back x,Back y\n".to_owned();
    for line in text.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [cycle, u, _, _, x, y, theta] = cells[..] else {
            panic!("{line}");
        };
        let (dy, dx) = (0.0355 * theta.sin(), 0.0355 * theta.cos());
        let t = 30.0 * (cycle + u);
        writeln!(
            track,
            "{t:?},{:?},{:?},{:?},{:?}",
            x + dx,
            y + dy,
            x - dx,
            y - dy
        )
        .unwrap();
    }
    track
}

/// The log of a cycle.
fn recorded() -> &'static Path {
    static LOG: OnceLock<(tempfile::TempDir, PathBuf)> = OnceLock::new();
    &LOG.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let line = "robot play --gait circle:1 --cycles 1 --port twin --log l.mcap";
        typed(folder.path(), line).with_status(0);
        let log = folder.path().join("l.mcap");
        (folder, log)
    })
    .1
}

/// A block of the RP2040's kind with nothing in it.
fn uf2() -> Vec<u8> {
    let mut block = vec![0; 512];
    let words: [u32; 8] = [
        0x0a32_4655,
        0x9e5d_5157,
        0x2000,
        0x1000_0000,
        256,
        0,
        1,
        0xe48b_ff56,
    ];
    for (place, word) in words.iter().enumerate() {
        block[4 * place..4 * place + 4].copy_from_slice(&word.to_le_bytes());
    }
    block[508..].copy_from_slice(&0x0ab1_6f30_u32.to_le_bytes());
    block
}
