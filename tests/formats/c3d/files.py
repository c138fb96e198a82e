"""Writes C3D files for tests, for each processor, and gives the markers of people."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.kinematics import joints_by_depth
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.rotations import multiply, rotate
from app.numerics.arrays import FloatArray
from tests.people import ROLES, person

PROCESSORS = {"intel": 84, "dec": 85, "mips": 86}
Value = float | int | str | Sequence[float] | Sequence[int] | Sequence[str]


class Writer:
    """Numbers in a processor's bytes."""

    def __init__(self, processor: str) -> None:
        self.processor = processor
        self.ends = ">" if processor == "mips" else "<"

    def integers(self, values: object) -> bytes:
        return np.asarray(values).astype(f"{self.ends}i2").tobytes()

    def floats(self, values: object) -> bytes:
        array = np.asarray(values, dtype=np.float32).ravel()
        if self.processor != "dec":
            return array.astype(f"{self.ends}f4").tobytes()
        halves = (array * np.float32(4)).astype("<f4").view("<u2").reshape(-1, 2)
        return np.ascontiguousarray(halves[:, ::-1]).tobytes()

    def parameter(self, group: int, name: str, value: Value) -> bytes:
        kind, shape, raw = self.value(value)
        body = struct.pack("bB", kind, len(shape)) + bytes(shape) + raw + b"\x00"
        offset = self.integers([len(body) + 2])
        return struct.pack("bb", len(name), group) + name.encode() + offset + body

    def value(self, value: Value) -> tuple[int, list[int], bytes]:
        if isinstance(value, str):
            return -1, [len(value)], value.encode("latin-1")
        if isinstance(value, (int, float)):
            raw = self.floats([value]) if isinstance(value, float) else self.integers([value])
            return (4 if isinstance(value, float) else 2), [], raw
        if value and isinstance(value[0], str):
            width = max(1, *(len(str(text)) for text in value))
            texts = "".join(str(text).ljust(width) for text in value)
            return -1, [width, len(value)], texts.encode("latin-1")
        if value and isinstance(value[0], float):
            return 4, [len(value)], self.floats(value)
        return 2, [len(value)], self.integers(value)

    def group(self, number: int, name: str) -> bytes:
        return struct.pack("bb", len(name), -number) + name.encode() + self.integers([3]) + b"\x00"


def c3d(
    positions: FloatArray,
    labels: Sequence[str],
    *,
    processor: str = "intel",
    scale: float = -1.0,
    rate: float = 100.0,
    analog: int = 0,
    first: int = 1,
    parameters: Mapping[str, Value] | None = None,
    last: int | None = None,
    header_analog: int | None = None,
    end_mark: bool = True,
) -> bytes:
    """A C3D file of positions (frames, points, 3); NaN is written as residual -1.

    parameters: by "GROUP:NAME", over those that every file has; scale: positive for integers.
    header_analog: written in place of the true number. end_mark: whether the parameters end with
    one; without it, other bytes follow their blocks.
    """
    frames, points = positions.shape[:2]
    writer = Writer(processor)
    written: dict[str, Value] = {"POINT:USED": points, "POINT:FRAMES": min(frames, 32767)}
    written |= {"POINT:SCALE": float(scale), "POINT:RATE": float(rate), "POINT:UNITS": "mm"}
    written |= {"POINT:LABELS": list(labels[:255])} if len(labels) else {}
    written |= {"POINT:LABELS2": list(labels[255:])} if len(labels) > 255 else {}
    written |= parameters or {}
    names = list(dict.fromkeys(name.split(":")[0] for name in written))
    section = b"".join(writer.group(i, name) for i, name in enumerate(names, 1))
    for name, value in written.items():
        if value is not None:
            group, _, own = name.partition(":")
            section += writer.parameter(names.index(group) + 1, own, value)
    blocks = (len(section) + 4 + 512) // 512
    data_block = 2 + blocks
    section = bytes([1, 80, blocks, PROCESSORS[processor]]) + section
    if not end_mark:
        # The last parameter fills the blocks, and what follows is no parameter.
        name = b"\x04" + bytes([len(names)]) + b"FILL"
        section += name + writer.integers([512 * blocks - len(section) - 6]) + b"\x02\x00\x07\x00"
        section = section.ljust(512 * blocks, b"\x00") + b"CCCC" * 128
        data_block += 1
    end = first + frames - 1 if last is None else last
    words = [points, analog if header_analog is None else header_analog, first, min(end, 65535), 10]
    header = bytes([2, 80]) + np.array(words).astype(f"{writer.ends}u2").tobytes()
    header += writer.floats([scale]) + writer.integers([data_block, 0]) + writer.floats([rate])
    return (
        header.ljust(512, b"\x00")
        + section.ljust(512 * blocks, b"\x00")
        + _data(writer, positions, scale, analog)
    )


def _data(writer: Writer, positions: FloatArray, scale: float, analog: int) -> bytes:
    frames, points = positions.shape[:2]
    hidden = np.isnan(positions).any(axis=-1)
    values = np.zeros((frames, points, 4))
    values[..., :3] = np.where(hidden[..., None], 0, positions)
    values[..., 3] = np.where(hidden, -1, 0)
    if scale > 0:
        values[..., :3] = np.round(values[..., :3] / scale)
    rows = np.concatenate([values.reshape(frames, -1), np.full((frames, analog), 7)], axis=1)
    return writer.integers(rows) if scale > 0 else writer.floats(rows)


R = JointRole
PLUG_IN_GAIT: dict[str, tuple[JointRole, tuple[float, float, float]]] = {
    "LASI": (R.HIPS, (0.12, 0, 0.1)), "RASI": (R.HIPS, (-0.12, 0, 0.1)),
    "LPSI": (R.HIPS, (0.05, 0, -0.1)), "RPSI": (R.HIPS, (-0.05, 0, -0.1)),
    "C7": (R.NECK, (0, 0, -0.06)), "CLAV": (R.NECK, (0, 0, 0.06)),
    "STRN": (R.CHEST, (0, 0, 0.1)), "T10": (R.CHEST, (0, 0, -0.1)),
    "LFHD": (R.HEAD, (0.07, 0, 0.08)), "RFHD": (R.HEAD, (-0.07, 0, 0.08)),
    "LBHD": (R.HEAD, (0.07, 0, -0.08)), "RBHD": (R.HEAD, (-0.07, 0, -0.08)),
    "LSHO": (R.LEFT_SHOULDER, (0, 0, 0)), "RSHO": (R.RIGHT_SHOULDER, (0, 0, 0)),
    "LUPA": (R.LEFT_SHOULDER, (0.15, 0, 0.05)), "RBAK": (R.CHEST, (-0.1, 0.1, -0.1)),
    "LELB": (R.LEFT_ELBOW, (0, 0.04, 0)), "RELB": (R.RIGHT_ELBOW, (0, 0.04, 0)),
    "LELM": (R.LEFT_ELBOW, (0, -0.04, 0)), "RELM": (R.RIGHT_ELBOW, (0, -0.04, 0)),
    "LWRA": (R.LEFT_HAND, (0, 0, 0.03)), "RWRA": (R.RIGHT_HAND, (0, 0, 0.03)),
    "LWRB": (R.LEFT_HAND, (0, 0, -0.03)), "RWRB": (R.RIGHT_HAND, (0, 0, -0.03)),
    "LKNE": (R.LEFT_KNEE, (0.05, 0, 0)), "RKNE": (R.RIGHT_KNEE, (-0.05, 0, 0)),
    "LKNM": (R.LEFT_KNEE, (-0.05, 0, 0)), "RKNM": (R.RIGHT_KNEE, (0.05, 0, 0)),
    "LTHI": (R.LEFT_UPPER_LEG, (0.1, -0.2, 0)), "RTIB": (R.RIGHT_KNEE, (-0.05, -0.2, 0)),
    "LANK": (R.LEFT_FOOT, (0.04, 0, 0)), "RANK": (R.RIGHT_FOOT, (-0.04, 0, 0)),
    "LANM": (R.LEFT_FOOT, (-0.04, 0, 0)), "RANM": (R.RIGHT_FOOT, (0.04, 0, 0)),
    "LHEE": (R.LEFT_FOOT, (0, -0.05, -0.08)), "RHEE": (R.RIGHT_FOOT, (0, -0.05, -0.08)),
    "LTOE": (R.LEFT_TOES, (0, 0, 0)), "RTOE": (R.RIGHT_TOES, (0, 0, 0)),
}  # fmt: skip
"""The markers of each joint of the person, and their offsets from the joint in meters."""


def markers_of(recording: Recording) -> dict[str, FloatArray]:
    """Tracks (frames, 3) of the person's markers, millimeters, Z up."""
    skeleton = recording.skeleton
    assert recording.rotations is not None
    turned = recording.rotations.astype(np.float64)
    for joints in joints_by_depth(skeleton.parents)[1:]:
        turned[:, joints] = multiply(turned[:, skeleton.parents[joints]], turned[:, joints])
    tracks = {}
    for name, (role, offset) in PLUG_IN_GAIT.items():
        joint = ROLES.index(role)
        track = recording.positions[:, joint] + rotate(turned[:, joint], np.array(offset))
        tracks[name] = 1000 * track[:, [0, 2, 1]] * [1, -1, 1]
    return tracks


def stacked(tracks: Mapping[str, FloatArray]) -> tuple[FloatArray, list[str]]:
    """Positions (frames, markers, 3) and labels."""
    return np.stack(list(tracks.values()), axis=1), list(tracks)


def marker_person(frames: int = 60, seed: int = 0) -> tuple[dict[str, FloatArray], FloatArray]:
    """The swaying person's markers, and true positions (frames, roles, 3) in meters."""
    recording = person(frames=frames, seed=seed)
    return markers_of(recording), recording.positions
