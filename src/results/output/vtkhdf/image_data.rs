//! ImageData: fields on equal cells. Cell data of shape (times, z, y, x), components last.

use super::table::{Dataset, FileTable, FileType, ImageCells, data_offsets};
use crate::output::{ColumnUnits, SnapshotStorage};
use talcum_engine::fields::Unit;

/// The file of fields on cells; each dataset is described as that of one cell.
pub(crate) fn image_table(
    cells: ImageCells,
    fields: impl IntoIterator<Item = Dataset>,
    storage: SnapshotStorage,
    units: ColumnUnits,
) -> FileTable {
    let [nx, ny, nz] = cells.counts;
    let of_all = |field: Dataset| {
        let shape = [&[nz, ny, nx], &field.shape[..]].concat();
        Dataset { shape, ..field }
    };
    let data = "CellData";
    let mut datasets: Vec<Dataset> = fields.into_iter().map(of_all).collect();
    datasets.extend(data_offsets(data, &datasets, "index of VTKHDF, one for each time"));
    datasets.push(Dataset::times(units.of(Unit::Time), "times of the snapshots"));
    let file_type = FileType::ImageData(cells);
    FileTable { file_type, data, counts: None, piece: 1, storage, datasets }
}
