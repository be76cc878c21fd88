"""The recipes of the manual for other formats: each reads the flight that was written in its format."""

import re
import struct

import numpy as np
import pytest

import airball as ab
from conftest import ROOT

pandas = pytest.importorskip("pandas")
PAGE = ROOT / "docs/book/src/how-to/python.md"


@pytest.fixture(scope="module")
def flight(rig):
    return ab.simulate(rig, seed=5, duration=10.0)


def follow(recipe, folder, monkeypatch):
    """Runs a recipe of the page, found by the words of its first line, in a folder; its log."""
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    [block] = [block for block in blocks if block.startswith(f"# {recipe}")]
    monkeypatch.chdir(folder)
    names = {"ab": ab}
    exec(block, names)
    return names["log"]


def assert_same(log, flight, first=0, tolerance=1e-9):
    for read, written in zip(log, flight, strict=True):
        np.testing.assert_allclose(read, written[first:], rtol=0, atol=tolerance)


def test_parquet(flight, tmp_path, monkeypatch):
    pytest.importorskip("pyarrow")
    pandas.DataFrame(dict(zip("tuy", flight, strict=True))).to_parquet(tmp_path / "run.parquet")
    assert_same(follow("Parquet", tmp_path, monkeypatch), flight)


def test_matlab(flight, tmp_path, monkeypatch):
    files = pytest.importorskip("scipy.io")
    files.savemat(tmp_path / "run.mat", dict(zip("tuy", flight, strict=True)), oned_as="column")
    assert_same(follow("MATLAB", tmp_path, monkeypatch), flight)


def ulog(topics):
    """A ULog: for each topic its field and its rows of time, µs, and value."""

    def message(kind, content):
        return struct.pack("<HB", len(content), ord(kind)) + content

    parts = [b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)]
    for name, (field, _) in topics.items():
        parts.append(message("F", f"{name}:uint64_t timestamp;{field};".encode()))
    for number, name in enumerate(topics):
        parts.append(message("A", struct.pack("<BH", 0, number) + name.encode()))
    for number, (_, rows) in enumerate(topics.values()):
        parts += [message("D", struct.pack("<HQf", number, *row)) for row in rows]
    return b"".join(parts)


def test_ulog(flight, tmp_path, monkeypatch):
    pytest.importorskip("pyulog")
    us = np.rint(flight.t * 1e6).astype(int)
    # The motors are commanded a moment before each reading, and not before the first one.
    heights = zip(us, -flight.y / 1000, strict=True)
    motors = zip(us[1:] - 500, flight.u[1:] / 100, strict=True)
    written = ulog({"vehicle_local_position": ("float z", heights), "actuator_motors": ("float[1] control", motors)})
    (tmp_path / "run.ulg").write_bytes(written)
    assert_same(follow("ULog", tmp_path, monkeypatch), flight, first=1, tolerance=1e-4)


def test_ros_bag(flight, tmp_path, monkeypatch):
    pytest.importorskip("rosbags")
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS2_HUMBLE)
    number = types.types["std_msgs/msg/Float64"]
    ns = np.rint(flight.t * 1e9).astype(int)
    with Writer(tmp_path / "run", version=9) as bag:
        topics = [bag.add_connection(name, number.__msgtype__, typestore=types) for name in ("/height", "/duty")]
        for time, height, duty in zip(ns, flight.y / 1000, flight.u, strict=True):
            for topic, value in zip(topics, (height, duty), strict=True):
                bag.write(topic, int(time), types.serialize_cdr(number(value), number.__msgtype__))
    assert_same(follow("ROS", tmp_path, monkeypatch), flight)
