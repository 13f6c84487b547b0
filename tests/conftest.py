"""Every test runs in double precision; tests on shared records skip where those are absent."""

import os
import time
import zlib
from collections.abc import Iterator
from pathlib import Path

import jax
import pytest

import jaxbacklash as jb

# Where several workers share the machine, each keeps to one core; tests compile more than they compute, like most commands.
jb.start(devices=1 if "PYTEST_XDIST_WORKER" in os.environ else None, brief=True)
jax.config.update("jax_platforms", "cpu")

SHARED = Path(__file__).resolve().parents[2] / "shared"


TURN = Path(__file__).with_name("slow_turn.txt")
THIRDS = 3


def pytest_collection_modifyitems(items):
    """Where the time may be too short for all, the third of the tests whose turn it is (`slow_turn.txt`) begins; see .ci/run."""
    if "JAXBACKLASH_TESTS_UNTIL" in os.environ:
        turn = int(TURN.read_text())
        items.sort(key=lambda item: (zlib.crc32(item.nodeid.encode()) - turn) % THIRDS)
    if SHARED.is_dir():
        return
    skip = pytest.mark.skip(reason="the practice records and measured data are not here (../shared)")
    for item in items:
        if "shared" in item.keywords:
            item.add_marker(skip)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    """No test begins after the time (seconds since the epoch) in JAXBACKLASH_TESTS_UNTIL."""
    until = os.environ.get("JAXBACKLASH_TESTS_UNTIL")
    if until and time.time() > float(until):
        pytest.skip("the time for tests is up")


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of practice records and measured data."""
    return SHARED


@pytest.fixture
def cache(tmp_path: Path) -> Iterator[Path]:
    """An empty cache of compiled programs; the one that the tests share comes back afterwards."""
    before = jax.config.jax_compilation_cache_dir
    jax.config.update("jax_compilation_cache_dir", str(tmp_path))
    yield tmp_path / "programs"
    jax.config.update("jax_compilation_cache_dir", before)
