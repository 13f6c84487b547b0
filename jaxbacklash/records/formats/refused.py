"""Formats that no reader here takes: a sentence for each that says how to get the record out of it."""

from __future__ import annotations

import shlex
import zipfile
from pathlib import Path

from ..checks import listed, wrong
from ..table import Table

OLD_EXCEL = "the workbook saved as .xlsx without a password, or the sheet as .csv"
SCOPE = "the measurement saved as .csv by the oscilloscope or its program"

WAYS_OUT: dict[str, tuple[str, str]] = {
    ".xls": ("an Excel workbook of the old binary kind, or one with a password", OLD_EXCEL),
    ".xlsb": ("an Excel workbook of the binary kind", OLD_EXCEL),
    ".ods": ("an OpenDocument sheet", "the sheet saved as .xlsx or .csv"),
    ".parquet": ("a Parquet file", "a .csv file: {python}"),
    ".feather": ("a Feather file", "a .csv file: {python}"),
    ".pkl": ("a pickle, which runs code when it is read", "the arrays saved with numpy.savez, or as .csv"),
    ".mldatx": (
        "a Simulink project or log",
        "signals exported in MATLAB with: writetimetable(extractTimetable(data), 'run.csv')",
    ),
    ".slx": ("a Simulink model", "the record that it made"),
    ".zip": ("a zip archive", "the file in it: {unzip}"),
    ".wfm": ("an oscilloscope's own file", SCOPE),
    ".isf": ("an oscilloscope's own file", SCOPE),
    ".trc": ("an oscilloscope's own file", SCOPE),
}
"""What a file of a suffix is and what is wanted instead."""
WAYS_OUT |= {suffix: WAYS_OUT[".pkl"] for suffix in (".pickle", ".joblib")} | {".arrow": WAYS_OUT[".feather"]}


def refuse(suffix: str, path: Path, decimal: str | None = None) -> Table:
    """Raise the sentence for a file of a kind in `WAYS_OUT`."""
    found, wanted = WAYS_OUT[suffix]
    name = shlex.quote(str(path))
    call = "parquet" if suffix == ".parquet" else "feather"
    python = f"import pandas, sys; pandas.read_{call}(sys.argv[1]).to_csv(sys.argv[2], index=False)"
    target = shlex.quote(str(path.with_suffix(".csv")))
    if suffix == ".zip":
        found += f" with {listed(_members(path), limit=3)}"
    raise wrong(str(path), found, wanted.format(python=f"python -c {shlex.quote(python)} {name} {target}", unzip=f"unzip {name}"))


def _members(path: Path) -> list[str]:
    """What is in the archive, as far as it can be listed."""
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError):
        return []
