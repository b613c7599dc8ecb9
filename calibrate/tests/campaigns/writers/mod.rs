//! Writers of tracking files: one motion in the format of each program. They share no code with the readers.
// Each test uses a part.

use std::fmt::Write;

pub(crate) const ROWS: usize = 60;
pub(crate) const RATE_HZ: f64 = 50.0;
/// Half the distance of the reflectors \[m\].
pub(crate) const HALF: f64 = 0.0355;

/// Centre of the middle link \[m\] and its heading.
pub(crate) fn truth(row: usize) -> [f64; 3] {
    let t = row as f64 / RATE_HZ;
    [
        0.4 + 0.05 * t,
        0.3 - 0.02 * t + 0.01 * (5.0 * t).sin(),
        0.3 + 0.4 * (4.0 * t).sin(),
    ]
}

/// A place on the link, in the tank.
fn on_link(row: usize, at: [f64; 2]) -> [f64; 2] {
    let [x, y, theta] = truth(row);
    let (s, c) = theta.sin_cos();
    [x + c * at[0] - s * at[1], y + s * at[0] + c * at[1]]
}

fn front(row: usize) -> [f64; 2] {
    on_link(row, [HALF, 0.0])
}

fn back(row: usize) -> [f64; 2] {
    on_link(row, [-HALF, 0.0])
}

/// Description of the middle link in a campaign.
pub(crate) enum Link {
    Pair(&'static str, &'static str),
    Body(&'static str),
    /// Place of the pivot, and direction of the front link from the body's axis.
    Offset(&'static str, [f64; 2], f64),
}

pub(crate) struct WrittenFile {
    pub(crate) name: &'static str,
    pub(crate) text: String,
    pub(crate) format: &'static str,
    pub(crate) points: Vec<&'static str>,
    pub(crate) link: Link,
    /// Rate and scale that the user states.
    pub(crate) rate_hz: Option<f64>,
    pub(crate) scale: Option<f64>,
    /// Rate of the file, if it differs from [`RATE_HZ`].
    pub(crate) own_rate_hz: Option<f64>,
    /// Origin of the file's coordinates in the tank [m].
    pub(crate) origin: [f64; 2],
}

impl WrittenFile {
    fn new(
        name: &'static str,
        format: &'static str,
        points: &[&'static str],
        link: Link,
        text: String,
    ) -> Self {
        Self {
            name,
            text,
            format,
            points: points.to_vec(),
            link,
            rate_hz: None,
            scale: None,
            own_rate_hz: None,
            origin: [0.0; 2],
        }
    }

    fn rated(mut self) -> Self {
        self.rate_hz = Some(RATE_HZ);
        self
    }

    fn scaled(mut self, scale: f64) -> Self {
        self.scale = Some(scale);
        self
    }
}

/// Table of a header and [`ROWS`] lines, each made from its number.
fn rows(head: &str, row: impl Fn(usize) -> String) -> String {
    let mut text = head.to_owned();
    for i in 0..ROWS {
        writeln!(text, "{}", row(i)).unwrap();
    }
    text
}

fn t(row: usize) -> f64 {
    row as f64 / RATE_HZ
}

/// Cells of front and back, two each, with this delimiter.
fn pair(row: usize, cut: &str) -> String {
    let ([a, b], [c, d]) = (front(row), back(row));
    format!("{a:.6}{cut}{b:.6}{cut}{c:.6}{cut}{d:.6}")
}

#[allow(clippy::too_many_lines)] // a table
pub(crate) fn written_files() -> Vec<WrittenFile> {
    let ends = || Link::Pair("front", "back");
    let trc = |line: &str, rate: f64| {
        let head = format!(
            "{line}\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n\
             {rate}\t{rate}\t{ROWS}\t2\tmm\t{rate}\t1\t{ROWS}\nFrame#\tTime\tfront\t\t\tback\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n"
        );
        // Y up: the tank's x is Z, its y is X.
        rows(&head, |i| {
            let ([a, b], [c, d]) = (front(i), back(i));
            format!(
                "{}\t{:.5}\t{:.4}\t50.0\t{:.4}\t{:.4}\t50.0\t{:.4}",
                i + 1,
                t(i),
                1e3 * b,
                1e3 * a,
                1e3 * d,
                1e3 * c
            )
        })
    };
    vec![
        WrittenFile::new(
            "TRC, spaces in line 1",
            "trc",
            &["front", "back"],
            ends(),
            trc("PathFileType  4  (X/Y/Z)  my, file; 2.trc", 50.0),
        ),
        WrittenFile::new(
            "TRC, header of another rate",
            "trc",
            &["front", "back"],
            ends(),
            trc("PathFileType\t4\t(X/Y/Z)\ta.trc", 25.0),
        ),
        WrittenFile::new(
            "kineticstoolkit",
            "table",
            &["front", "back"],
            ends(),
            rows(
                ",front[0],front[1],front[2],front[3],back[0],back[1],back[2],back[3]\n",
                |i| {
                    let ([a, b], [c, d]) = (front(i), back(i));
                    format!(
                        "{:.3},{a:.6},{b:.6},0.05,1.0,{c:.6},{d:.6},0.05,1.0",
                        10.01 + t(i)
                    )
                },
            ),
        ),
        WrittenFile::new(
            "an index without a name, and times",
            "table",
            &["front", "back"],
            ends(),
            rows(",time,front_x,front_y,back_x,back_y\n", |i| {
                format!("{i},{:.3},{}", t(i), pair(i, ","))
            }),
        ),
        WrittenFile::new(
            "an index without a name, and no times",
            "table",
            &["front", "back"],
            ends(),
            rows(",front_x,front_y,back_x,back_y\n", |i| {
                format!("{i},{}", pair(i, ","))
            }),
        )
        .rated(),
        WrittenFile::new(
            "fx, fy",
            "table",
            &["f", "b"],
            Link::Pair("f", "b"),
            rows("t,fx,fy,bx,by\n", |i| {
                format!("{:.3},{}", t(i), pair(i, ","))
            }),
        ),
        WrittenFile::new(
            "a clock's times",
            "table",
            &["front", "back"],
            ends(),
            rows("time;front_x;front_y;back_x;back_y\n", |i| {
                let hundredths = (11 * 3600 + 59 * 60 + 59) * 100 + 15 + 2 * i;
                let seconds = hundredths / 100;
                let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
                format!(
                    "{hours}:{minutes:02}:{:02}.{:02};{}",
                    seconds % 60,
                    hundredths % 100,
                    pair(i, ";")
                )
            }),
        ),
        WrittenFile::new(
            "ISO times",
            "table",
            &["front", "back"],
            ends(),
            rows("timestamp,front_x,front_y,back_x,back_y\n", |i| {
                // Over midnight.
                let ms = 20 * i + 59_500;
                let day = if ms < 60_000 {
                    "2026-08-31T23:59"
                } else {
                    "2026-09-01T00:00"
                };
                format!(
                    "{day}:{:02}.{:03}Z,{}",
                    ms / 1000 % 60,
                    ms % 1000,
                    pair(i, ",")
                )
            }),
        ),
        WrittenFile::new(
            "milliseconds since 1970",
            "table",
            &["front", "back"],
            ends(),
            rows("timestamp,front_x,front_y,back_x,back_y\n", |i| {
                format!("{},{}", 1_785_858_822_776_u64 + 20 * i as u64, pair(i, ","))
            }),
        ),
        WrittenFile::new(
            "t x y θ",
            "table",
            &["pose"],
            Link::Body("pose"),
            rows("", |i| {
                let [x, y, theta] = truth(i);
                format!("{:.3} {x:.6} {y:.6} {theta:.6}", t(i))
            }),
        )
        .scaled(1.0),
        WrittenFile::new(
            "t,x,y,z,quaternion",
            "table",
            &["pose"],
            Link::Body("pose"),
            rows("", |i| {
                let [x, y, theta] = truth(i);
                format!(
                    "{:.3},{x:.6},{y:.6},0.05,0.0,0.0,{:.6},{:.6}",
                    t(i) + 0.5,
                    (theta / 2.0).sin(),
                    (theta / 2.0).cos()
                )
            }),
        )
        .scaled(1.0),
        WrittenFile::new(
            "x,y,yaw in degrees",
            "table",
            &["x,y"],
            Link::Body("x,y"),
            rows("t,x_mm,y_mm,yaw_deg\n", |i| {
                let [x, y, theta] = truth(i);
                format!(
                    "{:.3},{:.3},{:.3},{:.4}",
                    t(i),
                    1e3 * x,
                    1e3 * y,
                    theta.to_degrees()
                )
            }),
        ),
        WrittenFile::new(
            "x,y,theta",
            "table",
            &["robot"],
            Link::Body("robot"),
            rows("t,robot_x,robot_y,robot_theta\n", |i| {
                let [x, y, theta] = truth(i);
                format!("{:.3},{x:.6},{y:.6},{theta:.6}", t(i))
            }),
        ),
        WrittenFile::new(
            "x,y,yaw of a pivot off the centre, turned by 30°",
            "table",
            &["x,y"],
            Link::Offset("x,y", [0.012, -0.007], 30_f64.to_radians()),
            rows("t,x,y,yaw_rad\n", |i| {
                let [x, y] = on_link(i, [0.012, -0.007]);
                format!(
                    "{:.3},{x:.6},{y:.6},{:.6}",
                    t(i),
                    truth(i)[2] - 30_f64.to_radians()
                )
            }),
        ),
        WrittenFile::new(
            "rostopic echo -p",
            "table",
            &["field.pose"],
            Link::Body("field.pose"),
            rows(
                "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.pose.position.x,field.pose.position.y,\
                 field.pose.position.z,field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w\n",
                |i| {
                    let [x, y, theta] = truth(i);
                    let stamp = 1_609_060_336_768_428_032_u64 + 20_000_000 * i as u64;
                    // Received late, and unevenly.
                    let received = stamp + 3_000_000 + 1_700_000 * (i as u64 % 3);
                    format!(
                        "{received},{i},{stamp},world,{x:.8},{y:.8},0.05,0.0,0.0,{:.9},{:.9}",
                        (theta / 2.0).sin(),
                        (theta / 2.0).cos()
                    )
                },
            ),
        ),
        WrittenFile::new(
            "ArUco, two markers",
            "long-table",
            &["3", "17"],
            Link::Pair("17", "3"),
            {
                let mut text = "t,id,x,y\n".to_owned();
                for i in 0..ROWS {
                    let ([a, b], [c, d]) = (front(i), back(i));
                    writeln!(
                        text,
                        "{:.3},17,{a:.6},{b:.6}\n{:.3},3,{c:.6},{d:.6}",
                        t(i),
                        t(i)
                    )
                    .unwrap();
                }
                text
            },
        ),
        WrittenFile::new(
            "ArUco, one marker with its angle",
            "long-table",
            &["3"],
            Link::Body("3"),
            rows("t,id,x,y,yaw\n", |i| {
                let [x, y, theta] = truth(i);
                format!("{:.3},3,{x:.6},{y:.6},{theta:.6}", t(i))
            }),
        ),
        WrittenFile {
            // Pixels of half a millimetre, y down from 0.9 m.
            origin: [0.0, -0.9],
            ..WrittenFile::new(
                "trackpy, by particle",
                "long-table",
                &["0", "1"],
                Link::Pair("0", "1"),
                {
                    let mut text =
                        ",y,x,mass,size,ecc,signal,raw_mass,ep,frame,particle\n".to_owned();
                    let of: [fn(usize) -> [f64; 2]; 2] = [front, back];
                    let mut line = 0;
                    for (particle, place) in of.iter().enumerate() {
                        for i in 0..ROWS {
                            let [x, y] = place(i);
                            writeln!(
                                text,
                                "{line},{:.4},{:.4},120.5,2.1,0.1,9.0,300.0,0.02,{i},{particle}",
                                (0.9 - y) / 5e-4,
                                x / 5e-4
                            )
                            .unwrap();
                            line += 1;
                        }
                    }
                    text
                },
            )
            .rated()
            .scaled(5e-4)
        },
        WrittenFile {
            origin: [0.0, -0.9],
            ..WrittenFile::new(
                "TrackMate, spots",
                "trackmate",
                &["0", "2"],
                Link::Pair("2", "0"),
                {
                    let mut text = "LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_Z,POSITION_T,FRAME,RADIUS\n\
                                Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,Radius\n\
                                Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,R\n\
                                ,,,(quality),(mm),(mm),(mm),(sec),,(mm)\n"
                    .to_owned();
                    let of: [fn(usize) -> [f64; 2]; 2] = [back, front];
                    for i in (0..ROWS).rev() {
                        for (index, place) in of.iter().enumerate() {
                            let [x, y] = place(i);
                            let id = 2 * i + index;
                            writeln!(
                                text,
                                "ID{id},{id},{},1.5,{:.4},{:.4},0,{:.3},{i},2.5",
                                2 * index,
                                1e3 * x,
                                1e3 * (0.9 - y),
                                t(i)
                            )
                            .unwrap();
                        }
                    }
                    // A spot of no track.
                    text + "ID999,999,,1.5,1,1,0,0.02,1,2.5\n"
                },
            )
        },
        WrittenFile {
            origin: [0.0, -0.9],
            ..WrittenFile::new(
                "TrackMate, exported tracks",
                "trackmate",
                &["0", "1"],
                Link::Pair("0", "1"),
                {
                    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Tracks nTracks=\"2\" spaceUnits=\"mm\" frameInterval=\"0.02\" timeUnits=\"sec\">\n".to_owned();
                    let of: [fn(usize) -> [f64; 2]; 2] = [front, back];
                    for place in of {
                        writeln!(text, "  <particle nSpots=\"{ROWS}\">").unwrap();
                        for i in 0..ROWS {
                            let [x, y] = place(i);
                            writeln!(
                                text,
                                "    <detection t=\"{i}\" x=\"{:.4}\" y=\"{:.4}\" z=\"0.0\" />",
                                1e3 * x,
                                1e3 * (0.9 - y)
                            )
                            .unwrap();
                        }
                        text += "  </particle>\n";
                    }
                    text + "</Tracks>\n"
                },
            )
        },
        WrittenFile {
            origin: [0.0, -0.9],
            ..WrittenFile::new(
                "TrackMate, its own file",
                "trackmate",
                &["Track_0", "Track_1"],
                Link::Pair("Track_1", "Track_0"),
                trackmate_file(),
            )
        },
        WrittenFile::new("Kinovea, KVA", "kinovea", &["front", "back"], ends(), kva()),
        WrittenFile::new(
            "Motive, quaternion",
            "motive-1.23",
            &["robot"],
            Link::Body("robot"),
            motive("Quaternion"),
        ),
        WrittenFile::new(
            "Motive, Euler angles",
            "motive-1.23",
            &["robot"],
            Link::Body("robot"),
            motive("XYZ"),
        ),
        WrittenFile::new(
            "Tracking Tools, bodies numbered otherwise",
            "trackingtools-1.0",
            &[
                "robot",
                "robot:Marker1",
                "robot:Marker2",
                "robot:Marker1",
                "robot:Marker2",
                "tool",
                "tool:Marker1",
                "tool:Marker2",
                "tool:Marker1",
                "tool:Marker2",
            ],
            Link::Body("robot"),
            tracking_tools(),
        ),
        WrittenFile::new(
            "QTM 6D",
            "qtm",
            &["tool", "robot"],
            Link::Body("robot"),
            qtm(),
        ),
        WrittenFile::new(
            "Vicon objects",
            "vicon",
            &["robot"],
            Link::Body("robot"),
            rows(
                "Objects\n50\n,,robot,,,,,\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ\n,,deg,deg,deg,mm,mm,mm\n",
                |i| {
                    let [x, y, theta] = truth(i);
                    format!(
                        "{},0,0.0,0.0,{:.4},{:.4},{:.4},50.0",
                        i + 1,
                        theta.to_degrees(),
                        1e3 * x,
                        1e3 * y
                    )
                },
            ),
        ),
    ]
}

/// Y up: x is Z, y is X, and the heading turns about Y.
fn motive(rotation: &str) -> String {
    let quaternion = rotation == "Quaternion";
    let turns = if quaternion { 4 } else { 3 };
    let repeat = |text: &str, times: usize| vec![text; times].join(",");
    let mut head = format!(
        "Format Version,1.23,Take Name,a,Capture Frame Rate,50.000000,Export Frame Rate,50.000000,Total Exported Frames,{ROWS},Rotation Type,{rotation},\
         Length Units,Meters,Coordinate Space,Global\n\n"
    );
    writeln!(head, ",Type,{}", repeat("Rigid Body", turns + 4)).unwrap();
    writeln!(head, ",Name,{}", repeat("\"robot\"", turns + 4)).unwrap();
    writeln!(head, ",ID,{}", repeat("\"38A5CB7D\"", turns + 4)).unwrap();
    writeln!(
        head,
        ",,{},Position,Position,Position,Mean Marker Error",
        repeat("Rotation", turns)
    )
    .unwrap();
    writeln!(
        head,
        "Frame,Time (Seconds),{},X,Y,Z,",
        if quaternion { "X,Y,Z,W" } else { "X,Y,Z" }
    )
    .unwrap();
    rows(&head, |i| {
        let [x, y, theta] = truth(i);
        let turn = if quaternion {
            format!(
                "0.000000,{:.6},0.000000,{:.6}",
                (theta / 2.0).sin(),
                (theta / 2.0).cos()
            )
        } else {
            format!("0.000000,{:.6},0.000000", theta.to_degrees())
        };
        format!("{i},{:.6},{turn},{y:.6},0.050000,{x:.6},0.000100", t(i))
    })
}

/// Two bodies whose numbers are exchanged in the frames, and a third pose that belongs to no body.
fn tracking_tools() -> String {
    let mut text = format!(
        "comment,\"NaturalPoint Trackable Export Data\"\nrighthanded\ninfo,framecount,{ROWS}\ninfo,trackablecount,2\n\
         trackable,\"robot\",1,2,0.0,0.0,0.0355,0.0,0.0,-0.0355\ntrackable,\"tool\",2,2,0.0,0.0,0.05,0.0,0.0,-0.02\n"
    );
    for i in 0..ROWS {
        let [x, y, theta] = truth(i);
        let (s, c) = (theta / 2.0).sin_cos();
        writeln!(
            text,
            "frame,{i},{:.8},3,2,{y:.8},0.05,{x:.8},0.0,{s:.8},0.0,{c:.8},0.0,0.0,0.0,1,2.0,0.05,1.5,0.0,0.0,0.0,1.0,0.0,0.0,0.0,\
             7,5.0,0.05,5.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0",
            t(i)
        )
        .unwrap();
        let ([a, b], [d, e]) = (front(i), back(i));
        writeln!(
            text,
            "trackable,{i},{:.8},\"robot\",1,0,2,{b:.8},0.05,{a:.8},{e:.8},0.05,{d:.8},{b:.8},0.05,{a:.8},{e:.8},0.05,{d:.8},1,1,0.5,0.5,0.0002",
            t(i)
        )
        .unwrap();
        writeln!(
            text,
            "trackable,{i},{:.8},\"tool\",2,0,2,2.0,0.05,1.55,2.0,0.05,1.48,2.0,0.05,1.55,2.0,0.05,1.48,1,1,0.5,0.5,0.0002",
            t(i)
        )
        .unwrap();
    }
    text
}

/// Rot[0], Rot[1], Rot[2] are the first column; a lost body is all zeros.
fn qtm() -> String {
    let of = |name: &str| {
        let rot: Vec<String> = (0..9).map(|i| format!("Rot[{i}]")).collect();
        format!(
            "{name} X\tY\tZ\tRoll\tPitch\tYaw\tResidual\t{}",
            rot.join("\t")
        )
    };
    let head = format!(
        "NO_OF_FRAMES\t{ROWS}\nNO_OF_CAMERAS\t4\nNO_OF_BODIES\t2\nFREQUENCY\t50\nNO_OF_ANALOG\t0\nANALOG_FREQUENCY\t0\nDESCRIPTION\t--\n\
         TIME_STAMP\t2020-01-22, 17:47:17\t22107.99179716\nDATA_INCLUDED\t6D\nBODY_NAMES\ttool\trobot\nFrame\tTime\t{}\t{}\n",
        of("tool"),
        of("robot")
    );
    rows(&head, |i| {
        let [x, y, theta] = truth(i);
        let (s, c) = theta.sin_cos();
        let lost = vec!["0.00000"; 16].join("\t");
        format!(
            "{}\t{:.5}\t{lost}\t{:.5}\t{:.5}\t50.00000\t0.00000\t0.00000\t{:.5}\t0.50000\t{c:.6}\t{s:.6}\t0.000000\t{:.6}\t{c:.6}\t0.000000\t0.000000\t0.000000\t1.000000",
            i + 1,
            t(i),
            1e3 * x,
            1e3 * y,
            theta.to_degrees(),
            -s
        )
    })
}

fn trackmate_file() -> String {
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<TrackMate version=\"7.11.1\">\n  <Model spatialunits=\"mm\" timeunits=\"sec\">\n    <AllSpots>\n".to_owned();
    for i in 0..ROWS {
        writeln!(text, "      <SpotsInFrame frame=\"{i}\">").unwrap();
        for (index, place) in [back(i), front(i)].iter().enumerate() {
            writeln!(
                text,
                "        <Spot ID=\"{}\" POSITION_X=\"{:.4}\" POSITION_Y=\"{:.4}\" POSITION_Z=\"0.0\" POSITION_T=\"{:.3}\" FRAME=\"{i}\" />",
                2 * i + index,
                1e3 * place[0],
                1e3 * (0.9 - place[1]),
                t(i)
            )
            .unwrap();
        }
        text += "      </SpotsInFrame>\n";
    }
    text += "    </AllSpots>\n    <AllTracks>\n";
    for index in 0..2 {
        writeln!(
            text,
            "      <Track name=\"Track_{index}\" TRACK_ID=\"{index}\">"
        )
        .unwrap();
        for i in (1..ROWS).rev() {
            let (from, to) = (2 * (i - 1) + index, 2 * i + index);
            writeln!(
                text,
                "        <Edge SPOT_SOURCE_ID=\"{from}\" SPOT_TARGET_ID=\"{to}\" />"
            )
            .unwrap();
        }
        text += "      </Track>\n";
    }
    text + "    </AllTracks>\n  </Model>\n  <Settings>\n    <ImageData filename=\"a.tif\" timeinterval=\"0.02\" />\n  </Settings>\n</TrackMate>\n"
}

/// Time stamps of the video, 512 a frame; the shown times are rounded to hundredths.
fn kva() -> String {
    let mut text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<KinoveaVideoAnalysis>\n  <FormatVersion>2.0</FormatVersion>\n\
                    \u{20} <AverageTimeStampsPerFrame>512</AverageTimeStampsPerFrame>\n  <CaptureFramerate>50</CaptureFramerate>\n  <Tracks>\n"
        .to_owned();
    for (name, along) in [("front", HALF), ("back", -HALF)] {
        writeln!(text, "    <Track id=\"{name}-id\" name=\"{name}\">\n      <TrackPointList Count=\"{ROWS}\" UserUnitLength=\"mm\">").unwrap();
        for i in 0..ROWS {
            let [x, y] = on_link(i, [along, 0.0]).map(|value| 1e3 * value);
            let comma = format!("{x:.2}").replace('.', ",");
            writeln!(
                text,
                "        <TrackPoint UserX=\"{comma}\" UserXInvariant=\"{x:.3}\" UserY=\"{y:.3}\" UserYInvariant=\"{y:.3}\" UserTime=\"0:00:{:02}:{:02}\">{:.0};{:.0};{}</TrackPoint>",
                2 * i / 100,
                2 * i % 100,
                x,
                -y,
                512 * i
            )
            .unwrap();
        }
        text += "      </TrackPointList>\n    </Track>\n";
    }
    text + "  </Tracks>\n</KinoveaVideoAnalysis>\n"
}
