"""Kept programs are code: they are run only where nobody but the user can have written them, and nothing foreign is removed."""

import os
import stat
import threading
import time

import jax
import numpy as np
import pytest

from jaxbacklash import program, program_file, read_ahead
from jaxbacklash.compiled import kept_jit
from jaxbacklash.errors import NoAnswer
from jaxbacklash.private_files import is_private_folder, make_private_folder, read_private
from jaxbacklash.program_file import MAGIC, MONTH
from jaxbacklash.read_ahead import reading_ahead

from .hostile import ended, one_sentence, write_record_csv

posix = pytest.mark.skipif(os.name != "posix", reason="owners and modes of files as Unix has them")


def work_of(traced, factor=2.0):
    """A function whose programs are kept under a name that ``factor`` is part of."""

    def work(a, by):
        traced.append(by)
        return a * by

    work.__module__, work.__qualname__ = "jaxbacklash.fitting.work", "work"
    call = kept_jit(work)
    return lambda: float(call(np.ones(()), factor))


def kept(cache):
    return sorted(path for path in cache.iterdir() if path.name.endswith(".program"))


def pipe(path):
    path.unlink()
    os.mkfifo(path)


def link_to(target):
    def change(path):
        path.unlink()
        path.symlink_to(target)

    return change


def moved_and_linked(path):
    os.rename(path, path.with_name("elsewhere"))
    path.symlink_to("elsewhere")


def by_others(path):
    path.chmod(0o666)


def folder(path):
    path.unlink()
    path.mkdir()


def flipped(path):
    text = bytearray(path.read_bytes())
    text[len(text) // 2] ^= 1
    path.write_bytes(text)


@posix
@pytest.mark.parametrize("change", [pipe, link_to("/dev/zero"), moved_and_linked, by_others, folder, flipped])
def test_a_file_that_others_may_have_written_is_not_run(cache, change):
    traced = []
    assert work_of(traced)() == 2.0
    (path,) = kept(cache)
    change(path)
    assert work_of(traced)() == 2.0
    assert traced == [2.0, 2.0]


@posix
@pytest.mark.parametrize("change", [pipe, link_to("/dev/zero"), by_others])
def test_it_is_not_read_ahead_either(cache, change, monkeypatch):
    monkeypatch.setattr(read_ahead, "used", {})
    work_of([])()
    (path,) = kept(cache)
    (cache / "fit.used").write_text(path.name)
    change(path)
    with reading_ahead("fit", cache.parent):
        assert read_ahead.ahead[path.name].result(timeout=20) is None


def test_files_that_were_swapped_are_told_apart(cache):
    traced = []
    assert [work_of(traced, factor)() for factor in (2.0, 3.0)] == [2.0, 3.0]
    one, two = kept(cache)
    first, second = one.read_bytes(), two.read_bytes()
    one.write_bytes(second)
    two.write_bytes(first)
    assert [work_of(traced, factor)() for factor in (2.0, 3.0)] == [2.0, 3.0]
    assert len(traced) == 4


@posix
def test_nothing_is_kept_in_or_read_from_a_folder_that_others_can_write_to(cache):
    traced = []
    work_of(traced)()
    cache.chmod(0o777)
    assert not is_private_folder(cache)
    assert work_of(traced)() == 2.0
    assert work_of(traced, 5.0)() == 5.0
    assert len(traced) == 3
    assert len(kept(cache)) == 1


@posix
def test_folders_and_files_are_made_for_the_user_alone(cache):
    before = os.umask(0)
    try:
        work_of([])()
    finally:
        os.umask(before)
    assert stat.S_IMODE(cache.stat().st_mode) == 0o700
    assert stat.S_IMODE(kept(cache)[0].stat().st_mode) == 0o600


@posix
def test_a_folder_in_one_where_anybody_could_swap_it_is_not_private(tmp_path):
    (tmp_path / "open").mkdir()
    (tmp_path / "open").chmod(0o777)
    assert not make_private_folder(tmp_path / "open" / "cache")
    (tmp_path / "open").chmod(0o1777)  # as /tmp is
    assert make_private_folder(tmp_path / "open" / "cache")


def test_the_purge_takes_old_programs_and_nothing_else(cache):
    make_private_folder(cache)
    mine = {"notes.txt": b"mine", "thesis.program": b"not theirs", "old.used": MAGIC, f"{'a' * 64}.program": MAGIC + b"old"}
    for name, content in mine.items():
        (cache / name).write_bytes(content)
    (cache / "more").mkdir()
    for path in cache.iterdir():
        os.utime(path, times=2 * (time.time() - 2 * MONTH,))
    work_of([])()
    left = {path.name for path in cache.iterdir()}
    assert {"notes.txt", "thesis.program", "old.used", "more"} < left
    assert f"{'a' * 64}.program" not in left


@pytest.mark.parametrize("name", ["../outside.program", "/etc/passwd", "..", "sub/in.program", "x.program.other", "é.program"])
def test_a_list_leads_to_no_other_folder(cache, name):
    make_private_folder(cache)
    (cache / "fit.used").write_text(f"{name}\ngood-one.program\n")
    (cache / "good-one.program").write_bytes(b"")
    with reading_ahead("fit", cache.parent):
        assert list(read_ahead.ahead) == ["good-one.program"]


def test_without_threads_a_command_goes_on(cache, monkeypatch):
    make_private_folder(cache)
    (cache / "fit.used").write_text("good-one.program\n")
    (cache / "good-one.program").write_bytes(b"")

    def none_left(self):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", none_left)
    with reading_ahead("fit", cache.parent):
        assert work_of([])() == 2.0
    assert read_ahead.ahead == {}


def test_a_full_disk_costs_time_only(cache, monkeypatch):
    def full(*args, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(program_file, "write_whole", full)
    assert work_of([])() == 2.0
    assert kept(cache) == []


def test_a_user_without_a_home_has_no_cache(monkeypatch):
    for name in ("JAXBACKLASH_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)

    def homeless():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(program.Path, "home", homeless)
    assert program.cache_folder() is None


@posix
def test_a_shared_cache_is_told_and_not_used(tmp_path, monkeypatch):
    tmp_path.chmod(0o777)
    monkeypatch.setenv("JAXBACKLASH_CACHE", str(tmp_path))
    before = jax.config.jax_compilation_cache_dir
    jax.config.update("jax_compilation_cache_dir", None)
    try:
        with pytest.warns(UserWarning, match="others can write to it"):
            program.start(devices=1)
        assert jax.config.jax_compilation_cache_dir is None
    finally:
        jax.config.update("jax_compilation_cache_dir", before)


@posix
def test_a_pipe_does_not_hold_the_reader(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="not a file that this user alone can write"):
        read_private(tmp_path / "pipe")


@pytest.mark.slow
def test_a_platform_that_is_not_there_is_told(tmp_path):
    write_record_csv(tmp_path / "r.csv")
    code, _, err = ended("fit", "r.csv", "--inertia", "2", cwd=tmp_path, JAX_PLATFORMS="cuda")
    assert code == 2
    assert "JAX_PLATFORMS" in one_sentence(err)


@posix
def test_too_few_threads_are_told_before_the_compiler_aborts(monkeypatch):
    import resource

    monkeypatch.setattr(resource, "getrlimit", lambda which: (7, 7))
    start, begun = threading.Thread.start, []

    def seven(self):
        if len(begun) == 7:
            raise RuntimeError("can't start new thread")
        begun.append(self)
        start(self)

    monkeypatch.setattr(threading.Thread, "start", seven)
    with pytest.raises(NoAnswer, match=r"only 7 more threads \(ulimit -u is 7\)"):
        program._check_threads()
    assert not any(one.is_alive() for one in begun)
