//! A table as text: comments with the provenance, a header with units, and rows over time, written by rank 0.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use super::output_file::{Obstacle, continue_or_create};
use super::{
    Head, MessageResult, Opening, OutputError, free_name, on_root, set_aside, write_whole,
};
use talcum_engine::parallel::Communicator;

/// Format of a table.
#[derive(Clone, Debug)]
pub(super) struct TableFormat {
    /// The line with names and units.
    pub(super) header: String,
    /// Columns that are texts, or may be empty; the others are numbers.
    pub(super) texts: &'static [usize],
}

/// An open table whose first column is the time.
#[derive(Debug)]
pub(super) struct TextTable {
    path: PathBuf,
    /// Set on rank 0.
    file: Option<File>,
}

impl TextTable {
    /// Begins a table, or continues an earlier one, like the run. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn open(
        path: &Path,
        opening: &Opening<'_>,
        format: &TableFormat,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        match opening.continue_after {
            Some(time) => Self::resume(path, time, opening.head, format, ranks),
            None => Self::create(path, opening.head, format, ranks),
        }
    }

    /// Begins a table, replacing any existing one. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn create(
        path: &Path,
        head: Head<'_>,
        format: &TableFormat,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let file = on_root(path, ranks, || create(path, head, format))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Continues a table after the rows up to and including `time`; later ones are dropped, so that the file becomes
    /// that of a run without interruption. A file that is not such a table is set aside. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn resume(
        path: &Path,
        time: f64,
        head: Head<'_>,
        format: &TableFormat,
        ranks: &dyn Communicator,
    ) -> Result<Self, OutputError> {
        let file = on_root(path, ranks, || {
            let rows = continue_or_create(
                path,
                |_| rows_up_to(path, time, format).map(Some),
                || Ok(None),
            )?;
            rows.map_or_else(|| create(path, head, format), |text| replace(path, &text))
        })?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Adds lines, which are in the file on return; those of rank 0 are written. Collective.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn append(
        &mut self,
        lines: &str,
        ranks: &dyn Communicator,
    ) -> Result<(), OutputError> {
        on_root(&self.path, ranks, || {
            let file = self.file.as_mut().ok_or("the file is not open")?;
            if !leads_to(&self.path, file).map_err(|error| error.to_string())? {
                *file = put_back(&self.path, file)?;
            }
            file.write_all(lines.as_bytes()).map_err(|error| error.to_string())
        })?;
        Ok(())
    }

    /// Syncs the file to the disk. Collective.
    ///
    /// # Errors
    /// If this fails.
    pub(super) fn commit(&self, ranks: &dyn Communicator) -> Result<(), OutputError> {
        on_root(&self.path, ranks, || {
            let file = self.file.as_ref().ok_or("the file is not open")?;
            file.sync_all().map_err(|error| error.to_string())
        })
        .map(|_| ())
    }
}

/// The shortest text from which the same bits are read.
pub(super) fn shortest(value: f64) -> String {
    let plain = value == 0.0 || (1.0e-4..1.0e15).contains(&value.abs());
    if plain { format!("{value}") } else { format!("{value:e}") }
}

fn create(path: &Path, head: Head<'_>, format: &TableFormat) -> MessageResult<File> {
    let mut text = String::new();
    for (name, entry) in head.provenance.entries() {
        text += &format!("# {name}: {}\n", entry.replace(['\n', '\r'], " "));
    }
    for line in head.case_text.lines() {
        text += format!("# case: {line}").trim_end();
        text += "\n";
    }
    text += &format.header;
    text += "\n";
    replace(path, &text)
}

/// Replaces a file atomically and opens it to append.
fn replace(path: &Path, text: &str) -> MessageResult<File> {
    write_whole(path, text.as_bytes())?;
    let opened = OpenOptions::new().read(true).append(true).open(path);
    opened.map_err(|error| error.to_string())
}

/// Whether a path leads to an open file: it may have been removed, or replaced by another file.
fn leads_to(path: &Path, file: &File) -> std::io::Result<bool> {
    let open = file.metadata()?;
    match std::fs::metadata(path) {
        Ok(there) => Ok((there.dev(), there.ino()) == (open.dev(), open.ino())),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// Writes the rows of an open table again to its path, which no longer leads to it. A file that is there is set aside.
fn put_back(path: &Path, mut file: &File) -> MessageResult<File> {
    let mut text = String::new();
    let read = file.rewind().and_then(|()| file.read_to_string(&mut text));
    read.map_err(|error| error.to_string())?;
    if path.exists() {
        set_aside(path, "it is not the one that this run started")?;
    }
    log::warn!("{} was removed or replaced during the run: it is written again", path.display());
    replace(path, &text)
}

/// The text of a table up to and including a time. Damaged rows are left out with a warning, and a copy of the original
/// file is kept; a last row truncated by a kill is not damage. Rows that end too early are reported.
fn rows_up_to(path: &Path, time: f64, format: &TableFormat) -> Result<String, Obstacle> {
    let text = std::fs::read_to_string(path).map_err(|error| Obstacle::of_io(&error))?;
    let (mut kept, rows) = head_and_rows(&text, format).map_err(Obstacle::Unusable)?;
    let mut damaged = Vec::new();
    let mut times = Vec::new();
    for (place, row) in rows.iter().enumerate() {
        let before = times.last().copied().unwrap_or(f64::NEG_INFINITY);
        match row.time_after(before, &rows[place + 1..]) {
            Some(row_time) => {
                kept += if row_time <= time { row.line } else { "" };
                times.push(row_time);
            }
            None => damaged.push(row.number.to_string()),
        }
    }
    if !damaged.is_empty() {
        keep_copy(path, &damaged.join(", ")).map_err(Obstacle::Failed)?;
    }
    if let Some(last) = missing_after(time, &times) {
        let path = path.display();
        log::warn!("{path}: its rows end at time {last}, before {time}: rows in between are lost");
    }
    Ok(kept)
}

/// A line below the header.
struct Row<'t> {
    /// Number of the line in the file, from 1.
    number: usize,
    line: &'t str,
    /// `None` if it is not a row of the table, or its time is not a number.
    time: Option<f64>,
}

impl Row<'_> {
    /// Its time; `None` if it is damaged: before the time of the row above, or after those of the rows below.
    fn time_after(&self, before: f64, below: &[Self]) -> Option<f64> {
        /// Number of rows below that are compared, since one of them may be damaged itself.
        const ASKED: usize = 2;
        let own = self.time.filter(|&own| own >= before)?;
        let mut next = below.iter().filter_map(|row| row.time).take(ASKED).peekable();
        let is_too_late = next.peek().is_some() && next.all(|next| before <= next && next < own);
        (!is_too_late).then_some(own)
    }
}

/// The comments and the header of a table, and the rows below them, without an unfinished last one.
fn head_and_rows<'t>(text: &'t str, format: &TableFormat) -> MessageResult<(String, Vec<Row<'t>>)> {
    let mut head = String::new();
    let mut rows = Vec::new();
    let mut columns = None;
    for (number, line) in (1..).zip(text.split_inclusive('\n')) {
        if line.starts_with('#') {
            head += line;
        } else if columns.is_none() {
            if line.trim_end() != format.header {
                return Err("it has other columns".to_owned());
            }
            columns = Some(cells(line).len());
            head += line;
        } else if line.ends_with('\n') {
            let time = line.split(',').next().and_then(|first| first.parse().ok());
            let time = time.filter(|time: &f64| time.is_finite() && is_row(line, columns, format));
            rows.push(Row { number, line, time });
        }
    }
    if columns.is_none() {
        return Err("it has no header".to_owned());
    }
    Ok((head, rows))
}

/// The last time of the rows up to `time` if there should be others: rows are synced to the disk with each checkpoint. A row is
/// written at the first step after a multiple of its interval, so the longest of the last intervals is used; and all
/// times have the same number of rows. Later rows say nothing: their time may be a damaged one.
fn missing_after(time: f64, times: &[f64]) -> Option<f64> {
    let kept: Vec<&[f64]> =
        times[..times.partition_point(|&row| row <= time)].chunk_by(f64::eq).collect();
    let is_short = |pair: &[&[f64]]| pair[1].len() < pair[0].len();
    let whole = kept.len() - usize::from(kept.windows(2).last().is_some_and(is_short));
    let last_ones: Vec<f64> =
        kept[whole.saturating_sub(10)..whole].iter().map(|rows| rows[0]).collect();
    let longest = last_ones.windows(2).map(|pair| pair[1] - pair[0]).reduce(f64::max)?;
    let last = *last_ones.last()?;
    // Times are sums of steps: one part in 10^9 is far below any interval.
    (last + (1.0 - 1.0e-9) * longest <= time).then_some(last)
}

/// Whether a line has this number of cells, all of which are numbers except for those of texts.
fn is_row(line: &str, columns: Option<usize>, format: &TableFormat) -> bool {
    let cells = cells(line.trim_end());
    let is_number = |cell: &&str| cell.parse::<f64>().is_ok();
    let numbers = cells.iter().enumerate().filter(|(place, _)| !format.texts.contains(place));
    Some(cells.len()) == columns && numbers.map(|(_, cell)| cell).all(is_number)
}

/// Keeps a copy of a table from which damaged rows are left out.
fn keep_copy(path: &Path, lines: &str) -> MessageResult<()> {
    let copy = free_name(path);
    std::fs::copy(path, &copy).map_err(|error| format!("cannot be copied: {error}"))?;
    let [path, copy] = [path.display(), copy.display()];
    log::warn!("{path}: damaged rows are left out (line {lines}); the original is kept as {copy}");
    Ok(())
}

/// A text as a cell: quoted if it contains a comma, a quotation mark or a line break.
pub(super) fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace(['\n', '\r'], " ").replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// The cells of a line; commas between quotation marks do not separate them.
fn cells(line: &str) -> Vec<&str> {
    let mut is_quoted = false;
    let separates = |character: char| {
        is_quoted ^= character == '"';
        character == ',' && !is_quoted
    };
    line.split(separates).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_a_time_that_does_not_fit_is_damaged_and_no_other_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        let format = TableFormat { header: "time [s],a [1]".to_owned(), texts: &[] };
        let whole = ["0", "0.1", "0.2", "0.3", "0.4"];
        for place in 0..whole.len() {
            for wrong in ["0", "NaN", "inf", "1e9", "-1"] {
                let mut times = whole;
                times[place] = wrong;
                // Rows of several walls have the same time, and a last row may be later than the checkpoint.
                if times == whole || matches!((place, wrong), (1, "0") | (4, "1e9")) {
                    continue;
                }
                let rows: String = times.iter().map(|time| format!("{time},1\n")).collect();
                std::fs::write(&path, format!("{}\n{rows}", format.header)).unwrap();
                let kept = rows_up_to(&path, 0.4, &format).unwrap();
                let expected: Vec<&str> = whole
                    .into_iter()
                    .enumerate()
                    .filter(|(n, _)| *n != place)
                    .map(|(_, t)| t)
                    .collect();
                let found: Vec<&str> =
                    kept.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
                let first_is_early = place == 0 && wrong == "-1";
                assert_eq!(
                    found,
                    if first_is_early { times.to_vec() } else { expected },
                    "{times:?}"
                );
                let copy = folder.path().join("series.csv.unreadable-1");
                assert_eq!(std::fs::remove_file(copy).is_ok(), !first_is_early, "{times:?}");
            }
        }
    }

    #[test]
    fn numbers_are_read_back_as_they_were() {
        for value in [0.0, 0.1, -3000.0, 1.0e-17, 1.234_567_890_123_456_7e300, f64::MIN_POSITIVE] {
            assert_eq!(shortest(value).parse::<f64>().unwrap(), value);
        }
        assert_eq!(shortest(3000.0), "3000");
    }

    #[test]
    fn rows_that_end_too_early_are_noticed() {
        let times = [0.0, 0.1, 0.1, 0.2, 0.2];
        assert_eq!(missing_after(0.3, &times), Some(0.2));
        assert_eq!(missing_after(0.29, &times), None);
        assert_eq!(missing_after(0.3, &[0.0, 0.11, 0.2]), None);
        // One of the last rows, or the only one, is lost, or seems to have a later time.
        assert_eq!(missing_after(0.2, &[0.0, 0.0, 0.1, 0.1, 0.2]), Some(0.1));
        assert_eq!(missing_after(0.2, &[0.0, 0.0, 0.1, 0.1, 0.2, 1.0e9]), Some(0.1));
        assert_eq!(missing_after(0.2, &[0.0, 0.1, 1.0e9]), Some(0.1));
        // Rows later than the time are dropped; a single row gives no interval.
        assert_eq!(missing_after(0.05, &times), None);
        assert_eq!(missing_after(9.0, &[0.0, 0.0]), None);
    }

    #[test]
    fn rows_have_numbers_where_they_should() {
        let format = TableFormat { header: "a,b,c".to_owned(), texts: &[1] };
        assert!(is_row("1,base plate,-2e3\n", Some(3), &format));
        assert!(is_row("1,,3\n", Some(3), &format));
        for damaged in ["1,b\n", "x,b,3\n", "1,b,\n", "1,b,3,4\n"] {
            assert!(!is_row(damaged, Some(3), &format), "{damaged}");
        }
    }

    #[test]
    fn texts_are_one_cell_whatever_they_hold() {
        assert_eq!(quoted("base plate"), "base plate");
        assert_eq!(quoted("a \"wide\", flat one"), "\"a \"\"wide\"\", flat one\"");
        assert_eq!(cells("1,\"a \"\"wide\"\", flat one\",2\n").len(), 3);
        assert_eq!(cells("1,2,3,"), ["1", "2", "3", ""]);
    }
}
