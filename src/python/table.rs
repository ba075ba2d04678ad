//! Tables as columns for NumPy.

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use tautline_workflow::exporting::{Cells, Table};

/// Name of a column with its cells: little-endian bytes of numbers, or a list of texts.
pub type NamedColumn<'py> = (String, Bound<'py, PyAny>);

/// Numbers as the bytes of NumPy's `<f8`.
pub fn numbers<'py>(py: Python<'py>, values: impl Iterator<Item = f64>) -> Bound<'py, PyAny> {
    let bytes: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
    PyBytes::new(py, &bytes).into_any()
}

/// The columns of a table.
pub fn columns<'py>(py: Python<'py>, table: &Table) -> PyResult<Vec<NamedColumn<'py>>> {
    let column = |(name, cells): &(String, Cells)| {
        let cells = match cells {
            Cells::Numbers(values) => numbers(py, values.iter().copied()),
            Cells::Texts(texts) => texts.into_bound_py_any(py)?,
        };
        Ok((name.clone(), cells))
    };
    table.columns.iter().map(column).collect()
}
