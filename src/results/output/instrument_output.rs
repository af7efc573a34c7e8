//! The files of one instrument: its table, and fields or lines for ParaView.

use std::path::Path;

use super::contact_lines::ContactLines;
use super::instrument_file::InstrumentFile;
use super::vtkhdf::{Dataset, ImageCells, Numbers, Writer, image_table};
use super::{Head, OutputError, SnapshotStorage};
use crate::instruments::{CellValues, Image, InstrumentPlan, Layout, Readings};
use talcum_engine::fields::Column;
use talcum_engine::parallel::{Communicator, records_of_bytes};

/// The open files of an instrument.
#[derive(Debug)]
pub struct InstrumentOutput {
    table: InstrumentFile,
    image: Option<ImageOutput>,
    lines: Option<ContactLines>,
}

/// The open file of fields.
#[derive(Debug)]
struct ImageOutput {
    writer: Writer,
    image: Image,
}

impl InstrumentOutput {
    /// Begins the files in a folder, or continues them after their contents up to and including a time. Collective.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn open(
        folder: &Path,
        plan: &InstrumentPlan,
        layout: &Layout,
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let [table, drawn] = plan.file_names().map(|name| folder.join(name));
        let open_image = |image| ImageOutput::open(&drawn, image, head, continue_after, ranks);
        let image = layout.image.clone().map(open_image).transpose()?;
        let open_lines = || ContactLines::open(&drawn, head, continue_after, ranks);
        let lines = layout.lines.then(open_lines).transpose()?;
        let table = InstrumentFile::open(&table, plan, layout, head, continue_after, ranks)?;
        Ok(Self { table, image, lines })
    }

    /// Adds the results of a sample. Collective.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(
        &mut self,
        time: f64,
        readings: Readings,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let Readings { rows, cells, lines } = readings;
        if let Some((image, cells)) = self.image.as_mut().zip(cells) {
            image.append(time, &cells, ranks)?;
        }
        if let Some((file, lines)) = self.lines.as_mut().zip(lines) {
            file.append(time, &lines, ranks)?;
        }
        if rows.is_empty() {
            return Ok(());
        }
        self.table.append(time, rows, ranks)
    }

    /// Secures the data written so far. Collective.
    ///
    /// # Errors
    /// If a file cannot be synced to the disk.
    pub fn commit(&mut self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        if let Some(image) = &self.image {
            image.writer.commit(ranks)?;
        }
        if let Some(lines) = &self.lines {
            lines.commit(ranks)?;
        }
        self.table.commit(ranks)
    }
}

impl ImageOutput {
    fn open(
        path: &Path,
        image: Image,
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let Image { origin, spacing, counts, .. } = image;
        let units = head.units();
        let dataset = |field| Dataset::of_column("CellData/", field, Numbers::Real, units);
        let fields = image.fields.iter().map(dataset);
        let cells = ImageCells { origin, spacing, counts };
        let table = image_table(cells, fields, SnapshotStorage::default(), units);
        let writer = Writer::open(path, table, head, continue_after, ranks)?;
        Ok(Self { writer, image })
    }

    /// Adds the cells of all ranks; cells that no rank knows are zero. Collective.
    fn append(
        &mut self,
        time: f64,
        cells: &[CellValues],
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let fields = &self.image.fields;
        let width: usize = fields.iter().map(Column::width).sum();
        let mut flat: Vec<f64> = Vec::with_capacity(cells.len() * (width + 1));
        for CellValues { cell, values } in cells {
            flat.push(f64::from_bits(*cell));
            flat.extend(values);
        }
        let gathered = ranks.gather_to_root(bytemuck::cast_slice(&flat));
        let bytes = gathered.unwrap_or_default().concat();
        let flat: Vec<f64> = records_of_bytes(&bytes).collect();
        let names: Vec<_> = fields.iter().map(|field| format!("CellData/{}", field.name)).collect();
        let rows = names.iter().map(String::as_str).zip(numbers_of(&self.image, &flat, width));
        self.writer.append_on_root(time, ranks, rows)
    }
}

/// The numbers of each field, cell by cell, from records of a cell's number and its values, so many.
fn numbers_of<'a>(
    image: &'a Image,
    flat: &'a [f64],
    width: usize,
) -> impl Iterator<Item = Vec<f64>> + 'a {
    let total: usize = image.counts.iter().product();
    let mut first = 1;
    image.fields.iter().map(move |field| {
        let of_field = first..first + field.width();
        first = of_field.end;
        let mut numbers = vec![0.0; total * field.width()];
        for record in flat.chunks_exact(width + 1) {
            let cell = record[0].to_bits() as usize;
            let place = cell * field.width()..(cell + 1) * field.width();
            if let Some(numbers) = numbers.get_mut(place) {
                numbers.copy_from_slice(&record[of_field.clone()]);
            }
        }
        numbers
    })
}
