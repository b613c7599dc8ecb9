//! The reader answers anything with tracks or an error, never with a panic.

use std::path::Path;

use calibrate::read_tracks;
use proptest::prelude::*;

const SEEDS: [&str; 4] = [
    "Format Version,1.24,Take Name,a,Export Frame Rate,100,Length Units,Meters,Coordinate Space,Global\n\n,Type,,Marker,Marker,Marker\n,Name,,\"F\",F,F\n,ID,,\"1\",1,1\n,,,Position,Position,Position\nFrame,Time (Seconds),TimeCode,X,Y,Z\n0,0.00,1:2,1,2,3\n1,0.01,1:2,,,\n",
    "t;x1;y1;x2;y2\n0;1,5;2;3;4\n0,01;1;;NaN;4\n",
    "# t x1 y1\n0 1 2\n0.1 2 3\n",
    "cm_A\nt\tx\ty\n0\t1\t2\n",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn arbitrary_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read_tracks(&bytes, Path::new("f"));
    }

    #[test]
    fn arbitrary_text(text in "(Format Version,|t,x1,y1\n|frame,|,|\"|;|\n|\r\n|[0-9.eE+-]{1,5}|X|Y|Z|Position|Type|é|\\PC){0,60}") {
        let _ = read_tracks(text.as_bytes(), Path::new("f"));
    }

    #[test]
    fn spoilt_samples(which in 0..SEEDS.len(), edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3u8), 1..6)) {
        let mut bytes = SEEDS[which].as_bytes().to_vec();
        for (index, byte, kind) in edits {
            if bytes.is_empty() {
                break;
            }
            let at = index.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, byte),
            }
        }
        if let Ok(file) = read_tracks(&bytes, Path::new("f")) {
            prop_assert!(file.times.iter().all(|time| time.is_finite()));
            for point in &file.points {
                prop_assert!((0..file.frames()).filter_map(|row| point.position(row)).all(|p| p.iter().all(|v| v.is_finite())));
            }
        }
    }
}
