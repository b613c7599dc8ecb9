//! Merges all parts into one Parquet file, sorted by key, one row group at a time. The bytes do not depend on who ran the blocks.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;
use swimmer_files::stream_atomically;

use crate::row::Row;
use crate::{Aim, Field, Plan, SweepError, part};

/// Counts of a merged table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepMergeCounts")
)]
pub struct Merged {
    /// Number of rows.
    #[serde(rename = "done")]
    pub tasks: u64,
    /// Designs without a gait.
    pub failed: u64,
    /// Number of gaits whose certificate passes.
    pub certified: u64,
}

/// Name of the column of an objective axis. The column `objective` has the maximised value.
const BEST_FOR: &str = "best_for";
/// Least number of rows of a row group, which is held in memory.
const GROUP: usize = 1 << 16;

/// Numeric quantity of a row: column name and accessor.
type Number = (&'static str, fn(&Row) -> Option<f64>);

const NUMBERS: [Number; 11] = [
    ("objective", |row| row.objective),
    ("displacement_over_length", |row| {
        row.displacement_over_length
    }),
    ("lateral_over_length", |row| row.lateral_over_length),
    ("rotation_rad", |row| row.rotation_rad),
    ("efficiency", |row| row.efficiency),
    ("speed_over_length_per_s", |row| row.speed_over_length_per_s),
    ("period_s", |row| row.period_s),
    ("amplitude_rad", |row| row.amplitude_rad),
    ("start_angle_rad", |row| row.start_angle_rad),
    ("end_angle_rad", |row| row.end_angle_rad),
    ("links_cross", |row| row.links_cross),
];

/// Writes the table of a finished sweep: `key`, each axis by its name (the objective's as `best_for`), the quantities of [`Row`], `arcs`, `status`
/// (`optimal`, `uncertified` or `none`), `certified`, `warm` and `reason`. Its metadata has the plan and its hash.
///
/// # Errors
/// [`SweepError::Unfinished`] if parts are missing, or the error of the writer. No table is left behind.
pub fn merge(plan: &Plan, folder: &Path, table: &Path) -> Result<Merged, SweepError> {
    let lost: Vec<u64> = (0..plan.blocks())
        .filter(|block| part::read(plan, folder, *block).is_none())
        .collect();
    if let Some(&first) = lost.first() {
        return Err(SweepError::Unfinished {
            missing: lost.len() as u64,
            blocks: plan.blocks(),
            first,
        });
    }
    let mut merged = Merged::default();
    stream_atomically(table, |file| {
        written(plan, folder, file, &mut merged).map_err(|error| match error {
            ParquetError::External(cause) => match cause.downcast::<io::Error>() {
                Ok(error) => *error,
                Err(cause) => io::Error::other(cause),
            },
            other => io::Error::other(other),
        })
    })?;
    Ok(merged)
}

fn written(
    plan: &Plan,
    folder: &Path,
    file: &mut BufWriter<File>,
    merged: &mut Merged,
) -> Result<(), ParquetError> {
    let metadata = |key: &str, value: String| KeyValue::new(key.to_owned(), value);
    let properties = WriterProperties::builder()
        .set_created_by(format!("swimmer {}", env!("CARGO_PKG_VERSION")))
        .set_key_value_metadata(Some(vec![
            metadata("swimmer-sweep-plan-sha256", plan.hash()),
            metadata("swimmer-sweep-plan", plan.text().to_owned()),
        ]))
        .build();
    let schema = Arc::new(schema(plan)?);
    let mut table = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
    let mut held: Vec<Row> = Vec::new();
    for block in 0..plan.blocks() {
        held.extend(part::read(plan, folder, block).ok_or_else(|| {
            ParquetError::General(format!(
                "block {block} was there a moment ago, and is not now"
            ))
        })?);
        if held.len() >= GROUP || block + 1 == plan.blocks() {
            merged.tasks += held.len() as u64;
            merged.failed += held.iter().filter(|row| row.certified.is_none()).count() as u64;
            merged.certified += held
                .iter()
                .filter(|row| row.certified == Some(true))
                .count() as u64;
            let mut group = table.next_row_group()?;
            columns(plan, &mut group, &held)?;
            group.close()?;
            held.clear();
        }
    }
    table.close()?;
    Ok(())
}

fn schema(plan: &Plan) -> Result<Type, ParquetError> {
    let column = |name: &str, kind, repetition, logical| {
        Type::primitive_type_builder(name, kind)
            .with_repetition(repetition)
            .with_logical_type(logical)
            .build()
            .map(Arc::new)
    };
    let text = || Some(LogicalType::String);
    let (must, may) = (Repetition::REQUIRED, Repetition::OPTIONAL);
    let mut columns = vec![column("key", Physical::INT64, must, None)?];
    for axis in plan.axes() {
        columns.push(if axis.name == Field::Objective {
            column(BEST_FOR, Physical::BYTE_ARRAY, must, text())?
        } else {
            column(axis.name.name(), Physical::DOUBLE, must, None)?
        });
    }
    for (name, _) in NUMBERS {
        columns.push(column(name, Physical::DOUBLE, may, None)?);
    }
    columns.push(column("arcs", Physical::BYTE_ARRAY, may, text())?);
    columns.push(column("status", Physical::BYTE_ARRAY, must, text())?);
    columns.push(column("certified", Physical::BOOLEAN, may, None)?);
    columns.push(column("warm", Physical::BOOLEAN, must, None)?);
    columns.push(column("reason", Physical::BYTE_ARRAY, may, text())?);
    Type::group_type_builder("sweep")
        .with_fields(columns)
        .build()
}

type Group<'a, 'f> = SerializedRowGroupWriter<'a, &'f mut BufWriter<File>>;

fn columns(plan: &Plan, group: &mut Group<'_, '_>, rows: &[Row]) -> Result<(), ParquetError> {
    let keys: Vec<i64> = rows.iter().map(|row| row.key.cast_signed()).collect();
    must::<Int64Type>(group, &keys)?;
    for (index, axis) in plan.axes().iter().enumerate() {
        let values = rows
            .iter()
            .map(|row| plan.point(row.key).get(index).copied().unwrap_or(f64::NAN));
        if axis.name == Field::Objective {
            let words =
                values.map(|value| ByteArray::from(Aim::of_index(value).map_or("", Aim::word)));
            must::<ByteArrayType>(group, &words.collect::<Vec<_>>())?;
        } else {
            must::<DoubleType>(group, &values.collect::<Vec<_>>())?;
        }
    }
    for (_, value) in NUMBERS {
        may::<DoubleType>(group, rows.iter().map(value))?;
    }
    let bytes = |text: &str| ByteArray::from(text);
    may::<ByteArrayType>(group, rows.iter().map(|row| row.arcs.as_deref().map(bytes)))?;
    let status: Vec<_> = rows.iter().map(|row| bytes(row.status())).collect();
    must::<ByteArrayType>(group, &status)?;
    may::<BoolType>(group, rows.iter().map(|row| row.certified))?;
    must::<BoolType>(group, &rows.iter().map(|row| row.warm).collect::<Vec<_>>())?;
    may::<ByteArrayType>(
        group,
        rows.iter().map(|row| row.reason.as_deref().map(bytes)),
    )
}

fn must<T: parquet::data_type::DataType>(
    group: &mut Group<'_, '_>,
    values: &[T::T],
) -> Result<(), ParquetError> {
    column::<T>(group, values, None)
}

fn may<T: parquet::data_type::DataType>(
    group: &mut Group<'_, '_>,
    values: impl Iterator<Item = Option<T::T>>,
) -> Result<(), ParquetError> {
    let mut levels = Vec::new();
    let mut there = Vec::new();
    for value in values {
        levels.push(i16::from(value.is_some()));
        there.extend(value);
    }
    column::<T>(group, &there, Some(&levels))
}

fn column<T: parquet::data_type::DataType>(
    group: &mut Group<'_, '_>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let mut column = group
        .next_column()?
        .ok_or_else(|| ParquetError::General("the schema has too few columns".to_owned()))?;
    column.typed::<T>().write_batch(values, levels, None)?;
    column.close()
}
