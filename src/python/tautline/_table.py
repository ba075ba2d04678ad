"""Columns with names, as pandas and Arrow take them."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def numbers(values: Any) -> Array:
    """An array in which what is unknown (null) is NaN."""
    return np.array(values, dtype=np.float64)


class Columns:
    """Arrays of one length with names."""

    columns: dict[str, NDArray[Any]]

    def to_pandas(self) -> Any:
        """The columns as a pandas table, if pandas is installed."""
        return importlib.import_module("pandas").DataFrame(self.columns)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """The columns through the Arrow C interface, as `pyarrow.table`, `polars.DataFrame` and DuckDB take them, if
        `arro3-core` is installed."""
        arrow = importlib.import_module("arro3.core")

        def array(values: NDArray[Any]) -> Any:
            if values.dtype.kind == "U":
                return arrow.Array(values.tolist(), arrow.DataType.utf8())
            # Some columns are those of a matrix.
            return arrow.Array.from_numpy(np.ascontiguousarray(values))

        table = arrow.Table.from_pydict({name: array(values) for name, values in self.columns.items()})
        return table.__arrow_c_stream__(requested_schema)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))
