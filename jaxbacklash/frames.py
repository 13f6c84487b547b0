"""Numbers with their names and units, as pandas and xarray have them, where those are installed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np

from .errors import BadInput


def needed(library: str, for_what: str, extra: str = "frames") -> Any:
    """A library that does not come with the package.

    Raises
    ------
    BadInput
        It is not installed: one sentence says how to get it.
    """
    try:
        return import_module(library)
    except ImportError:
        raise BadInput(
            f'{for_what} needs {library.partition(".")[0]}, which is not installed: pip install "jaxbacklash[{extra}]"'
        ) from None


def dataframe(
    columns: Mapping[str, Any], index: str | Sequence[str] | None = None, *, units: Mapping[str, str] | None = None, **about: Any
) -> Any:
    """A `pandas.DataFrame`.

    Parameters
    ----------
    columns : by name, (N,) each; None is a number that is not known
    index : the column, or columns, that name the rows
    units : of columns, kept in the frame's ``attrs``
    about : whatever else is to be kept there

    Raises
    ------
    BadInput
        pandas is not installed.
    """
    pandas = needed("pandas", "a DataFrame")
    frame = pandas.DataFrame(dict(columns))
    if index is not None:
        frame = frame.set_index(index if isinstance(index, str) else list(index))
    frame.attrs.update(about | ({"units": dict(units)} if units else {}))
    return frame


def dataset(variables: Mapping[str, tuple[Any, Any, str]], coordinates: Mapping[str, tuple[Any, str]], **about: Any) -> Any:
    """An `xarray.Dataset`.

    Parameters
    ----------
    variables : by name, dimensions, values and unit
    coordinates : by name, which is also their dimension's, values and unit
    about : attributes of the whole

    Raises
    ------
    BadInput
        xarray is not installed.
    """
    xarray = needed("xarray", "a Dataset")
    return xarray.Dataset(
        {name: (dims, np.asarray(values), {"units": unit}) for name, (dims, values, unit) in variables.items()},
        {name: (name, np.asarray(values), {"units": unit}) for name, (values, unit) in coordinates.items()},
        about,
    )


def known(values: Sequence[float | None]) -> np.ndarray:
    """Numbers of which some may be None, as floats: NaN where there is none."""
    return np.array([np.nan if value is None else value for value in values], dtype=float)
