//! XML: Kinovea's KVA files, TrackMate's files and the tracks that it exports. A document is parsed whole.

mod kva;
mod trackmate;

use std::path::Path;

use roxmltree::{Document, Node};

use super::lines::{Lines, TextLine};
use super::{Draft, FilePosition, Reading, TrackError, TrackProblem};

/// Most bytes of a document: its tree takes several times as much memory.
const LARGEST: usize = 512 << 20;

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(lines: &mut Lines<'_>, reading: &Reading<'_>) -> Result<Draft, TrackError> {
    let mut text = String::new();
    while let Some(line) = lines.next()? {
        if text.len() + line.text.len() > LARGEST {
            let problem = TrackProblem::BrokenXml {
                cause: format!("it is longer than {} MiB", LARGEST >> 20),
            };
            return Err(line.error(reading.file, 0, problem));
        }
        text.push_str(line.text);
        text.push('\n');
    }
    let document = Document::parse(&text).map_err(|cause| {
        let place = cause.pos();
        TrackError::Broken {
            place: FilePosition {
                file: reading.file.to_owned(),
                line: place.row as usize,
                column: place.col as usize,
            },
            problem: TrackProblem::BrokenXml {
                cause: cause.to_string(),
            },
        }
    })?;
    let root = document.root_element();
    let xml = Xml {
        document: &document,
        file: reading.file,
    };
    match root.tag_name().name() {
        "KinoveaVideoAnalysis" => kva::read(&xml, root, reading),
        "TrackMate" => trackmate::whole(&xml, root, reading),
        "Tracks" => trackmate::exported(&xml, root, reading),
        name => {
            let problem = TrackProblem::UnknownXml {
                root: name.to_owned(),
                hint: hint(name),
            };
            Err(xml.error(root, problem))
        }
    }
}

/// Menu path of the text export in the program that writes such XML.
fn hint(root: &str) -> Option<&'static str> {
    match root {
        "Workbook" => Some("a spreadsheet: save it as CSV"),
        "html" => Some("a page: Kinovea exports text by File, Export to spreadsheet, Gnuplot"),
        "QTM_Data" | "QualisysTrackManager" => Some("QTM: File, Export, TSV"),
        "MarkerSet" | "OpenSimDocument" => Some("OpenSim keeps recordings in TRC files"),
        "object" => Some("Tracker: File, Export, Data File"),
        _ => None,
    }
}

/// A document and where it is from.
struct Xml<'r> {
    document: &'r Document<'r>,
    file: &'r Path,
}

impl Xml<'_> {
    /// An error at this element.
    fn error(&self, node: Node<'_, '_>, problem: TrackProblem) -> TrackError {
        let place = self.document.text_pos_at(node.range().start);
        TrackError::Broken {
            place: FilePosition {
                file: self.file.to_owned(),
                line: place.row as usize,
                column: place.col as usize,
            },
            problem,
        }
    }

    /// A finite number in an attribute.
    fn number(&self, node: Node<'_, '_>, attribute: &str) -> Result<f64, TrackError> {
        let text = node.attribute(attribute).unwrap_or("");
        let value = text.trim().replacen(',', ".", 1).parse::<f64>().ok();
        value.filter(|value| value.is_finite()).ok_or_else(|| {
            let problem = TrackProblem::NoAttribute {
                element: node.tag_name().name().to_owned(),
                attribute: attribute.to_owned(),
            };
            self.error(node, problem)
        })
    }

    /// The line for errors that are the document's.
    fn need_rate(&self, node: Node<'_, '_>, reading: &Reading<'_>) -> Result<f64, TrackError> {
        let place = self.document.text_pos_at(node.range().start);
        let line = TextLine {
            number: place.row as usize,
            text: "",
            ended: true,
        };
        reading.options.need_rate(&line, self.file)
    }
}

/// The first child of this name.
fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// The children of this name.
fn children<'a, 'i: 'a>(
    node: Node<'a, 'i>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children()
        .filter(move |child| child.has_tag_name(name))
}
