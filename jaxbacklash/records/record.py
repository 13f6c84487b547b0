"""A record: what was measured, one value per sample and channel."""

import dataclasses

import numpy as np

from . import checks, time_axis
from .finding import Finding


@dataclasses.dataclass(frozen=True, eq=False)
class Record:
    """A measured motion, sampled evenly, that can be used as it stands.

    Parameters
    ----------
    t : array of shape (N,), s
        Uniform to 1e-6 of a step, or up to the rounding of the numbers; then the even grid takes its place
        (see `time_axis.uniform_grid`).
    channels : dict of arrays of shape (N,)
        By name: x base motion, z = y - x relative motion, y absolute motion (rad or m), F force or torque on the link,
        T force or torque the joint transmits (N or N m); of a drive torque at the motor (N m), or command, the position of the
        link that its servo is told (rad), motor and link its encoders (rad).
        With z and y both given, z is the one observed and y goes to
        the extras.
    path : str
        The file as the user named it; refusals begin with it.
    extras : dict of arrays of shape (N,)
        Further columns, under their own names and unconverted; they may hold NaN or text.
    confirmed : frozenset of str
        Channels (and "t") whose unit the user stated: a size unlikely for radians or seconds is then believed.
    findings : tuple of Finding
        What the reader found odd and warned of; a fit that misses something names these first.
    ratio : float
        Turns of the motor of a drive for a turn of the link; 1 for all other records.
    per_kt : bool
        True where the torque of a drive is its current, of a motor whose torque for an ampere nobody told.

    Raises
    ------
    BadInput
        When the times or channels cannot be used; one sentence says where, what was found and what is wanted.
    """

    t: np.ndarray
    channels: dict[str, np.ndarray]
    path: str = ""
    extras: dict[str, np.ndarray] = dataclasses.field(default_factory=dict)
    confirmed: frozenset[str] = frozenset()
    findings: tuple[Finding, ...] = ()
    ratio: float = 1.0
    per_kt: bool = False

    def __post_init__(self):
        where = self.path or "the record"
        known = checks.DRIVE if {"torque", "command"} & set(self.channels) else checks.CHANNELS
        unknown = [name for name in self.channels if name not in known]
        if unknown:
            wanted = f"{checks.listed(checks.CHANNELS)}, and other columns as extras"
            raise checks.wrong(where, f"the channel {unknown[0]}", wanted)
        t = checks.real_vector(self.t, "t", where)
        channels = {name: checks.real_vector(values, name, where) for name, values in self.channels.items()}
        extras = {name: np.asarray(values) for name, values in self.extras.items()}
        for name, values in (channels | extras).items():
            checks.same_length(values, name, t, where)
        if "z" in channels and "y" in channels:
            extras["y"] = channels.pop("y")
        kind = checks.kind_of(channels, extras, where)
        checks.long_enough(t, where)
        for name, values in {"t": t, **channels}.items():
            checks.finite(values, name, where)
        time_axis.increasing(t, where)
        time_axis.in_seconds(t, self.confirmed, where)
        for name, values in {"t": t, **channels}.items():
            checks.of_computable_size(values, name, where)
        t = time_axis.uniform(t, where)
        checks.lasts_long_enough(t, where)
        # The dataclass is frozen for its users; this is its birth.
        for field, value in (("t", t), ("channels", channels), ("extras", extras)):
            object.__setattr__(self, field, value)
        if self.input_name is not None:
            hint = "; if the base is held still give z alone (free decay)" if kind == "base_motion" else ""
            checks.moving(channels[self.input_name], self.input_name, "input", where, hint)
        for name in self.observed_names:
            checks.moving(channels[name], name, "observed motion or force", where)
        checks.plausible_angles(channels, self.confirmed, where)

    @property
    def samples(self) -> int:
        """Number of samples N."""
        return self.t.size

    @property
    def dt(self) -> float:
        """Time between samples, s."""
        return float((self.t[-1] - self.t[0]) / (self.t.size - 1))

    @property
    def rate_hz(self) -> float:
        """Samples per second, Hz."""
        return 1.0 / self.dt

    @property
    def kind(self) -> str:
        """The experiment: "base_motion", "force", "free_decay", "transmitted" or "drive"."""
        return checks.kind_of(self.channels, self.extras, self.path)

    @property
    def input_name(self) -> str | None:
        """The channel that drives: "x", "F", "torque", "command", or None in a free decay."""
        push = "torque" if "torque" in self.channels else "command"
        return {"base_motion": "x", "transmitted": "x", "force": "F", "free_decay": None, "drive": push}[self.kind]

    @property
    def observed_name(self) -> str:
        """The channel a model must explain: "z", "y" or "T"; of a drive the link's encoder, else the motor's."""
        return next(name for name in ("z", "y", "T", "link", "motor") if name in self.channels)

    @property
    def observed_names(self) -> tuple[str, ...]:
        """All channels a model must explain: several where a drive has an encoder on motor and link."""
        both = tuple(name for name in ("motor", "link") if name in self.channels)
        return both if self.kind == "drive" else (self.observed_name,)

    @property
    def relative(self) -> np.ndarray | None:
        """Motion (N,) of the link against its base, of a drive against the motor behind its gear; None where it is not seen."""
        seen = self.channels
        if "z" in seen:
            return seen["z"]
        if "y" in seen:
            return seen["y"] - seen.get("x", 0.0)
        return seen["link"] - seen["motor"] / self.ratio if {"motor", "link"} <= set(seen) else None

    @property
    def blind(self) -> bool:
        """Whether a drive's motor or link is not seen."""
        return self.kind == "drive" and self.relative is None

    def on_its_base(self) -> "Record":
        """A drive with an encoder on motor and link as its joint sees it: the motor behind its gear is the base motion x, the
        link's angle y. Any other record as it is."""
        if self.kind != "drive" or self.relative is None:
            return self
        seen = {"x": self.channels["motor"] / self.ratio, "y": self.channels["link"]}
        told = self.confirmed | {"t", "x", "y"}
        return dataclasses.replace(self, channels=seen, confirmed=told, ratio=1.0, per_kt=False)

    def between(self, t0: float, t1: float) -> "Record":
        """The samples with t0 <= t <= t1 (s), as a record; refused like any other when too little is left."""
        # Half a thousandth of a step of tolerance: 0.3 must select the sample at 0.30000000000000004.
        slack = 5e-4 * self.dt
        rows = (self.t >= t0 - slack) & (self.t <= t1 + slack)
        if not rows.any():
            found = f"no samples between {checks.number(t0)} s and {checks.number(t1)} s"
            wanted = f"a part of {checks.number(self.t[0])} s to {checks.number(self.t[-1])} s"
            raise checks.wrong(self.path or "the record", found, wanted)
        return dataclasses.replace(
            self,
            t=self.t[rows],
            channels={name: values[rows] for name, values in self.channels.items()},
            extras={name: values[rows] for name, values in self.extras.items()},
        )

    def replace(self, **channels: np.ndarray) -> "Record":
        """A record with these channels (arrays of shape (N,)) in place of, or beside, its own."""
        return dataclasses.replace(self, channels=self.channels | channels)

    def summary(self) -> str:
        """One line for a person."""
        kind = self.kind.replace("_", " ")
        return (
            f"{self.path or 'record'}: {kind}, channels {' '.join(['t', *self.channels])}, {self.samples} samples at "
            f"{checks.number(self.rate_hz)} Hz, {checks.number(self.t[-1] - self.t[0])} s"
        )
