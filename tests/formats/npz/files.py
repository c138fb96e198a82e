"""Writes NPZ and NPY files for tests, from arrays, or with wrong declared sizes."""

from __future__ import annotations

import io
import zipfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.motion.skeleton.recording import Recording
from tests.people import CONVENTIONS, person


def npy(array: Any, *, allow_pickle: bool = False) -> bytes:
    file = io.BytesIO()
    np.save(file, array, allow_pickle=allow_pickle)
    return file.getvalue()


def npz(*, compressed: bool = False, **arrays: Any) -> bytes:
    file = io.BytesIO()
    (np.savez_compressed if compressed else np.savez)(file, **arrays)
    return file.getvalue()


def zipped(members: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return file.getvalue()


def lying_npy(descr: str, shape: str, data: bytes = b"\0" * 24, fortran: str = "False") -> bytes:
    """An NPY file with any header."""
    header = f"{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n"
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode() + data


def a_person() -> Recording:
    return person(CONVENTIONS["MotionBuilder"])


def person_arrays(recording: Recording) -> dict[str, NDArray[Any]]:
    """The documented layout."""
    return {
        "positions": recording.positions,
        "joint_names": np.array(recording.skeleton.names),
        "parents": recording.skeleton.parents,
        "frame_rate": np.float64(30.0),
        "unit": np.str_("m"),
        "up_axis": np.str_("y"),
    }
