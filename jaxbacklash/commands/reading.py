"""How files are read, as the user said on the command line: the same options for every command that reads a record.

`reads` gives a command these options; the command gets them as one `Reading`. Nothing heavy is imported before a file is read.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import BadInput

if TYPE_CHECKING:
    from ..records import MeasuredSeries, Record
    from ..records.options import ReadOptions

Texts = list[str] | None


@dataclasses.dataclass(frozen=True)
class Reading:
    """The options as they were typed."""

    columns: Annotated[
        Texts, typer.Option("--columns", help="Which column is which: t=time_s,x=enc1,z=#4; a name with a comma in quotes")
    ] = None
    unit: Annotated[Texts, typer.Option("--unit", help="Convert a channel to SI: x=deg or x=deg,t=ms")] = None
    scale: Annotated[Texts, typer.Option("--scale", help="Multiply a channel: F=35.15")] = None
    resample: Annotated[
        bool, typer.Option("--resample", help="Bring uneven times to an even grid, bridge short gaps, at the record's own rate")
    ] = False
    resample_rate: Annotated[float | None, typer.Option("--resample-rate", help="The same at this rate [Hz]")] = None
    rate: Annotated[
        float | None, typer.Option("--rate", help="Samples per second [Hz], where the file has no times or only such of writing")
    ] = None
    skip: Annotated[int, typer.Option("--skip", help="Lines at the beginning of a text file to pass over")] = 0
    decimal: Annotated[str | None, typer.Option("--decimal", help='Decimal mark of a text file: "." or ","')] = None
    unwrap: Annotated[Texts, typer.Option("--unwrap", help="Channels whose jumps by a turn are undone: x or x,y")] = None
    ratio: Annotated[float | None, typer.Option("--ratio", help="Turns of x, or of the motor, for a turn of the link")] = None
    kt: Annotated[float | None, typer.Option("--kt", help="Torque of a drive's motor for an ampere [N m/A]")] = None
    sign: Annotated[Texts, typer.Option("--sign", help="Channels measured the other way round: y or F")] = None
    despike: Annotated[Texts, typer.Option("--despike", help="Channels from which single bad samples are taken: z or x,z")] = None
    accept: Annotated[
        Texts, typer.Option("--accept", help="Findings that are right as they are, by the names that refusals give: wrap,gear")
    ] = None
    start: Annotated[float | None, typer.Option("--from", help="Use the record from this time on [s]")] = None
    stop: Annotated[float | None, typer.Option("--to", help="Use the record up to this time [s]")] = None

    def options(self) -> ReadOptions:
        """The options understood.

        Raises
        ------
        BadInput
            When one of them cannot be.
        """
        from ..records import parse_channels, parse_columns, parse_scales, parse_units
        from ..records.findings.rules import RULES
        from ..records.options import ReadOptions

        if self.resample_rate is not None and not 0.0 < self.resample_rate < float("inf"):
            raise BadInput(f"--resample-rate {self.resample_rate:g}: wanted a positive number of samples per second.")
        accepted = frozenset(name.strip() for text in self.accept or [] for name in text.split(",") if name.strip())
        unknown = sorted(accepted - set(RULES))
        if unknown:
            raise BadInput(f"--accept {unknown[0]}: found no such finding, wanted one of {', '.join(RULES)}.")
        chosen = {name: getattr(self, name) or [] for name in ("unwrap", "sign", "despike")}
        return ReadOptions(
            columns=parse_columns(self.columns) if self.columns else {},
            units=parse_units(self.unit) if self.unit else {},
            scales=parse_scales(self.scale) if self.scale else {},
            resample=self.resample_rate or self.resample or None,
            rate=self.rate,
            skip=self.skip,
            ratio=self.ratio,
            decimal=self.decimal,
            start=self.start,
            stop=self.stop,
            accept=accepted,
            kt=self.kt,
            **{name: parse_channels(texts, f"--{name}") if texts else frozenset() for name, texts in chosen.items()},
        )

    def typed(self) -> tuple[str, ...]:
        """The options as words of a command."""
        words: list[str] = []
        for field in dataclasses.fields(self):
            option = _OPTIONS[field.name]
            given = getattr(self, field.name)
            if given is True:
                words.append(option)
            elif given not in (None, False, 0):
                words += [word for value in (given if isinstance(given, list) else [given]) for word in (option, f"{value}")]
        return tuple(words)

    def record(self, path: Path) -> Record:
        """The record in a file."""
        from ..records.files import read_table
        from ..records.reader import record_of

        options = self.options()
        return record_of(read_table(path, options), options, str(path))

    def series(self, path: Path, channel: str | None) -> MeasuredSeries:
        """One channel of a table."""
        from ..records.files import read_table
        from ..records.measured_series import series_of

        options = self.options()
        return series_of(read_table(path, options), channel, options, str(path))


_OPTIONS = {
    # typer takes the first word of an annotation's Option for its default until the parameter has one.
    name: parameter.annotation.__metadata__[0].default
    for name, parameter in inspect.signature(Reading, eval_str=True).parameters.items()
}

AS_IT_IS = Reading()
"""A file that says all by itself."""


def reads(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of `Reading` in the place of its parameter ``reading``.

    Examples
    --------
    >>> @reads
    ... def fit(record: str, reading: Reading) -> None: ...
    >>> "--unwrap" in str(inspect.signature(fit))
    True
    """
    fields = dataclasses.fields(Reading)
    hints = inspect.signature(Reading, eval_str=True).parameters
    own = inspect.signature(command, eval_str=True)
    parameters: list[inspect.Parameter] = []
    for parameter in own.parameters.values():
        if parameter.name != "reading":
            parameters.append(parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY))
            continue
        parameters += [hints[field.name].replace(kind=inspect.Parameter.KEYWORD_ONLY) for field in fields]

    @functools.wraps(command)
    def called(**given: Any) -> None:
        others = {name: value for name, value in given.items() if name in own.parameters}
        command(**others, reading=Reading(**{field.name: given[field.name] for field in fields}))

    called.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
    called.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return called
