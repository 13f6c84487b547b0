"""The good record in formats other than text, each written by its own library."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from scipy import io

from tests.odd_files.draft import READ, SAID, Draft
from tests.odd_files.kinds import kind, pick

ALL = "container time names marks tail bytes head units"


def arrays(draft: Draft) -> dict[str, np.ndarray]:
    """The columns by name."""
    return {column.name: column.values for column in draft.columns}


@kind(ALL, library="openpyxl")
def workbook(draft: Draft, rng) -> None:
    """An Excel sheet, perhaps with a title above the table or another sheet behind it."""
    title, second = pick(rng, [], [["Rig 4", "2024-03-05"], []]), pick(rng, False, True)

    def write(draft: Draft, path: Path) -> None:
        import openpyxl

        book = openpyxl.Workbook()
        sheet = book.active
        for row in [*title, list(arrays(draft)), *np.column_stack(list(arrays(draft).values())).tolist()]:
            sheet.append(row)
        if second:
            book.create_sheet("notes").append(["operator", "lab"])
        book.save(path)

    draft.writer, draft.suffix = write, ".xlsx"


@kind(ALL)
def json_text(draft: Draft, rng) -> None:
    """JSON: arrays by name, a list of rows with names, names and a matrix, or within a field."""
    shape = int(rng.integers(4))

    def write(draft: Draft, path: Path) -> None:
        lists = {name: np.asarray(values).tolist() for name, values in arrays(draft).items()}
        rows = [list(row) for row in zip(*lists.values(), strict=True)]
        whole = (
            lists,
            [dict(zip(lists, row, strict=True)) for row in rows],
            {"columns": list(lists), "data": rows},
            {"meta": {"rig": 4}, "data": lists},
        )[shape]
        path.write_text(json.dumps(whole))

    draft.writer, draft.suffix = write, ".json"
    if shape == 3:
        draft.expect(SAID, r"data[./]t")


@kind(ALL)
def numpy_array(draft: Draft, rng) -> None:
    """A .npy: with names, or a bare matrix whose columns go by number."""
    named = pick(rng, True, False)

    def write(draft: Draft, path: Path) -> None:
        table = arrays(draft)
        matrix = np.column_stack(list(table.values()))
        if named:
            matrix = np.rec.fromarrays(list(table.values()), names=",".join(table))
        np.save(path, matrix)

    draft.writer, draft.suffix = write, ".npy"
    if not named:
        draft.said_columns = draft.numbered()


@kind(ALL)
def numpy_archive(draft: Draft, rng) -> None:
    """A .npz, compressed or not."""
    save = pick(rng, np.savez, np.savez_compressed)
    draft.writer, draft.suffix = (lambda draft, path: save(path, **arrays(draft))), ".npz"


@kind(ALL)
def matlab(draft: Draft, rng) -> None:
    """MATLAB's: vectors, or a structure that holds them."""
    nested = pick(rng, True, False)

    def write(draft: Draft, path: Path) -> None:
        io.savemat(path, {"log": arrays(draft)} if nested else arrays(draft))

    draft.writer, draft.suffix = write, ".mat"
    if nested:
        draft.said_columns = {column.channel or "": f"log.{column.name}" for column in draft.columns}
        draft.expect(SAID, r"log[./]")


@kind(ALL, library="h5py")
def hdf5(draft: Draft, rng) -> None:
    """HDF5, its vectors at the root or in a group."""
    group = pick(rng, "", "run1/")

    def write(draft: Draft, path: Path) -> None:
        import h5py

        with h5py.File(path, "w") as file:
            for name, values in arrays(draft).items():
                file[group + name] = values

    draft.writer, draft.suffix = write, pick(rng, ".h5", ".hdf5")
    if group:
        draft.said_columns = {column.channel or "": group + column.name for column in draft.columns}


@kind(ALL, library="nptdms")
def tdms(draft: Draft, rng) -> None:
    """National Instruments': a group of channels, times as a channel or as the waveform's step."""
    timed = pick(rng, True, False)
    step = float(draft.column("t").values[1])

    def write(draft: Draft, path: Path) -> None:
        from nptdms import ChannelObject, TdmsWriter

        channels = [column for column in draft.columns if timed or column.channel != "t"]
        properties = {} if timed else {"wf_increment": step, "wf_start_offset": 0.0}
        with TdmsWriter(path) as writer:
            writer.write_segment([ChannelObject("log", each.name, each.values, properties=properties) for each in channels])

    draft.writer, draft.suffix = write, ".tdms"
    draft.said_columns = {
        column.channel or "": f"log/{column.name}" for column in draft.columns if timed or column.channel != "t"
    }


@kind(ALL, library="asammdf")
def measurement_data_format(draft: Draft, rng) -> None:
    """ASAM MDF 4: channels with their common master clock."""
    unit = pick(rng, "rad", "")

    def write(draft: Draft, path: Path) -> None:
        from asammdf import MDF, Signal

        table = arrays(draft)
        times = table.pop("t")
        with MDF(version="4.10") as file:
            file.append([Signal(values, times, unit=unit, name=name) for name, values in table.items()])
            file.save(path, overwrite=True)

    draft.writer, draft.suffix = write, ".mf4"
    draft.expect(READ)


@kind(ALL, library="pyuff")
def universal_file(draft: Draft, rng) -> None:
    """Universal file format, data set 58, as text or binary."""
    binary = int(pick(rng, 0, 1))
    step = float(draft.column("t").values[1])

    def write(draft: Draft, path: Path) -> None:
        import pyuff

        file = pyuff.UFF(str(path))
        for node, column in enumerate((each for each in draft.columns if each.channel != "t"), 1):
            file.write_sets(
                pyuff.prepare_58(
                    binary=binary, func_type=1, rsp_node=node, rsp_dir=1, ref_node=0, ref_dir=0, data=column.values,
                    x=step * np.arange(column.values.size), id1=column.name, rsp_ent_name=column.name, abscissa_spacing=1,
                    abscissa_inc=step, abscissa_min=0.0, ord_data_type=4,
                    num_pts=column.values.size, z_axis_value=0.0, orddenom_spec_data_type=0,
                ),
                mode="add",
            )  # fmt: skip

    draft.writer, draft.suffix = write, pick(rng, ".uff", ".unv")
    draft.expect(SAID, r"\bx\b|--columns")
