"""Reads NPZ and NPY files: joint positions, or SMPL parameters (AMASS). Bytes in, Recording out.

The layout of an NPZ file, which `/export?format=npz` also writes:

| key | content |
|---|---|
| `positions` | numbers (frames, joints, 3), world |
| `joint_names` | text (joints,) |
| `parents` | integers (joints,), -1 for a root; optional |
| `frame_rate` | Hz |
| `unit` | "m", "cm", "mm", "in", ... or meters per unit; without it, the stature decides |
| `up_axis` | "x", "y" or "z"; "y" without it |

Keys may have any case and separators, and other usual names (`names`, `fps`, `mocap_framerate`,
`kintree_table`, ...; see `keys.py`). If joints have no names, a known joint order is used if
exactly one fits the body (`joint_layouts.py`). Otherwise joints are called `joint_0`, `joint_1`,
..., so that a client can send roles. Angles of a body model are read by `smpl.py`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.errors import Unreadable
from app.formats.common.failures import too_large, unreadable_at
from app.formats.common.joint_trees import in_tree_order, parents_of
from app.formats.common.limits import MAX_JOINTS
from app.formats.common.names import MAX_NAME_LENGTH
from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.common.world_positions import MAX_JOINT_FRAMES
from app.formats.npz.arrays import Archive, numbers, read_npy, texts
from app.formats.npz.gaps import Whole, without_gaps
from app.formats.npz.joint_layouts import layout_of
from app.formats.npz.keys import NamedArrays
from app.formats.npz.smpl import read_smpl
from app.kinedex_error import Place
from app.motion.canonical.units import METERS_PER_UNIT
from app.motion.skeleton.recording import Caution, Recording
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray, IntArray

FRAME_RATES = (0.1, 10_000.0)
"""Hz: the smallest and the largest number that counts as a frame rate."""


def read_npz(content: bytes) -> Recording:
    """Read an NPZ file of positions, or of SMPL parameters.

    Raises Unreadable with the key, frame or joint, and TooLarge.
    """
    arrays = NamedArrays(Archive(content))
    has_parameters = "poses" in arrays or "pose_body" in arrays
    # AMASS keeps the markers from which its poses were computed. The poses are the motion.
    if "positions" in arrays and not (has_parameters and arrays.key("positions") == "markers"):
        return _read_positions(arrays)
    if has_parameters:
        return _read_parameters(arrays)
    found = ", ".join(arrays.keys[:10])
    raise unreadable_at(
        "positions", f"expected an array of positions, or of SMPL poses; found {found}"
    )


def read_npy_positions(content: bytes) -> Recording:
    """Read an NPY file: one array (frames, joints, 3) without names or a frame rate.

    Raises Unreadable with the frame and the joint, and TooLarge.
    """
    whole = without_gaps(_checked_positions(read_npy(content), "array"), None, None)
    skeleton, cautions = _skeleton_of_order(whole.positions)
    return _recording("npy", skeleton, whole, None, cautions=cautions)


def _read_positions(arrays: NamedArrays) -> Recording:
    positions = _checked_positions(arrays.read("positions"), arrays.key("positions"))
    names = _names(arrays, positions.shape[1])
    rate = _frame_rate(arrays)
    whole = without_gaps(positions, names, rate)
    cautions: tuple[Caution, ...] = ()
    if names is None:
        skeleton, cautions = _skeleton_of_order(whole.positions)
    else:
        parents = arrays.numbers("parents")
        key = arrays.key("parents")
        above = parents_of(parents, key, names) if parents is not None else None
        skeleton = _skeleton(names, above, whole.positions)
        cautions = _duplicates(names)
    return _recording(
        "npz",
        skeleton,
        whole,
        rate,
        unit=_unit(arrays),
        up_axis=_up_axis(arrays),
        cautions=cautions,
    )


def _read_parameters(arrays: NamedArrays) -> Recording:
    poses = arrays.numbers("poses")
    if poses is None:
        parts = [arrays.numbers(name) for name in ("root_orient", "pose_body")]
        there = [part.reshape(len(part), -1) for part in parts if part is not None and part.ndim]
        if len(there) < 2 or len(there[0]) != len(there[1]):
            raise unreadable_at("root_orient", "expected as many frames as pose_body has")
        poses = np.concatenate(there, axis=1)
    # Some files have (frames, joints, 3) in place of (frames, 3 joints).
    if poses.ndim == 3 and poses.shape[2] == 3:
        poses = poses.reshape(len(poses), -1)
    if poses.ndim == 2 and len(poses) * 24 > MAX_JOINT_FRAMES:
        raise too_large("poses", f"expected at most {MAX_JOINT_FRAMES} joints times frames")
    trans = arrays.numbers("trans")
    up_axis = _up_axis(arrays)
    recording = read_smpl(
        _checked_numbers(poses, arrays.key("poses")),
        None if trans is None else _checked_numbers(trans, arrays.key("trans")),
        _frame_rate(arrays),
        up_axis or "z",
    )
    return replace(recording, is_up_axis_said=up_axis is not None)


def _checked_positions(array: NDArray[Any] | None, key: str) -> FloatArray:
    """(frames, joints, 3) float32, finite. Raises Unreadable, TooLarge."""
    if array is None or array.ndim != 3 or array.shape[2] != 3:
        shape = "nothing" if array is None else "x".join(map(str, array.shape)) or "one number"
        raise unreadable_at(key, f"expected frames x joints x 3 numbers, found {shape}")
    frames, joints, _ = array.shape
    if joints > MAX_JOINTS or frames * joints > MAX_JOINT_FRAMES:
        limits = f"{MAX_JOINTS} joints and {MAX_JOINT_FRAMES} joints times frames"
        raise too_large(key, f"expected at most {limits}, found {frames} frames x {joints} joints")
    checked = _checked_numbers(numbers(array, key), key, nan=True)
    return np.ascontiguousarray(checked, dtype=np.float32)


def _checked_numbers(array: NDArray[Any], key: str, *, nan: bool = False) -> FloatArray:
    """The same array. Raises Unreadable with the first number beyond MAX_MAGNITUDE.

    nan: whether NaN is accepted; otherwise it is refused too.
    """
    with np.errstate(invalid="ignore"):  # a signaling NaN would give a warning
        # fmax ignores NaN unless all numbers are NaN.
        largest = float(np.fmax.reduce(np.abs(array), axis=None)) if nan else np.inf
        if not largest > MAX_MAGNITUDE:
            return array
    if max(float(array.max()), -float(array.min())) <= MAX_MAGNITUDE and _is_finite(array):
        return array
    # A signaling NaN would give a warning.
    with np.errstate(invalid="ignore"):
        position = np.argwhere(~(np.abs(array.astype(np.float64)) <= MAX_MAGNITUDE))[0]
    where = ", ".join(str(index) for index in position)
    nouns = zip(("frame", "joint"), position[: array.ndim - 1], strict=False)
    location = ", ".join(f"{noun} {index}" for noun, index in nouns)
    limit = f"±{MAX_MAGNITUDE:g}"
    found = array[tuple(position)]
    message = f"expected numbers within {limit}, found {found} at {key}[{where}], counted from 0"
    raise Unreadable(f"{location}: {message}", places=[Place(location or key, message)])


def _is_finite(array: NDArray[Any]) -> bool:
    return array.dtype.kind != "f" or bool(np.isfinite(array).all())


def _names(arrays: NamedArrays, joints: int) -> list[str] | None:
    array = arrays.read("joint_names")
    if array is None:
        return None
    key = arrays.key("joint_names")
    if array.nbytes > 4 * MAX_JOINTS * MAX_NAME_LENGTH:
        raise unreadable_at(key, f"expected names of at most {MAX_NAME_LENGTH} characters")
    names = [name.strip("\0 ") for name in texts(array, key)]
    if len(names) != joints:
        raise unreadable_at(
            key, f"expected {joints} names as positions has joints, found {len(names)}"
        )
    for joint, name in enumerate(names):
        if not name or len(name) > MAX_NAME_LENGTH or not name.isprintable():
            raise unreadable_at(f"joint {joint}", f"expected a name, found {name[:40]!a} in {key}")
    return names


def _duplicates(names: list[str]) -> tuple[Caution, ...]:
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    if not twice:
        return ()
    shown = ", ".join(twice[:5])
    detail = f"several joints have the same name: {shown}"
    return (Caution("duplicate_names", detail, joint=twice[0]),)


def _frame_rate(arrays: NamedArrays) -> float | None:
    array = arrays.numbers("frame_rate")
    if array is None:
        return None
    rate = float(array.reshape(-1)[0]) if array.size == 1 else float("nan")
    if not FRAME_RATES[0] <= rate <= FRAME_RATES[1]:
        raise unreadable_at(
            arrays.key("frame_rate"), f"expected one number of Hz, found {array!s:.40}"
        )
    return rate


def _unit(arrays: NamedArrays) -> float | None:
    array = arrays.read("unit")
    if array is None:
        return None
    key = arrays.key("unit")
    if array.dtype.kind in "US":
        (name, *_) = texts(array, key)
        scale = METERS_PER_UNIT.get(name.strip().lower())
    else:
        scale = float(numbers(array, key).reshape(-1)[0]) if array.size == 1 else None
    if scale is None or not 1e-6 <= scale <= 1e3:
        units = ", ".join(METERS_PER_UNIT)
        raise unreadable_at(
            key, f"expected one of {units}, or meters per unit; found {array!s:.40}"
        )
    return scale


def _up_axis(arrays: NamedArrays) -> str | None:
    array = arrays.read("up_axis")
    if array is None:
        return None
    (name, *_) = texts(array, arrays.key("up_axis"))
    axis = name.strip().lower().removeprefix("+")
    if axis not in ("x", "y", "z"):
        raise unreadable_at(arrays.key("up_axis"), f"expected x, y or z, found {name[:20]!a}")
    return axis


def _skeleton_of_order(positions: FloatArray) -> tuple[Skeleton, tuple[Caution, ...]]:
    layout = layout_of(positions)
    if layout is None:
        names = [f"joint_{joint}" for joint in range(positions.shape[1])]
        detail = "the file has no joint names and no known joint order: send roles by joint_0, ..."
        return _skeleton(names, None, positions), (Caution("joint_names_missing", detail),)
    detail = f"the file has no joint names; the body fits the joint order of {layout.title}"
    parents = np.array(layout.parents)
    return _skeleton(list(layout.names), parents, positions), (
        Caution("joint_names_guessed", detail),
    )


def _skeleton(names: list[str], parents: IntArray | None, positions: FloatArray) -> Skeleton:
    """Joints in the order of the file, whose rest pose is the first frame."""
    above = np.full(len(names), -1) if parents is None else parents
    first = positions[0].astype(np.float64)
    offsets = first - np.where(above[:, None] >= 0, first[above], 0.0)
    return Skeleton(tuple(names), above, offsets)


def _recording(
    format_name: str,
    skeleton: Skeleton,
    whole: Whole,
    frame_rate: float | None,
    *,
    unit: float | None = None,
    up_axis: str | None = None,
    cautions: tuple[Caution, ...] = (),
) -> Recording:
    """A recording in which each joint comes after its parent."""
    order = in_tree_order(skeleton.parents)
    return Recording(
        format=format_name,
        skeleton=Skeleton(
            names=tuple(skeleton.names[joint] for joint in order),
            parents=_renumbered(skeleton.parents, order),
            offsets=skeleton.offsets[order],
        ),
        positions=np.ascontiguousarray(whole.positions[:, order]),
        rotations=None,
        translations=None,
        frame_rate=frame_rate,
        up_axis=up_axis or "y",
        is_up_axis_said=up_axis is not None,
        metres_per_unit=unit,
        cautions=whole.cautions + cautions,
        start_frame=whole.start,
    )


def _renumbered(parents: IntArray, order: IntArray) -> IntArray:
    """(joints,) the parents as indices in the new order; order: (joints,) old indices."""
    # The last element is for the parent -1, which indexes it.
    new_index = np.empty(len(order) + 1, dtype=np.int64)
    new_index[order] = np.arange(len(order))
    new_index[-1] = -1
    return np.asarray(new_index[parents[order]])
