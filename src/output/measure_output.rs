//! The files of one measure: its table, and fields or lines for ParaView.

use std::path::{Path, PathBuf};

use super::contact_lines::ContactLines;
use super::image_file::{self, ImageCells, ImageField, bulk};
use super::measure_file::MeasureFile;
use super::output_file::continue_or_create;
use super::{Head, MessageResult, OutputError, SnapshotStorage, metadata_copy, on_root};
use crate::measures::{CellValues, Findings, Image, Layout, MeasurePlan};
use crate::parallel::Communicator;

/// The open files of a measure.
#[derive(Debug)]
pub struct MeasureOutput {
    table: MeasureFile,
    image: Option<ImageOutput>,
    lines: Option<ContactLines>,
}

/// The open file of fields.
#[derive(Debug)]
struct ImageOutput {
    path: PathBuf,
    image: Image,
}

impl MeasureOutput {
    /// Begins the files in a folder, or continues them after their contents up to and including a time. Collective.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn open(
        folder: &Path,
        plan: &MeasurePlan,
        layout: &Layout,
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let [table, drawn] = plan.file_names().map(|name| folder.join(name));
        let image = layout.image.clone().map(|image| ImageOutput { path: drawn.clone(), image });
        if let Some(image) = &image {
            image.open(head, continue_after, ranks)?;
        }
        let lines = match layout.lines {
            true => Some(ContactLines::open(&drawn, head, continue_after, ranks)?),
            false => None,
        };
        let table = MeasureFile::open(&table, plan, layout, head, continue_after, ranks)?;
        Ok(Self { table, image, lines })
    }

    /// Adds the results of a sample. Collective.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(
        &mut self,
        time: f64,
        findings: Findings,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let Findings { rows, cells, lines } = findings;
        if let Some((image, cells)) = self.image.as_ref().zip(cells) {
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
            metadata_copy::commit_on_root(&image.path, &bulk(&image.tables()), ranks)?;
        }
        if let Some(lines) = &self.lines {
            lines.commit(ranks)?;
        }
        self.table.commit(ranks)
    }
}

impl ImageOutput {
    fn tables(&self) -> Vec<String> {
        image_file::tables(self.image.fields.iter().map(|field| field.name))
    }

    fn open(
        &self,
        head: Head<'_>,
        continue_after: Option<f64>,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let (path, tables) = (&self.path, self.tables());
        on_root(path, ranks, || {
            let Some(time) = continue_after else { return self.create(head) };
            let go_on = |found| image_file::cut_after(path, time, &tables, found);
            let kept = continue_or_create(path, go_on, || Ok(0))?;
            if kept > 0 { metadata_copy::commit(path, &bulk(&tables)) } else { self.create(head) }
        })?;
        Ok(())
    }

    fn create(&self, head: Head<'_>) -> MessageResult<()> {
        let Image { origin, spacing, counts, fields } = &self.image;
        let cells = ImageCells { origin: *origin, spacing: *spacing, counts: *counts };
        let units = head.units();
        let fields = fields.iter().map(|field| ImageField {
            name: field.name,
            components: field.width(),
            unit: units.of(field.quantity),
            description: field.meaning,
        });
        let storage = SnapshotStorage::default();
        image_file::create(&self.path, &cells, &fields.collect::<Vec<_>>(), storage, head)
    }

    /// Adds the cells of all ranks; cells that no rank knows are zero. Collective.
    fn append(
        &self,
        time: f64,
        cells: &[CellValues],
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        let width: usize = self.image.fields.iter().map(|field| field.width()).sum();
        let mut flat: Vec<f64> = Vec::with_capacity(cells.len() * (width + 1));
        for CellValues { cell, values } in cells {
            flat.push(f64::from_bits(*cell));
            flat.extend(values);
        }
        let gathered = ranks.gather_to_root(bytemuck::cast_slice(&flat));
        on_root(&self.path, ranks, || {
            let bytes = gathered.unwrap_or_default().concat();
            let flat: Vec<f64> = crate::parallel::records_of_bytes(&bytes).collect();
            image_file::append(&self.path, time, self.fields_of(&flat, width))
        })?;
        Ok(())
    }

    /// The values of each field, cell by cell, from records of a cell's number and its values.
    fn fields_of<'a>(
        &'a self,
        flat: &'a [f64],
        width: usize,
    ) -> impl Iterator<Item = (&'a str, Vec<f64>)> + 'a {
        let total: usize = self.image.counts.iter().product();
        let mut first = 1;
        self.image.fields.iter().map(move |field| {
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
            (field.name, numbers)
        })
    }
}
