"""Columns with names, as pandas and Arrow take them."""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SHOWN = 10
"""Rows of a table that a notebook shows."""


def numbers(values: Any) -> Array:
    """An array in which what is unknown (null) is NaN."""
    return np.array(values, dtype=np.float64)


def optional(module: str, extra: str) -> Any:
    """A module that the package does without, from the extra of this name."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as missing:
        hint = f"{module} is not installed: pip install 'tautline[{extra}]'"
        raise ModuleNotFoundError(hint, name=missing.name) from missing


def _cell(value: Any) -> str:
    if isinstance(value, (float, np.floating)):
        return "" if np.isnan(value) else f"{value:.6g}"
    return escape(str(value))


class Columns:
    """Arrays of one length with names: `table["name"]` is one of them, as in pandas."""

    columns: dict[str, NDArray[Any]]

    def _column(self, name: str) -> NDArray[Any]:
        try:
            return self.columns[name]
        except KeyError:
            raise KeyError(f'found no column "{name}", expected one of {", ".join(self.columns)}') from None

    def __getitem__(self, name: str) -> Any:
        return self._column(name)

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def keys(self) -> Iterable[str]:
        """Names of the columns.

        Returns
        -------
        iterable of str
        """
        return self.columns.keys()

    def to_pandas(self) -> Any:
        """The columns as a pandas table.

        Returns
        -------
        pandas.DataFrame
            One row for each row, in SI units.

        Raises
        ------
        ModuleNotFoundError
            If pandas is not installed; it comes with the extra `pandas`.
        """
        return optional("pandas", "pandas").DataFrame(self.columns)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """The columns through the Arrow C interface, as `pyarrow.table`, `polars.DataFrame` and DuckDB take them, if
        `arro3-core` is installed."""
        arrow = optional("arro3.core", "arrow")

        def array(values: NDArray[Any]) -> Any:
            if values.dtype.kind == "U":
                return arrow.Array(values.tolist(), arrow.DataType.utf8())
            # Some columns are those of a matrix.
            return arrow.Array.from_numpy(np.ascontiguousarray(values))

        table = arrow.Table.from_pydict({name: array(values) for name, values in self.columns.items()})
        return table.__arrow_c_stream__(requested_schema)

    def _repr_html_(self) -> str:
        return html(repr(self), self)


def html(title: str, table: Columns) -> str:
    """A table as a notebook shows it: its first and last rows below a title."""
    count = len(table)
    rows = list(range(count))
    if count > _SHOWN:
        half = _SHOWN // 2
        rows = [*range(half), -1, *range(count - half, count)]
    head = "".join(f"<th>{escape(name)}</th>" for name in table)
    body = "".join(
        "<tr>" + "".join(f"<td>{'&#8230;' if row < 0 else _cell(values[row])}</td>" for values in table.columns.values()) + "</tr>"
        for row in rows
    )
    return f"<p>{escape(title)}</p><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


@dataclass(repr=False, eq=False)
class Table(Columns):
    """A result as a table: `table["name"]` is a column, `to_pandas()` all of them.

    Attributes
    ----------
    name : str
        What the rows are.
    columns : dict of str to ndarray
        Arrays of one length, in SI units; NaN where a number is unknown.
    """

    name: str
    columns: dict[str, NDArray[Any]]

    def __repr__(self) -> str:
        return f"Table({self.name!r}, {len(self)} rows, columns {', '.join(self.columns)})"


def table_of_cells(name: str, cells: Sequence[tuple[str, Any]]) -> Table:
    """A table whose columns are bytes of numbers or lists of texts."""

    def column(title: str, values: Any) -> NDArray[Any]:
        if isinstance(values, bytes):
            found = np.frombuffer(values, "<f8")
            return found.astype(np.int64 if title == "pose" else np.float64)
        return np.array(values, dtype=np.str_)

    return Table(name, {title: column(title, values) for title, values in cells})


def table_of_rows(name: str, titles: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> Table:
    """A table of documents with these keys; lists of texts are joined, and null is NaN or empty."""
    rows = list(rows)

    def column(title: str) -> NDArray[Any]:
        values = [row.get(title) for row in rows]
        if any(isinstance(value, (str, list)) for value in values):
            texts = [", ".join(value) if isinstance(value, list) else value or "" for value in values]
            return np.array(texts, dtype=np.str_)
        if values and all(isinstance(value, (bool, int)) for value in values):
            return np.array(values)
        return numbers(values)

    return Table(name, {title: column(title) for title in titles})


class Tabular:
    """A result that is shown as a table in notebooks."""

    def table(self) -> Table:
        """The result as a table.

        Returns
        -------
        Table
            In SI units.
        """
        raise NotImplementedError

    def to_pandas(self) -> Any:
        """`table()` as a pandas table.

        Returns
        -------
        pandas.DataFrame
            In SI units.
        """
        return self.table().to_pandas()

    def _repr_html_(self) -> str:
        return html(repr(self), self.table())
