//! Pictures of the swimmer: each kind is what its name says, and those of the README are what the program draws today.

use std::fs;
use std::path::{Path, PathBuf};

use crate::binary::typed;

/// Commands of the pictures under `docs/pictures`. `SWIMMER_PICTURES=overwrite cargo test -p swimmer --test system pictures`
/// makes them again.
const OF_THE_README: [(&str, &str); 4] = [
    ("optimize displacement --swimmer purcell -o best.gait", ""),
    (
        "simulate --swimmer purcell --gait best.gait --cycles 8 --picture swimmer.png",
        "swimmer.png",
    ),
    (
        "height-map --swimmer purcell --gait best.gait -o height-map.png",
        "height-map.png",
    ),
    (
        "simulate --swimmer purcell --gait best.gait --picture cycle.gif",
        ANIMATION,
    ),
];
const ANIMATION: &str = "cycle.gif";

/// Commands of the pictures of other swimmers, in a folder with the files of that page.
const OF_OTHER_SWIMMERS: [(&str, &str); 8] = [
    (
        "optimize displacement --swimmer uneven.toml --max-angle 1.2 -o uneven.gait",
        "",
    ),
    (
        "height-map --swimmer uneven.toml --gait uneven.gait -o uneven.png",
        "uneven.png",
    ),
    (
        "optimize displacement --swimmer perfect-fluid --max-angle 1.5 -o perfect.gait",
        "",
    ),
    (
        "simulate --swimmer perfect-fluid --gait perfect.gait --cycles 2 --picture perfect-fluid.png",
        "perfect-fluid.png",
    ),
    (
        "simulate --swimmer kinematic-snake --gait off-centre.gait --cycles 3 --picture kinematic-snake.png",
        "kinematic-snake.png",
    ),
    (
        "optimize passive --swimmer elastic-tail --max-angle 1 -o tail.gait",
        "",
    ),
    (
        "simulate --swimmer purcell --gait tail.gait --cycles 6 --picture elastic-tail.png",
        "elastic-tail.png",
    ),
    (
        "height-map --swimmer purcell --gait tail.gait -o elastic-tail-map.png",
        "elastic-tail-map.png",
    ),
];

/// Size limit of an animation on a page that loads at once.
const LARGEST_ANIMATION: usize = 400_000;

#[test]
fn pictures_of_the_readme_are_what_is_drawn_today() {
    let folder = tempfile::tempdir().unwrap();
    drawn_today(folder.path(), &OF_THE_README);
}

#[test]
fn pictures_of_other_swimmers_are_what_is_drawn_today() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/how-to/other-swimmers.in");
    for name in ["uneven.toml", "off-centre.gait"] {
        fs::copy(inputs.join(name), folder.path().join(name)).unwrap();
    }
    drawn_today(folder.path(), &OF_OTHER_SWIMMERS);
}

/// Runs the commands in a folder, and compares each picture with that under `docs/pictures`.
fn drawn_today(folder: &Path, commands: &[(&str, &str)]) {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/pictures");
    let overwrite = std::env::var("SWIMMER_PICTURES").is_ok_and(|word| word == "overwrite");
    let mut stale = Vec::new();
    for &(line, picture) in commands {
        typed(folder, line).with_status(0);
        if picture.is_empty() {
            continue;
        }
        let drawn = fs::read(folder.join(picture)).unwrap();
        if picture == ANIMATION {
            assert!(drawn.len() < LARGEST_ANIMATION, "{} bytes", drawn.len());
        }
        let place: PathBuf = kept.join(picture);
        if overwrite {
            fs::write(&place, &drawn).unwrap();
        } else if fs::read(&place).ok().as_ref() != Some(&drawn) {
            stale.push(picture);
        }
    }
    assert!(
        stale.is_empty(),
        "docs/pictures: {stale:?} differ from what is drawn; look at them, then run this test with SWIMMER_PICTURES=overwrite"
    );
}

#[test]
fn each_kind_is_what_its_name_says() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let draw = |gait: &str, name: &str| {
        let line = format!("simulate --swimmer robot --gait {gait} --picture {name}");
        typed(folder.path(), &line)
    };
    draw("circle:70deg", "one.svg").with_status(0);
    let text = String::from_utf8(file("one.svg")).unwrap();
    // The chain of a body is a line with four points: nine bodies in a cycle; and the sphere, of the last one alone.
    let bodies = text
        .split("points=\"")
        .skip(1)
        .filter(|rest| rest.split('"').next().unwrap().split(' ').count() == 4);
    assert_eq!(bodies.count(), 9);
    assert!(text.contains("0.2 L = 69 mm"), "the scale");
    assert!(text.contains("X/L = 0.0162 a cycle") && text.contains("1 cycle<"));
    draw("circle:70deg --cycles 40", "forty.svg").with_status(0);
    let text = String::from_utf8(file("forty.svg")).unwrap();
    assert!(text.contains("40 cycles<"));

    draw("circle:70deg", "one.png").with_status(0);
    assert!(file("one.png").starts_with(b"\x89PNG\r\n\x1a\n"));
    let answer = draw("circle:70deg", "one.gif").with_status(0);
    assert!(
        answer
            .stdout
            .contains("one.gif: 640 × 330, 20 images a second"),
        "{}",
        answer.stdout
    );
    let gif = file("one.gif");
    assert!(gif.starts_with(b"GIF89a\x80\x02\x4a\x01"), "640 × 330");
    // An existing file is not replaced.
    let refused = draw("circle:70deg", "one.gif").with_status(2);
    assert!(refused.stderr.contains("--overwrite"), "{}", refused.stderr);
}

/// The same swimmer, the same bytes; the other way round, another picture.
#[test]
fn a_picture_is_drawn_the_same_twice() {
    let folder = tempfile::tempdir().unwrap();
    for (gait, name) in [
        ("square:1", "a.gif"),
        ("square:1", "b.gif"),
        ("square:1:cw", "c.gif"),
    ] {
        let line = format!("simulate --swimmer purcell --gait {gait} --picture {name}");
        typed(folder.path(), &line).with_status(0);
    }
    let [a, b, c] =
        ["a.gif", "b.gif", "c.gif"].map(|name| fs::read(folder.path().join(name)).unwrap());
    assert_eq!(a, b);
    assert_ne!(a, c);
}
