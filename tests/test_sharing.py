"""A computation that is dealt out goes on whatever other threads compute meanwhile."""

import subprocess
import sys

import pytest

DEVICES = """
import jax
import jaxbacklash
from jaxbacklash.sharing import sharing

jaxbacklash.start(cache=False, devices={devices})
print(len(sharing()), jax.devices()[0] in sharing())
"""

BUSY = """
import itertools
import threading

import jax
import jax.numpy as jnp
import numpy as np

import jaxbacklash
from jaxbacklash.shooting.chunks import CHUNK, by_chunks

jaxbacklash.start(cache=False, devices=2)
dealt = jax.jit(lambda shared, lead: by_chunks(lambda s, a: jnp.sin(a @ s) @ s.T, shared, lead, len(lead)))
shared, lead = np.full((40, 40), 1e-3), np.ones((4 * CHUNK, 40, 40))
expected = np.asarray(dealt(shared, lead))
done = threading.Event()


def one_by_one():
    while not done.is_set():
        last = jnp.asarray(np.ones(3000))
        for _ in range(60):  # begun one after the other, without waiting
            last = last * 1.0001 + 0.1
        np.asarray(last)


aside = [threading.Thread(target=one_by_one, daemon=True) for _ in range(2)]
for thread in aside:
    thread.start()
for turn in itertools.count():
    if turn == 400:
        break
    np.testing.assert_array_equal(np.asarray(dealt(shared, lead)), expected)
done.set()
for thread in aside:
    thread.join()
print("done")
"""


def told(text: str, seconds: float) -> list[str]:
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=seconds, check=True)
    return done.stdout.split()


@pytest.mark.parametrize(("devices", "shared", "with_default"), [(1, "1", "True"), (2, "2", "False"), (3, "3", "False")])
def test_what_is_dealt_out_keeps_off_the_default_device(devices, shared, with_default):
    assert told(DEVICES.format(devices=devices), 60.0) == [shared, with_default]


def test_a_shared_computation_never_waits_for_other_threads_for_good():
    """On the default device it came to a stop within the first hundred turns: those had taken all that it may run at a time."""
    assert told(BUSY, 240.0) == ["done"]
