//! A dataset that all ranks write.

use hdf5::Dataset;

use super::rows::{width, write};
use super::{Element, MessageResult, written};
use talcum_engine::parallel::{Communicator, records_of_bytes};

/// Largest number of bytes, from all ranks, that are being sent to rank 0 at a time: more would only take memory.
const ON_THE_WAY: usize = 16 << 20;

/// A dataset that all ranks write.
pub(crate) struct SharedDataset<'f> {
    /// Its name in errors.
    name: String,
    /// `None` on ranks that leave the writing to rank 0.
    dataset: Option<Dataset>,
    /// Number of values in a row; not used if all ranks write.
    width: usize,
    ranks: &'f dyn Communicator,
    together: bool,
}

impl<'f> SharedDataset<'f> {
    /// An open dataset. Collective.
    pub(super) fn new(
        name: &str,
        dataset: Option<Dataset>,
        ranks: &'f dyn Communicator,
        together: bool,
    ) -> Self {
        let mut widths = [dataset.as_ref().map_or(1, width) as f64];
        if !together {
            // Ranks that do not have it open receive its width from rank 0.
            ranks.maximum(&mut widths);
        }
        Self { name: name.to_owned(), dataset, width: widths[0] as usize, ranks, together }
    }

    /// Writes this rank's rows from `first_row` on. The rows of the ranks follow one another in the order of ranks,
    /// without gaps. Collective, but an error may concern only this rank.
    pub(crate) fn write_rows<T: Element>(&self, first_row: u64, values: &[T]) -> MessageResult<()> {
        if self.together || self.ranks.size() == 1 {
            return self.write(first_row, values);
        }
        let (own, to_root) =
            if self.ranks.is_root() { (values, &[][..]) } else { (&[][..], values) };
        let written = self.write(first_row, own);
        written.and(self.write_those_of_others(first_row, to_root))
    }

    /// Lets rank 0 write the rows of other ranks, which send them in pieces. Each piece begins with the number of its
    /// first row.
    fn write_those_of_others<T: Element>(&self, first: u64, values: &[T]) -> MessageResult<()> {
        let row_bytes = self.width * size_of::<T>();
        let rows = (ON_THE_WAY / self.ranks.size() / row_bytes).max(1);
        let mut pieces = values.chunks(rows * self.width);
        let mut rounds = [pieces.len() as f64];
        self.ranks.maximum(&mut rounds);
        let mut result = Ok(());
        // This is also done after an error, because the other ranks take part.
        for round in 0..rounds[0] as u64 {
            let first_row = first + round * rows as u64;
            let piece = bytemuck::cast_slice(pieces.next().unwrap_or_default());
            let message = [bytemuck::bytes_of(&first_row), piece].concat();
            for message in self.ranks.gather_to_root(&message).unwrap_or_default() {
                let (first_row, rows) = message.split_at(size_of::<u64>());
                let values: Vec<T> = records_of_bytes(rows).collect();
                result = result.and(self.write(bytemuck::pod_read_unaligned(first_row), &values));
            }
        }
        result
    }

    /// Writes rows from this rank, if it has the dataset open.
    fn write<T: Element>(&self, first_row: u64, values: &[T]) -> MessageResult<()> {
        let Some(dataset) = self.dataset.as_ref().filter(|_| self.together || !values.is_empty())
        else {
            return Ok(());
        };
        // Rows of a dataset of fixed length are contiguous: the rows of a rank are one piece of the file.
        let result = write(dataset, first_row, values, self.together && dataset.is_chunked());
        written(result).map_err(|message| format!("{}: {message}", self.name))
    }
}
