"""Compiled programs are found by the next process, and only where they are the same."""

from __future__ import annotations

import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxbacklash.compiled as compiled
import jaxbacklash.read_ahead as read_ahead
from jaxbacklash.compiled import kept_jit
from jaxbacklash.effects import Gravity
from jaxbacklash.mechanics import AbstractEffect
from jaxbacklash.read_ahead import reading_ahead
from jaxbacklash.sharing import sharing


def process(traced: list[str]):
    """The same function as a process of its own would see it: nothing in memory."""

    def work(thing, a, b, power):
        traced.append("traced")
        scale = thing.G if isinstance(thing, AbstractEffect) else 1.0
        return {"sum": scale * jnp.sum(a**power), "b": b, "word": "kept"}

    work.__module__, work.__qualname__ = "jaxbacklash.fitting.work", "work"
    return kept_jit(work)


def test_the_next_process_does_not_trace(cache):
    traced: list[str] = []
    effect = Gravity(G=jnp.asarray(3.0))
    for a in (np.arange(4.0), np.arange(4.0) + 1.0):
        found = process(traced)(effect, a, None, 2)
        assert found["sum"] == pytest.approx(3.0 * np.sum(a**2))
        assert found["word"] == "kept"
        assert found["b"] is None
    assert traced == ["traced"]
    assert len(list(cache.iterdir())) == 1


def test_a_program_does_not_say_where_in_the_source_it_came_from(cache):
    call = process([])
    with jax.named_scope("where_it_came_from"):
        call(None, np.arange(4.0), None, 2)
    text = next(iter(call.programs.values())).result().call.as_text()
    assert "multiply" in text
    assert "op_name" not in text


def test_what_computes_for_long_is_compiled_for_that(cache, monkeypatch):
    asked, compile_it = [], jax.stages.Lowered.compile
    monkeypatch.setattr(jax.stages.Lowered, "compile", lambda self, how=None: (asked.append(how), compile_it(self, how))[1])
    call = kept_jit(lambda a, steps: a + 1.0, lambda a, steps: steps > 10)
    assert [float(call(np.zeros(()), steps)) for steps in (3, 30)] == [1.0, 1.0]
    assert asked == [None, compiled.LASTING]


@pytest.mark.parametrize("kept", [True, False])
def test_what_computes_for_long_is_so_compiled_where_it_is_not_kept_too(cache, monkeypatch, kept):
    """A user's own law, or a machine without a cache."""
    if not kept:
        jax.config.update("jax_compilation_cache_dir", None)
    asked, jit = [], eqx.filter_jit
    monkeypatch.setattr(eqx, "filter_jit", lambda f, **how: jit(lambda *args: (asked.append(how), f(*args))[1], **how))
    call = kept_jit(lambda law, a: a + 1.0, lambda law, a: a.size > 1)
    own = type("Own", (eqx.Module,), {})()
    assert [np.sum(call(own, np.zeros(n))) for n in (1, 2)] == [1.0, 2.0]
    assert asked == [{}, {"compiler_options": compiled.LASTING}]
    assert np.sum(jax.jit(lambda a: call(own, a))(np.zeros(2))) == 2.0  # within another program it may not say so


@pytest.mark.parametrize("committed", [False, True])
def test_what_came_out_of_a_program_goes_in_without_another(cache, committed):
    call = process([])
    a = np.arange(4.0)
    found = call(None, a, a, 2)["b"]
    again = call(None, jax.device_put(found, jax.devices()[-1]) if committed else found, a, 2)
    assert again["sum"] == pytest.approx(14.0)
    assert len(call.programs) == 1


@pytest.mark.parametrize("other", [
    (None, np.arange(5.0), None, 2), (None, np.arange(4), None, 2), (None, np.arange(4.0), None, 3),
    (None, np.arange(4.0), np.zeros(2), 2), (Gravity(G=jnp.asarray(1.0)), np.arange(4.0), None, 2),
])  # fmt: skip
def test_another_shape_kind_structure_or_fixed_part_is_another_program(cache, other):
    traced: list[str] = []
    process(traced)(None, np.arange(4.0), None, 2)
    process(traced)(*other)
    assert len(traced) == 2


def slow(traced: list[str], fails: list[BaseException]):
    """As `process`, for a function that takes a while to trace, and may raise then."""

    def work(a):
        traced.append("traced")
        time.sleep(0.2)
        if fails:
            raise fails.pop()
        return jnp.sum(a)

    work.__module__ = "jaxbacklash.fitting.work"
    return kept_jit(work)


def test_a_process_holds_so_many_programs_and_reads_the_others_again(cache, monkeypatch):
    monkeypatch.setattr(compiled, "MOST", 3)
    traced: list[str] = []
    work = process(traced)
    for size in (2, 3, 4, 2, 5, 6):
        work(None, np.arange(float(size)), None, 2)
    assert len(work.programs) <= compiled.MOST + 1
    count = len(traced)
    assert float(work(None, np.arange(2.0), None, 2)["sum"]) == 1.0  # it was used again, later than those of 3 and 4
    assert float(work(None, np.arange(3.0), None, 2)["sum"]) == 5.0  # its turn was over: it comes from its file
    assert len(traced) == count


def test_threads_that_ask_for_the_same_program_make_it_once(cache):
    traced: list[str] = []
    call = slow(traced, [])
    with ThreadPoolExecutor(2) as threads:
        ahead = threads.submit(call.ready, np.arange(4.0))
        found = [threads.submit(call, np.arange(4.0)) for _ in range(3)]
        assert [float(one.result()) for one in found] == [6.0] * 3
    assert ahead.result() is None
    assert traced == ["traced"]


def test_what_is_fetched_is_read_if_it_is_kept_and_not_made_if_it_is_not(cache):
    traced: list[str] = []
    a = np.arange(4.0)
    first = process(traced)
    first.fetch(None, a, None, 2)
    assert not first.programs
    assert not traced
    first(None, a, None, 2)
    second = process(traced)
    second.fetch(None, a, None, 2)
    assert len(second.programs) == 1
    assert second(None, a, None, 2)["sum"] == pytest.approx(14.0)
    assert traced == ["traced"]


def test_a_program_that_could_not_be_made_is_asked_for_again(cache):
    traced: list[str] = []
    call = slow(traced, [KeyboardInterrupt()])
    with pytest.raises(KeyboardInterrupt):
        call(np.arange(4.0))
    assert float(call(np.arange(4.0))) == 6.0
    assert traced == ["traced", "traced"]


def test_where_an_array_stands_matters(cache):
    def difference(a, b):
        return -a if b is None else b

    difference.__module__ = "jaxbacklash.fitting.difference"
    assert kept_jit(difference)(np.ones(2), None)[0] == -1.0
    assert kept_jit(difference)(None, np.ones(2))[0] == 1.0


def test_a_law_of_ones_own_is_never_taken_from_a_file(cache):
    def law(factor):
        class AbstractOwn(AbstractEffect):  # no other test is to find it in the catalogue
            def torque(self, now):
                return factor * now

        return AbstractOwn()

    def work(effect, a):
        return effect.torque(a)

    for factor in (1.0, 2.0):
        assert kept_jit(work)(law(factor), np.ones(3))[0] == factor
    assert not cache.exists()


def test_changed_source_or_versions_are_another_program(cache, monkeypatch):
    traced: list[str] = []
    process(traced)(None, np.arange(4.0), None, 2)
    monkeypatch.setattr(compiled, "_setting", lambda: "another version")
    process(traced)(None, np.arange(4.0), None, 2)
    assert len(traced) == 2


@pytest.mark.parametrize("damage", [lambda text: b"", lambda text: text[: len(text) // 2], lambda text: b"x" * len(text)])
def test_a_damaged_file_is_made_anew(cache, damage):
    traced: list[str] = []
    expected = process(traced)(None, np.arange(4.0), None, 2)["sum"]
    (path,) = cache.iterdir()
    path.write_bytes(damage(path.read_bytes()))
    assert process(traced)(None, np.arange(4.0), None, 2)["sum"] == expected
    assert len(traced) == 2
    process(traced)(None, np.arange(4.0), None, 2)
    assert len(traced) == 2


def test_without_a_cache_and_within_a_trace_it_is_a_jit(cache):
    traced: list[str] = []
    work = process(traced)
    inside = eqx.filter_jit(lambda a: work(None, a, None, 2)["sum"])(jnp.arange(3.0))
    assert inside == 5.0
    assert not cache.exists()
    jax.config.update("jax_compilation_cache_dir", None)
    assert process(traced)(None, np.arange(3.0), None, 2)["sum"] == 5.0
    assert not cache.exists()


def test_linear_algebra_and_several_devices_come_back(cache):
    def solve(matrix, right):
        cores = jax.sharding.Mesh(np.asarray(sharing()), ("cores",))
        share = jax.sharding.PartitionSpec()
        spread = jax.shard_map(lambda a: a + jax.lax.axis_index("cores") * 0.0, mesh=cores, in_specs=share, out_specs=share,
                               check_vma=False)  # fmt: skip
        return jnp.linalg.solve(spread(matrix), right), jnp.linalg.cholesky(matrix)

    solve.__module__ = "jaxbacklash.fitting.solve"
    matrix, right = np.array([[2.0, 1.0], [1.0, 3.0]]), np.array([1.0, 2.0])
    first, again = kept_jit(solve)(matrix, right), kept_jit(solve)(matrix, right)
    np.testing.assert_array_equal(first[0], again[0])
    np.testing.assert_allclose(matrix @ np.asarray(again[0]), right, rtol=1e-14)
    np.testing.assert_allclose(np.asarray(again[1]) @ np.asarray(again[1]).T, matrix, rtol=1e-14)


FRESH = """
import numpy as np
import jax.numpy as jnp
import jaxbacklash
from jaxbacklash.compiled import kept_jit

jaxbacklash.start(devices=2)
traced = []

def work(matrix, right):
    traced.append(1)
    return jnp.linalg.solve(jnp.linalg.cholesky(matrix), right)

work.__module__ = "jaxbacklash.fitting.work"
print(*np.asarray(kept_jit(work)(np.array([[4.0, 2.0], [2.0, 2.0]]), np.array([2.0, 2.0]))), len(traced))
"""


def test_a_fresh_process_runs_what_another_compiled(tmp_path, monkeypatch):
    monkeypatch.setenv("JAXBACKLASH_CACHE", str(tmp_path))

    def told() -> str:
        return subprocess.run([sys.executable, "-c", FRESH], capture_output=True, text=True, check=True).stdout

    # LAPACK's routines are looked up when a call of them is lowered, which the second process does not do.
    assert [told(), told()] == ["1.0 1.0 1\n", "1.0 1.0 0\n"]
    # A program out of JAX's own cache cannot be written down once more without losing some of its code.
    for path in (tmp_path / "programs").glob("*.program"):
        path.unlink()
    assert any(tmp_path.glob("*-cache"))
    assert [told(), told()] == ["1.0 1.0 1\n", "1.0 1.0 0\n"]


def test_a_program_whose_turn_has_not_come_is_read_at_once(cache, nothing_used, monkeypatch):
    cache.mkdir()
    calls = {size: process([]) for size in (3, 4)}
    with reading_ahead("fit", cache.parent):
        for size, call in calls.items():
            call(None, np.arange(float(size)), None, 2)
    first, last = (next(made.result() for made in call.programs.values()).name for call in calls.values())
    read, begun = read_ahead.program_file.read, []

    def slowly(path):
        begun.append(path.name)
        if path.name == first:
            time.sleep(0.5)
        return read(path)

    monkeypatch.setattr(read_ahead.program_file, "read", slowly)
    with reading_ahead("fit", cache.parent):
        while not begun:
            time.sleep(0.001)
        assert process([])(None, np.arange(4.0), None, 2)["sum"] == pytest.approx(14.0)
        assert not read_ahead.ahead[first].done()
        assert read_ahead.ahead[last].cancelled()


@pytest.fixture
def nothing_used(monkeypatch):
    """As at the start of a process."""
    monkeypatch.setattr(read_ahead, "used", {})
    monkeypatch.setattr(read_ahead, "used_aside", {})


def test_what_a_command_used_is_read_before_it_is_asked_for_again(cache, nothing_used):
    traced: list[str] = []
    cache.mkdir()
    a = np.arange(4.0)
    with reading_ahead("fit", cache.parent):
        process(traced)(None, a, None, 2)
    name = next(cache.glob("*.program")).name
    assert (cache / "fit.used").read_text().split() == [name]

    call = process(traced)
    with reading_ahead("fit", cache.parent):
        ready = read_ahead.ahead[name].result()
        found = call(None, a, None, 2)["sum"]
        (program,) = (made.result() for made in call.programs.values())
        assert program.call is ready
    assert found == pytest.approx(14.0)
    assert traced == ["traced"]
    assert read_ahead.ahead == {}


def test_what_the_main_thread_waits_for_is_read_first(cache, nothing_used):
    cache.mkdir()
    calls = {size: process([]) for size in (3, 4, 5)}
    with reading_ahead("fit", cache.parent):
        with ThreadPoolExecutor(1) as aside:
            aside.submit(calls[3], None, np.arange(3.0), None, 2).result()
            aside.submit(calls[4].ready, None, np.arange(4.0), None, 2).result()
            aside.submit(calls[5].ready, None, np.arange(5.0), None, 2).result()
        calls[5](None, np.arange(5.0), None, 2)
    names = {size: next(made.result() for made in call.programs.values()).name for size, call in calls.items()}
    # The one that was never called is not worth reading.
    assert (cache / "fit.used").read_text().split() == [names[5], names[3]]


@pytest.mark.parametrize("broken", [b"", b"half a pro", b"\x80\x04garbage"])
def test_what_cannot_be_read_ahead_is_made_anew(cache, nothing_used, broken):
    traced: list[str] = []
    a = np.arange(4.0)
    process(traced)(None, a, None, 2)
    (kept,) = cache.iterdir()
    kept.write_bytes(broken)
    (cache / "fit.used").write_text(f"{kept.name}\nnone-of-that-name.program\n")
    with reading_ahead("fit", cache.parent):
        assert process(traced)(None, a, None, 2)["sum"] == pytest.approx(14.0)
    assert traced == ["traced", "traced"]
    (cache / "fit.used").write_bytes(b"\xff\xfe\x00")
    with reading_ahead("fit", cache.parent):
        assert read_ahead.ahead == {}


def test_a_command_that_ends_early_leaves_the_list_as_it_was(cache, nothing_used):
    cache.mkdir()
    names = [f"{number}.program" for number in range(50)]
    (cache / "fit.used").write_text("\n".join(names))
    with pytest.raises(ValueError, match="wrong column"), reading_ahead("fit", cache.parent):
        raise ValueError("wrong column")
    assert read_ahead.ahead == {}
    assert (cache / "fit.used").read_text().split() == names
    with reading_ahead("fit", None):  # no cache
        pass
