"""A damaged HDF5 file that claims texts of gigabytes takes neither the memory nor the time for them."""

import re
import struct
import subprocess
import sys

import numpy as np
import pytest

from .test_formats import table_of

resource = pytest.importorskip("resource")
h5py = pytest.importorskip("h5py")
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="the limit is kept by Linux only")
READ = """
import resource, sys
from pathlib import Path
from jaxbacklash.errors import BadInput
from jaxbacklash.records.files import read_table
from jaxbacklash.records.options import ReadOptions
try:
    read_table(Path(sys.argv[1]), ReadOptions())
except BadInput as why:
    print(why)
# Linux hands the parent's ru_maxrss on to its child; the kernel's own high-water mark begins anew.
status = Path("/proc/self/status").read_text()
peak = next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM"))
print(peak, resource.getrlimit(resource.RLIMIT_AS)[0])
"""


def good(path):
    with h5py.File(path, "w") as file:
        for name, unit in (("t", "s"), ("x", "deg"), ("z", "deg")):
            file[name] = np.arange(500.0)
            file[name].attrs["unit"] = unit
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    return path


@LINUX
@pytest.mark.parametrize("suffix", [".h5", ".mat"])
@pytest.mark.parametrize("length", [2**32 - 1, 2**31])
def test_the_length_of_a_text_is_not_believed(tmp_path, length, suffix):
    content = bytearray(good(tmp_path / "good.h5").read_bytes())
    # A text stands in a heap; its length (4 bytes) and the heap's address (8 bytes) stand where the text is used.
    place = re.search(re.escape(struct.pack("<Q", content.find(b"GCOL"))), content).start()
    assert struct.unpack("<I", content[place - 4 : place])[0] == 1  # "s"
    content[place - 4 : place] = struct.pack("<I", length)
    path = tmp_path / f"bad{suffix}"
    path.write_bytes(content)
    run = subprocess.run([sys.executable, "-c", READ, path], capture_output=True, text=True, check=True, timeout=60)
    *sentence, told = run.stdout.strip().splitlines()
    peak_kb, limit = map(int, told.split())
    assert peak_kb < 500_000
    assert limit == resource.getrlimit(resource.RLIMIT_AS)[0]
    if suffix == ".h5":
        assert "damaged" in sentence[0]


def test_texts_of_a_good_file_are_read(tmp_path):
    before = resource.getrlimit(resource.RLIMIT_AS)
    assert [column.unit for column in table_of(good(tmp_path / "good.h5")).columns] == ["s", "deg", "deg"]
    assert resource.getrlimit(resource.RLIMIT_AS) == before
