"""What a user's law must be for a fit to use it, checked before there is a fit: by tracing it once, and by a few numbers.

A law is traced by JAX: its numbers are not known while its Python runs. Where that is forgotten JAX raises errors about tracers;
here they are turned into the line of the law and what to write there instead.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..effects import Contact, Damper
from ..errors import BadInput
from ..mechanics import AbstractEffect, Drive, Play, canonical_name
from ..parameters import Spec, ravel, specs, unravel
from ..system import System
from .law_errors import line_in, named

PORTS = ("joint", "ground", "motor")
UNKNOWN = "numbers that are not known while the law is compiled"
METHODS = ("torque", "dry", "rate", "start", "reshape", "drift", "rubs", "observe", "lag")
"""What a law may override, all of it traced."""
MOMENTS = np.array([  # t [s], y, dy, x, dx [rad, rad/s]: on both sides of the play, in it, fast and slow; the last one at rest
    [0.13, 0.031, 0.9, 0.004, -0.3], [0.77, -0.027, -1.7, 0.006, 0.2], [1.9, 0.003, 0.11, 0.001, 0.05],
    [3.1, -0.002, -0.4, 0.003, 0.7], [4.7, 0.026, -0.06, -0.01, -0.5], [0.0, 0.0, 0.0, 0.0, 0.0],
])  # fmt: skip


def check_law(cls: type[AbstractEffect], path: Path, where: str) -> None:
    """Refuse a law that cannot be traced, or is no finite number at ordinary moments.

    Parameters
    ----------
    cls : the user's class
    path : the file that it is from
    where : how sentences begin

    Raises
    ------
    BadInput
        Naming line, law and remedy.
    """
    law = f"law {canonical_name(cls)}"
    _check_declaration(cls, f"{where}: {law}")
    joint = System(1.0, Contact(0.02, 1000.0, 1e-3), Damper(1.0))
    effect = _asked(lambda: _start(cls, joint), cls, "guesses", path, where)
    if not isinstance(effect, cls):
        raise BadInput(f"{where}: {law}: guesses gives {type(effect).__name__}, wanted a list of {cls.__name__}")
    for field, value in _own_values(effect):
        if np.shape(value) != () or not np.isfinite(float(value)):
            raise BadInput(f"{where}: {law}: parameter {field} starts at {value!r}, wanted a finite number")
    own = [name for name in METHODS if getattr(cls, name) is not getattr(AbstractEffect, name)]
    if not own:
        raise BadInput(f"{where}: {law}: changes nothing, wanted one of the methods {', '.join(METHODS)}")
    for method in own:
        _trace(effect, joint, method, path, where)
    _evaluate(effect, joint, own, path, where)


def _check_declaration(cls: type[AbstractEffect], law: str) -> None:
    """Class attributes and the descriptions of the parameters."""
    if cls.port not in PORTS:
        raise BadInput(f'{law}: port is {cls.port!r}, wanted "joint", "ground" or "motor"')
    if not isinstance(cls.states, tuple) or not all(isinstance(name, str) and name.isidentifier() for name in cls.states):
        raise BadInput(f'{law}: states is {cls.states!r}, wanted a tuple of names such as ("s",)')
    for field in dataclasses.fields(cls):
        spec = field.metadata.get("spec")
        if field.metadata.get("static", False):
            continue
        if not isinstance(spec, Spec):
            wanted = f'{field.name}: float = param(unit="N m", null=0.0)'
            raise BadInput(f"{law}: {field.name} is not declared as a parameter, wanted {wanted}")
        words = {"unit": spec.unit, "label": spec.label}
        for name, text in words.items():
            if not isinstance(text, str) or not text.isprintable():
                raise BadInput(f"{law}: parameter {field.name} has {name} {text!r}, wanted printable text on one line")
        numbers = {"lower": spec.lower, "upper": spec.upper, "null": spec.null, "scale": spec.scale}
        for name, value in numbers.items():
            is_number = isinstance(value, int | float | np.number) and not isinstance(value, bool) and not math.isnan(value)
            if value is not None and not is_number:
                raise BadInput(f"{law}: parameter {field.name} has {name} {value!r}, wanted a number")
        if not spec.lower < spec.upper:
            found = f"lower {spec.lower:g} and upper {spec.upper:g}"
            raise BadInput(f"{law}: parameter {field.name} has {found}, wanted lower < upper")
        if spec.null is not None and not spec.lower <= spec.null <= spec.upper:
            raise BadInput(f"{law}: parameter {field.name} has null {spec.null:g}, wanted it within lower and upper")
        if spec.scale is not None and not 0.0 < spec.scale < math.inf:
            raise BadInput(f"{law}: parameter {field.name} has scale {spec.scale:g}, wanted a number above 0")


def _start(cls: type[AbstractEffect], joint: System) -> Any:
    return cls.guesses(joint)[0]


def _own_values(effect: AbstractEffect) -> list[tuple[str, Any]]:
    return [(f.name, getattr(effect, f.name)) for f in dataclasses.fields(effect) if "spec" in f.metadata]


def _call(effect: AbstractEffect, joint: System, method: str, numbers: Any) -> Any:
    """What a method gives at one moment: ``numbers`` t, y, dy, x, dx."""
    t, y, dy, x, dx = (numbers[i] for i in range(5))
    hidden = tuple(jnp.zeros_like(y) for _ in effect.states)
    now = joint.instant(t, (y, dy), Drive(x, dx, jnp.zeros_like(y), jnp.zeros_like(y)), None).seen_by(hidden)
    play = Play(joint.contact.backlash)  # type: ignore[union-attr]
    seen = (now.z, hidden) if hidden else (now.z,)
    arguments = {"reshape": (play, t, x), "drift": (t,), "rubs": (t,), "observe": seen, "lag": (t,)}
    return getattr(effect, method)(*arguments.get(method, (now,)))


def _trace(effect: AbstractEffect, joint: System, method: str, path: Path, where: str) -> None:
    """Run a method without numbers, as a fit does, and look at what it gives."""
    given: list[Any] = []

    def traced(vector: Any, numbers: Any) -> Any:
        given.append(_call(unravel(effect, vector), joint, method, numbers))
        return 0.0

    cls = type(effect)
    _asked(lambda: jax.eval_shape(traced, ravel(effect), MOMENTS[0]), cls, method, path, where)
    found, place = given[-1], f"{where}{_first_line(cls, method, path)}: law {canonical_name(cls)}, {method}"
    if method in ("rate", "start"):
        count = len(cls.states)
        if not isinstance(found, tuple) or len(found) != count:
            raise BadInput(f"{place}: gives {_what(found)}, wanted a tuple of {count} numbers, one for each name in states")
        parts: tuple[Any, ...] = found
    elif method == "reshape":
        if not isinstance(found, Play):
            raise BadInput(f"{place}: gives {_what(found)}, wanted a jaxbacklash.mechanics.Play")
        parts = (found.backlash, found.centre)
    else:
        parts = () if method == "lag" and found is None else (found,)
    for part in parts:
        if not _is_number(part):
            raise BadInput(f"{place}: gives {_what(part)}, wanted one real number; return it from every path through the method")


def _is_number(value: Any) -> bool:
    if isinstance(value, bool):
        return False
    if isinstance(value, int | float):
        return True
    return getattr(value, "shape", None) == () and np.dtype(getattr(value, "dtype", object)).kind in "fiu"


def _what(value: Any) -> str:
    if hasattr(value, "shape") and hasattr(value, "dtype"):
        kinds = {"c": "a complex number", "b": "True or False", "f": "a number", "i": "a number", "u": "a number"}
        kind = kinds.get(np.dtype(value.dtype).kind, "text")
        return f"an array of shape {tuple(value.shape)}" if value.shape else kind
    return "nothing (None)" if value is None else f"{type(value).__name__} {str(value)[:40]!r}"


def _evaluate(effect: AbstractEffect, joint: System, methods: list[str], path: Path, where: str) -> None:
    """Values, and derivatives with respect to the parameters, must be finite: at moments of ordinary size, and values at rest."""

    def flat(vector: Any, numbers: Any, method: str) -> Any:
        found = _call(unravel(effect, vector), joint, method, numbers)
        parts = (found.backlash, found.centre) if isinstance(found, Play) else found
        return jnp.stack([jnp.asarray(part, dtype=float) for part in jax.tree.leaves(parts)] or [jnp.zeros(())])

    @jax.jit
    def both(vector: Any) -> Any:
        values = {m: jax.vmap(lambda now, m=m: flat(vector, now, m))(MOMENTS) for m in methods}
        slopes = {m: jax.vmap(lambda now, m=m: jax.jacfwd(flat)(vector, now, m))(MOMENTS[:-1]) for m in methods}
        return values, slopes

    cls, vector = type(effect), ravel(effect)
    values, slopes = _asked(lambda: both(vector), cls, methods[0], path, where)
    for method in methods:
        place = f"{where}{_first_line(cls, method, path)}: law {canonical_name(cls)}, {method}"
        bad = np.flatnonzero(~np.isfinite(np.asarray(values[method])).all(axis=1))
        if bad.size:
            value = next(v for v in np.asarray(values[method])[bad[0]] if not np.isfinite(v))
            found = f"is {value} {_moment(bad[0])}"
            raise BadInput(f"{place}: {found}, wanted a finite number at every moment; guard roots and divisions with jnp.where")
        slope = np.asarray(slopes[method])
        if slope.size and not np.isfinite(slope).all():
            _, _, k = np.argwhere(~np.isfinite(slope))[0]
            name = list(specs(effect))[k]
            found = f"its derivative with respect to {name} is not finite at {name} = {vector[k]:g}"
            raise BadInput(f"{place}: {found}, wanted a law that is smooth there; guard roots and powers with jnp.where")


def _moment(k: Any) -> str:
    if k == len(MOMENTS) - 1:
        return "at rest (all motion 0)"
    t, y, dy, x, dx = MOMENTS[k]
    return f"at t = {t:g} s, z = {y - x:g} rad, dz = {dy - dx:g} rad/s"


def _asked(ask: Callable[[], Any], cls: type, method: str, path: Path, where: str) -> Any:
    """What ``ask`` gives; whatever it raises becomes a sentence."""
    try:
        return ask()
    except BadInput:
        raise
    except BaseException as error:
        line = line_in(error, path) or _first_line(cls, method, path)
        law = f"law {canonical_name(cls)}, {method}"
        raise BadInput(f"{where}{line}: {law}: {_remedy(error)}") from None


def _remedy(error: BaseException) -> str:
    if isinstance(error, jax.errors.TracerBoolConversionError):
        return (
            f"decides with if, and, or, not, min or max on {UNKNOWN}; use jnp.where(condition, a, b) instead of if, "
            "jnp.minimum and jnp.maximum (import jax.numpy as jnp)"
        )
    if isinstance(error, jax.errors.TracerArrayConversionError):
        return f"calls numpy with {UNKNOWN}; use jax.numpy instead (import jax.numpy as jnp)"
    if isinstance(error, jax.errors.TracerIntegerConversionError):
        return f"takes for an index or a count {UNKNOWN}; use jnp.take or jnp.where"
    if isinstance(error, jax.errors.ConcretizationTypeError):
        return (
            f"makes plain numbers, with math, float(), int() or .item(), of {UNKNOWN}; "
            "use jax.numpy (import jax.numpy as jnp): jnp.sin for math.sin"
        )
    if isinstance(error, SystemExit | KeyboardInterrupt | GeneratorExit):
        return f"tries to end the program ({type(error).__name__}), wanted a number"
    return f"fails with {named(error)}; correct that line"


def _first_line(cls: type, method: str, path: Path) -> str:
    code = getattr(getattr(getattr(cls, method, None), "__func__", getattr(cls, method, None)), "__code__", None)
    return f", line {code.co_firstlineno}" if code is not None and code.co_filename == str(path) else ""
