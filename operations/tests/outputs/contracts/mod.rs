//! Contracts of the JSON documents: their output types as TypeScript for the lab page, and as a list of fields for the book.
//!
//! `SWIMMER_CONTRACTS=overwrite cargo test -p operations --test outputs contracts` writes both files anew. The schemas of the types also check
//! the documents that `cli/tests/system/json_goldens` keeps.

mod conformance;
mod fields;
mod schema;
#[path = "../../../../cli/tests/system/json_goldens/table.rs"]
#[allow(dead_code, reason = "another test runs these commands")]
mod table;
mod typescript;

use std::fs;
use std::path::{Path, PathBuf};

use operations::{Context, GaitSource, Subject, SwimmerSource};
use operations::{
    atlas, best_waveform, catalogue, certify, height_map, optimize, plan, simulate, sweep,
};
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::Value;

use self::schema::Schemas;

/// A JSON document, and the commands that print it.
struct Document {
    /// Command with the options that lead to this document.
    title: &'static str,
    /// Words with which such a command begins; empty for a file or a part that the lab page names.
    words: &'static str,
    /// Name of its type.
    name: String,
}

/// Commands whose documents have no schema:
///
/// - `robot` prints counters, settings and states of `link-protocol`, `gait-player` and `host-link`, which have no schemas because they also
///   run on the robot; their documents are assembled in the command.
/// - `demo` prints figures of its own round next to the document of `calibrate`, and its type belongs to the command.
/// - `man` lists the files that it wrote.
/// - `experiment`, of which no document is kept, assembles its documents in the command from the types of the crate `experiment`.
const WITHOUT_SCHEMA: [&str; 3] = ["demo", "man", "robot"];

/// All documents, and the schemas of their types.
fn contracts() -> (Vec<Document>, Schemas) {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let mut generator = settings.into_generator();
    let all = [
        of::<simulate::Output>(&mut generator, "simulate", "simulate"),
        of::<optimize::displacement::Output>(
            &mut generator,
            "optimize displacement",
            "optimize displacement",
        ),
        of::<optimize::efficiency::Output>(
            &mut generator,
            "optimize efficiency",
            "optimize efficiency",
        ),
        of::<optimize::turning::Output>(&mut generator, "optimize turning", "optimize turning"),
        of::<optimize::sideways::Output>(&mut generator, "optimize sideways", "optimize sideways"),
        of::<optimize::speed::Output>(&mut generator, "optimize speed", "optimize speed"),
        of::<optimize::steer::Output>(&mut generator, "optimize steer", "optimize steer"),
        of::<best_waveform::Output>(&mut generator, "optimize passive", "optimize passive"),
        of::<atlas::Output>(&mut generator, "atlas", "atlas"),
        of::<certify::Output>(&mut generator, "certify", "certify"),
        of::<height_map::Output>(&mut generator, "height-map", "height-map"),
        of::<plan::Output>(&mut generator, "plan", "plan"),
        of::<sweep::PlanOutput>(&mut generator, "sweep plan", "sweep plan"),
        of::<sweep::RunOutput>(&mut generator, "sweep run", "sweep run"),
        of::<::sweep::Status>(&mut generator, "sweep status", "sweep status"),
        of::<sweep::MergeOutput>(&mut generator, "sweep merge", "sweep merge"),
        of::<sweep::MapOutput>(&mut generator, "sweep map", "sweep map"),
        of::<::sweep::Map>(&mut generator, "FILE.json of sweep map --export", ""),
        of::<sweep::SubmitOutput>(&mut generator, "sweep submit slurm", "sweep submit"),
        of::<operations::calibrate::Output>(&mut generator, "calibrate CAMPAIGN.toml", "calibrate"),
        of::<operations::calibrate::RunsOutput>(
            &mut generator,
            "calibrate TRACK --gait GAIT",
            "calibrate",
        ),
        of::<calibrate::evidence::EvidenceDocument>(
            &mut generator,
            "evidence.json of calibrate",
            "",
        ),
        of::<calibrate::TrackSurvey>(&mut generator, "tracks", "tracks"),
        of::<catalogue::SwimmersOutput>(&mut generator, "swimmers", "swimmers"),
        of::<catalogue::SwimmerOutput>(&mut generator, "swimmers NAME", "swimmers"),
        of::<catalogue::GaitsOutput>(&mut generator, "gaits", "gaits"),
        of::<validation::Output>(&mut generator, "paper", "paper"),
    ];
    // Parts that the lab page names.
    generator.subschema_for::<optimize::Output>();
    generator.subschema_for::<forecast::NetMotion>();
    generator.subschema_for::<calibrate::assessment::AssessmentDocument>();
    (all.into(), Schemas::new(generator.take_definitions(true)))
}

fn of<T: JsonSchema>(
    generator: &mut SchemaGenerator,
    title: &'static str,
    words: &'static str,
) -> Document {
    generator.subschema_for::<T>();
    Document {
        title,
        words,
        name: T::schema_name().into_owned(),
    }
}

#[test]
fn the_page_s_types_are_those_of_the_outputs() {
    let (_, schemas) = contracts();
    kept_as(&typescript::file(&schemas), "lab/page/src/contracts.ts");
}

#[test]
fn the_list_of_fields_is_that_of_the_outputs() {
    let (documents, schemas) = contracts();
    let text = fields::page(&documents, &schemas);
    kept_as(&text, "docs/reference/json-fields.md");
}

/// Compares a text with a file of the repository, or writes it.
fn kept_as(text: &str, path: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    if std::env::var("SWIMMER_CONTRACTS").is_ok_and(|value| value == "overwrite") {
        fs::write(&file, text).unwrap();
        return;
    }
    let kept = fs::read_to_string(&file).unwrap_or_default();
    let differs = kept.lines().zip(text.lines()).find(|(a, b)| a != b);
    assert!(
        kept == text,
        "{path} is not that of the output types, first {differs:?}; SWIMMER_CONTRACTS=overwrite writes it anew"
    );
}

/// Two types of one name would become one in TypeScript: the generator numbers the second.
#[test]
fn names_of_types_are_unique() {
    let (_, schemas) = contracts();
    let numbered = schemas
        .names()
        .find(|name| name.ends_with(char::is_numeric));
    assert_eq!(numbered, None);
}

#[test]
fn kept_documents_conform_to_the_schemas() {
    let (documents, schemas) = contracts();
    let mut problems = Vec::new();
    for session in table::SESSIONS.iter().chain(table::LONG_SESSIONS) {
        for command in session.commands {
            let path = golden(session.name, command.document);
            let value: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
            if value.get("error").is_some() && command.status != 0 {
                continue;
            }
            let begins = |words: &&str| {
                let after = command.words.strip_prefix(words);
                after.is_some_and(|after| after.is_empty() || after.starts_with(' '))
            };
            if WITHOUT_SCHEMA.iter().any(begins) {
                continue;
            }
            let mut found = documents
                .iter()
                .filter(|document| !document.words.is_empty() && begins(&document.words))
                .map(|document| conformance::check(&schemas, &document.name, &value))
                .peekable();
            assert!(found.peek().is_some(), "{} has no schema", command.words);
            let failures: Result<Vec<String>, ()> =
                found.map(|done| done.err().ok_or(())).collect();
            if let Ok(failures) = failures {
                problems.push(format!("{}: {}", path.display(), failures.join("; ")));
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

fn golden(session: &str, document: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../cli/tests/golden/json")
        .join(session)
        .join(format!("{document}.json"))
}

/// Outside a viscous fluid the efficiency is NaN, which JSON has as null.
#[test]
fn missing_numbers_conform_to_the_schemas() {
    let mut context = Context::on_disk();
    let gait = GaitSource::Text("circle:1".to_owned());
    let subject = Subject::load(&SwimmerSource::from("perfect-fluid"), &gait, &mut context);
    let output = simulate::run(
        &subject.unwrap(),
        &simulate::Options::default(),
        &mut context,
    );
    let value = serde_json::to_value(output.unwrap()).unwrap();
    assert_eq!(value["efficiency"], Value::Null);
    let (_, schemas) = contracts();
    assert_eq!(
        conformance::check(&schemas, "SimulateOutput", &value),
        Ok(())
    );
}
