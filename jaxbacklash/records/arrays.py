"""From the arrays of a binary file to columns: what .npz and .mat files have in common."""

from collections.abc import Collection, Mapping

import numpy as np

from .checks import listed, real_vector, wrong


def as_columns(arrays: Mapping[str, np.ndarray], wanted: Collection[str], where: str) -> dict[str, np.ndarray]:
    """Columns of equal standing from arrays of several shapes.

    Parameters
    ----------
    arrays : mapping of arrays
        Of shape (N,), (N, 1) or (1, N), one per column; or one array of shape (N, C), beside an array `columns` that
        holds the C names. Constants, text and whatever else is no column may stand beside them.
    wanted : collection of str
        Names that must be columns of numbers.
    where : str
        The file, for the sentence.

    Returns
    -------
    dict of arrays of shape (N,), float64
        N may differ between columns that are not wanted.

    Raises
    ------
    BadInput
        When a wanted array is no column, or when the names do not fit the array they belong to.
    """
    columns = {name: real_vector(values, name, where) for name, values in arrays.items() if name in wanted}
    for name, values in arrays.items():
        if name not in columns and values.dtype.kind in "fiub" and _is_column(values):
            columns[name] = real_vector(values, name, where)
    if "columns" in arrays:
        table = _table(arrays, where)
        twice = next((name for name in table if name in columns), None)
        if twice is not None:
            raise wrong(where, f"{twice} both as an array and among the names in columns", "it once")
        columns |= table
    return columns


def _is_column(values: np.ndarray) -> bool:
    """Whether an array is one value per sample; a single value is a constant."""
    return values.size > 1 and (values.ndim == 1 or (values.ndim == 2 and 1 in values.shape))


def _table(arrays: Mapping[str, np.ndarray], where: str) -> dict[str, np.ndarray]:
    """The columns of the one matrix whose names stand in the array `columns`."""
    names = [_text(name) for name in arrays["columns"].ravel()]
    if not all(names):
        raise wrong(f"{where}, array columns", "something other than names", "one name per column of the data")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise wrong(f"{where}, array columns", f'the name "{twice}" more than once', "each name once")
    others = {name: values for name, values in arrays.items() if name != "columns"}
    matrices = {name: values for name, values in others.items() if values.ndim == 2 and not _is_column(values)}
    fitting = {name: values for name, values in matrices.items() if len(names) in values.shape}
    if len(fitting) != 1:
        shapes = [f"{name} {values.shape}" for name, values in matrices.items()]
        found = f"{len(names)} names in columns ({listed(names)}) and the matrices {listed(shapes)}"
        raise wrong(where, found, "one matrix with a column for each name")
    matrix = next(iter(fitting.values()))
    # Samples go down unless only the other way round fits.
    rows = matrix.T if matrix.shape[1] == len(names) else matrix
    return {name: real_vector(values, name, where) for name, values in zip(names, rows, strict=True)}


def _text(name: object) -> str:
    """A name out of an array of text: bytes from C programs, padded or boxed text from MATLAB."""
    while isinstance(name, np.ndarray) and name.size == 1:
        name = name.ravel()[0]
    if isinstance(name, bytes):
        name = name.decode("latin-1")
    return name.strip() if isinstance(name, str) else ""
