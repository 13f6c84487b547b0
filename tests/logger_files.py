"""The same short record as loggers, spreadsheets and robots write it: each file by its own library, for tests of the readers."""

import json
from pathlib import Path

import numpy as np

RATE = 200.0


def course(samples: int = 400) -> dict[str, np.ndarray]:
    """Times and two motions [s, deg, deg], rounded to what any format keeps."""
    t = np.arange(samples) / RATE
    return {"t": t, "x": np.round(2.0 * np.sin(9 * t), 6), "z": np.round(0.5 * np.cos(9 * t), 6)}


def write_tdms(path: Path, table: dict[str, np.ndarray]) -> None:
    from nptdms import ChannelObject, TdmsWriter

    wave = {"wf_increment": float(table["t"][1]), "wf_start_offset": 0.0, "wf_start_time": np.datetime64("2024-05-01T10:00:00")}
    with TdmsWriter(path) as file:
        file.write_segment([ChannelObject("Log", name, table[name], wave | {"unit_string": "deg"}) for name in ("x", "z")])


def write_mdf(path: Path, table: dict[str, np.ndarray]) -> None:
    from asammdf import MDF, Signal

    with MDF(version="3.30" if path.suffix == ".mdf" else "4.10") as file:
        signals = [Signal(table[name], table["t"], name=name, unit="deg") for name in ("x", "z")]
        file.append(signals, common_timebase=True)
        file.save(path, overwrite=True)


def write_uff(path: Path, table: dict[str, np.ndarray], binary: int = 0, even: int = 1, function: int = 1) -> None:
    import pyuff

    sets = []
    for name in ("x", "z"):
        none = {f"id{number}": "NONE" for number in range(1, 6)} | {"rsp_ent_name": "NONE", "ref_ent_name": "NONE"}
        kinds = {"ordinate_spec_data_type": 8, "orddenom_spec_data_type": 0, "z_axis_spec_data_type": 0}
        places = {"rsp_node": 1, "rsp_dir": 4, "ref_dir": 0, "ref_node": 0, "load_case_id": 0}
        one = pyuff.prepare_58(
            binary=binary, func_type=function, data=table[name], x=table["t"], abscissa_spacing=even, abscissa_spec_data_type=17,
            **none, **kinds, **places,
        )  # fmt: skip
        labels = {"abscissa_axis_lab": "Time", "abscissa_axis_units_lab": "s", "ordinate_axis_units_lab": "deg"}
        sets.append(one | labels | {"ordinate_axis_lab": name})
    pyuff.UFF(str(path)).write_sets(sets, "add")


def write_xlsx(path: Path, table: dict[str, np.ndarray]) -> None:
    from openpyxl import Workbook

    book = Workbook()
    book.active.append(["t [s]", "x [deg]", "z [deg]"])
    for row in zip(*table.values(), strict=True):
        book.active.append([float(value) for value in row])
    book.save(path)


def write_json(path: Path, table: dict[str, np.ndarray]) -> None:
    path.write_text(json.dumps({name: values.tolist() for name, values in table.items()} | {"units": {"x": "deg", "z": "deg"}}))


def write_hdf5(path: Path, table: dict[str, np.ndarray]) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        for name, values in table.items():
            file[f"run/{name}"] = values
            file[f"run/{name}"].attrs["units"] = "s" if name == "t" else "deg"


def write_bag(path: Path, table: dict[str, np.ndarray]) -> None:
    """A ROS 1 bag, or the one file of a ROS 2 bag by its suffix (.db3, .mcap): joint states of joints "x" and "z"."""
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_typestore

    first = path.suffix == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if first else Stores.ROS2_HUMBLE)
    kinds = store.types
    header, stamp, states = (
        kinds["std_msgs/msg/Header"],
        kinds["builtin_interfaces/msg/Time"],
        kinds["sensor_msgs/msg/JointState"],
    )
    folder = path.parent / f"folder of {path.name}"
    storage = StoragePlugin.SQLITE3 if path.suffix == ".db3" else StoragePlugin.MCAP
    with Writer1(path) if first else Writer2(folder, version=9, storage_plugin=storage) as bag:
        topic = bag.add_connection("/joint_states", states.__msgtype__, typestore=store)
        for row in range(table["t"].size):
            time = 1_700_000_000_000_000_000 + round(1e9 * table["t"][row])
            extra = {"seq": row} if first else {}
            head = header(stamp=stamp(sec=time // 10**9, nanosec=time % 10**9), frame_id="rig", **extra)
            position = np.radians([table["x"][row], table["z"][row]])
            message = states(header=head, name=["x", "z"], position=position, velocity=np.zeros(0), effort=np.zeros(0))
            data = (store.serialize_ros1 if first else store.serialize_cdr)(message, states.__msgtype__)
            bag.write(topic, time + 1000 * (row % 7), data)
    if not first:
        (folder / f"{folder.name}{path.suffix}").rename(path)


def write_mcap_json(path: Path, table: dict[str, np.ndarray]) -> None:
    from mcap.writer import Writer

    with open(path, "wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("rig", "jsonschema", b'{"type": "object"}')
        topic = writer.register_channel("/rig", "json", schema)
        for t, x, z in zip(*table.values(), strict=True):
            time = 10**18 + round(1e9 * t)
            data = json.dumps({"x": np.radians(x), "state": {"z": np.radians(z)}}).encode()
            writer.add_message(topic, log_time=time, publish_time=time, data=data)
        writer.finish()


def write_wav(path: Path, table: dict[str, np.ndarray]) -> None:
    from scipy.io import wavfile

    wavfile.write(path, round(1 / table["t"][1]), np.column_stack([table["x"], table["z"]]))


WRITERS = {
    "rec.tdms": write_tdms,
    "rec.mf4": write_mdf,
    "rec.mdf": write_mdf,
    "rec.uff": write_uff,
    "rec.unv": lambda path, table: write_uff(path, table, binary=1),
    "rec.xlsx": write_xlsx,
    "rec.json": write_json,
    "rec.h5": write_hdf5,
    "rec.bag": write_bag,
    "rec.db3": write_bag,
    "rec.mcap": write_bag,
    "json.mcap": write_mcap_json,
    "rec.wav": write_wav,
}
"""A writer for each file name."""

NAMED = {
    "rec.bag": ("joint_states/x/position", "joint_states/z/position"),
    "json.mcap": ("rig/x", "rig/state/z"),
    "rec.wav": ("channel 1", "channel 2"),
    "rec.xlsx": ("x [deg]", "z [deg]"),
}
NAMED |= dict.fromkeys(("rec.db3", "rec.mcap"), NAMED["rec.bag"])
"""What x and z are called in a file, where not by these names."""

RADIANS = frozenset(("rec.bag", "rec.db3", "rec.mcap", "json.mcap"))
UNITLESS = RADIANS | {"rec.wav"}
