//! From the text of a trace to rows that can be trusted.
//!
//! Comment lines (`#`), blank lines, a byte-order mark, ends of line of any system and quoted fields do not matter. Refused is,
//! with its line or column, its value and the rule: an unknown column, a quantity in two columns, no time, a row with too few or
//! too many fields, a field that is empty or no finite number, a value out of the range of its column, a time that does not
//! rise, a gap of more than [`LONGEST_GAP`] median intervals, and values that look as if they had another unit.

use super::columns::{COLUMNS, Column, EITHER_OR, LONGEST_S, Quantity};
use hp_plant::architecture::flaw::among;

/// Longest gap between two rows, in median intervals: beyond that something is missing.
pub const LONGEST_GAP: f64 = 5.0;

/// Shares of rounding that an interval may be longer than the longest gap: times come as decimals.
const GAP_TOLERANCE: f64 = 1e-6;

/// Rows of a trace, column by column.
pub(super) struct Rows {
    /// Times, the first 0 [s].
    pub times_s: Vec<f64>,
    /// Columns besides time with their values.
    pub columns: Vec<(&'static Column, Vec<f64>)>,
}

/// A line of the file that is no comment: its number, counted from 1, and its fields.
struct Line<'a> {
    number: usize,
    text: &'a str,
}

impl<'a> Line<'a> {
    fn fields(&self) -> impl Iterator<Item = &'a str> {
        self.text.split(',').map(|field| field.trim().trim_matches('"').trim())
    }
}

/// Reads and checks the text of a trace.
///
/// # Errors
/// The first thing that is wrong.
pub(super) fn rows(text: &str) -> Result<Rows, String> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(place, text)| Line { number: place + 1, text })
        .filter(|line| !line.text.trim_start().starts_with('#') && !line.text.trim().is_empty());
    let header = lines.next().ok_or("there is no header with the names of the columns")?;
    let columns = columns_of(&header)?;
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    let mut numbers = Vec::new();
    for line in lines {
        read(&line, &columns, &mut values)?;
        numbers.push(line.number);
    }
    if numbers.len() < 2 {
        return Err(format!("a trace needs at least two rows below `{}`", header.text.trim()));
    }
    let time = columns.iter().position(|column| column.quantity == Quantity::Time).unwrap_or_default();
    let mut times_s = values.remove(time);
    check_times(&times_s, &numbers)?;
    let start_s = times_s[0];
    times_s.iter_mut().for_each(|time_s| *time_s -= start_s);
    let others = columns.into_iter().filter(|column| column.quantity != Quantity::Time);
    let columns: Vec<_> = others.zip(values).collect();
    columns.iter().try_for_each(|(column, values)| check_unit(column, values))?;
    Ok(Rows { times_s, columns })
}

/// Columns that a header names.
fn columns_of(header: &Line<'_>) -> Result<Vec<&'static Column>, String> {
    let told = |message: String| format!("line {}: {message}", header.number);
    if let Some(other) = [';', '\t'].into_iter().find(|&mark| header.text.contains(mark)) {
        return Err(told(format!("columns are separated by {other:?}, but must be by commas")));
    }
    let names: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
    let mut columns: Vec<&'static Column> = Vec::new();
    for name in header.fields() {
        let Some(column) = COLUMNS.iter().find(|column| column.name == name) else {
            if name.parse::<f64>().is_ok() {
                return Err(told(format!(
                    "`{}` is no header, but the first line must name the columns, as `time_s,speed_km_h`",
                    header.text.trim()
                )));
            }
            return Err(told(format!("unknown column `{name}`, {}", among(&names, name))));
        };
        if let Some(other) = columns.iter().find(|other| excludes(column, other)) {
            let (one, other) = (column.name, other.name);
            return Err(told(if one == other {
                format!("column `{one}` stands there twice, but must once")
            } else {
                format!("`{other}` and `{one}` say the same, but must not both be there")
            }));
        }
        columns.push(column);
    }
    if columns.iter().all(|column| column.quantity != Quantity::Time) {
        return Err(told("there is no column `time_s`, but there must be".into()));
    }
    if columns.len() < 2 {
        return Err(told("there is no column besides `time_s`, but there must be".into()));
    }
    Ok(columns)
}

/// Whether a trace with one column must not have the other.
fn excludes(one: &Column, other: &Column) -> bool {
    let (grade, elevation) = EITHER_OR;
    let steep = |column: &Column| column.quantity == grade || column.quantity == elevation;
    one.quantity == other.quantity || (steep(one) && steep(other))
}

/// Reads a row.
fn read(line: &Line<'_>, columns: &[&Column], values: &mut [Vec<f64>]) -> Result<(), String> {
    let told = |message: String| format!("line {}: {message}", line.number);
    let count = line.fields().count();
    if count != columns.len() {
        let text = line.text.trim();
        return Err(told(format!("`{text}` has {count} fields, but must have {}", columns.len())));
    }
    for ((field, column), values) in line.fields().zip(columns).zip(values) {
        let Column { name, low, high, .. } = column;
        if field.is_empty() {
            return Err(told(format!("`{name}` is empty, but must be a number")));
        }
        let value: f64 =
            field.parse().map_err(|_| told(format!("`{name}` is `{field}`, but must be a number")))?;
        if !value.is_finite() {
            return Err(told(format!("`{name}` is {value}, but must be a finite number")));
        }
        if !(*low..=*high).contains(&value) {
            return Err(told(format!("`{name}` is {value}, but must be between {low} and {high}")));
        }
        values.push(value);
    }
    Ok(())
}

/// Checks that times rise, without gaps, and not too far.
fn check_times(times_s: &[f64], numbers: &[usize]) -> Result<(), String> {
    let mut intervals_s = Vec::with_capacity(times_s.len() - 1);
    for (pair, number) in times_s.windows(2).zip(&numbers[1..]) {
        let [before_s, time_s] = [pair[0], pair[1]];
        if time_s <= before_s {
            let what = if time_s == before_s { "stands there twice" } else { "runs backwards" };
            return Err(format!(
                "line {number}: `time_s` is {time_s} after {before_s}: it {what}, but must rise"
            ));
        }
        if time_s - times_s[0] > LONGEST_S {
            let span_s = time_s - times_s[0];
            let rule = format!("must be at most {LONGEST_S} s after the first row");
            return Err(format!(
                "line {number}: `time_s` is {time_s}, {span_s} s after the first row, but {rule}"
            ));
        }
        intervals_s.push(time_s - before_s);
    }
    let median_s = median(&intervals_s);
    let longest_s = LONGEST_GAP * median_s * (1.0 + GAP_TOLERANCE);
    match intervals_s.iter().position(|&interval_s| interval_s > longest_s) {
        Some(place) => Err(format!(
            "line {}: a gap of {} s before `time_s` {}, but rows must be at most {LONGEST_GAP} median intervals ({} s) apart",
            numbers[place + 1],
            rounded(intervals_s[place]),
            times_s[place + 1],
            rounded(LONGEST_GAP * median_s),
        )),
        None => Ok(()),
    }
}

/// A time without the round-off of a difference [s].
fn rounded(time_s: f64) -> f64 {
    (time_s * 1e6).round() / 1e6
}

/// Median of at least one value.
pub(super) fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

/// Checks that the values of a column look as if they had its unit.
fn check_unit(column: &Column, values: &[f64]) -> Result<(), String> {
    let highest = values.iter().copied().fold(0.0, f64::max);
    if column.quantity == Quantity::Humidity && highest > 0.0 && highest <= 1.0 {
        return Err(format!(
            "column `{}`: its highest value is {highest}, but no air is that dry: it must be in percent, not a share",
            column.name
        ));
    }
    Ok(())
}
