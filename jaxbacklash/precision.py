"""Double precision: needed by the fits, never switched on by an import."""

from __future__ import annotations

import jax


def enable_double_precision() -> None:
    """Switch JAX to float64. Programs call it where they start; importing jaxbacklash does not.

    Examples
    --------
    >>> jb.enable_double_precision()
    """
    jax.config.update("jax_enable_x64", True)


def require_double_precision(what: str) -> None:
    """Refuse to go on in single precision.

    Raises
    ------
    RuntimeError
        JAX is in single precision, whose rounding is larger than an encoder's noise.
    """
    if not jax.config.read("jax_enable_x64"):
        raise RuntimeError(
            f"{what} needs double precision: call jaxbacklash.enable_double_precision() "
            "(or set JAX_ENABLE_X64=1) before the first use of jax"
        )
