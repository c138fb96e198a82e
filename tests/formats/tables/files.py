"""Writes the tables of Motive, Nexus and Qualisys for tests."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.numerics.arrays import FloatArray


def number_text(number: float, hidden: str = "") -> str:
    return hidden if np.isnan(number) else f"{number:.6f}"


def motive(
    positions: FloatArray,
    names: Sequence[str],
    *,
    kind: str = "Marker",
    version: str = "1.23",
    unit: str = "Meters",
    space: str = "Global",
    rate: float = 120.0,
    parents: bool = False,
) -> bytes:
    """A CSV file of Motive. Bones have a rotation before their position."""
    frames, points = positions.shape[:2]
    turned = kind == "Bone"
    axes = [*"XYZW", *"XYZ"] if turned else [*"XYZ"]
    kinds = (["Rotation"] * 4 if turned else []) + ["Position"] * 3
    extra = [] if turned or kind == "Marker" else ["Mean Marker Error"]
    each = len(axes) + len(extra)
    head = (
        f"Format Version,{version},Take Name,Walk,Capture Frame Rate,{rate:f},Export Frame Rate,"
        f"{rate:f},Total Exported Frames,{frames},Rotation Type,Quaternion,Length Units,{unit},"
        f"Coordinate Space,{space}"
    )
    lines = [head, ""]
    lines.append(",".join(("", "Type", *[kind] * (each * points))))
    lines.append(",".join(("", "Name", *[name for name in names for _ in range(each)])))
    lines.append(",".join(("", "ID", *["1A2B"] * (each * points))))
    if parents:
        lines.append(",".join(("", "Parent", *["0"] * (each * points))))
    lines.append(",".join(("", "", *[*kinds, *extra] * points)))
    lines.append(",".join(("Frame", "Time (Seconds)", *[*axes, *["" for _ in extra]] * points)))
    for frame, row in enumerate(positions):
        cells = [str(frame), f"{frame / rate:.6f}"]
        for point in row:
            turn = ["0.0", "0.0", "0.0", "1.0"] if turned else []
            cells += [*turn, *(number_text(number) for number in point), *["0.0002" for _ in extra]]
        lines.append(",".join(cells))
    return ("\r\n".join(lines) + "\r\n").encode()


def nexus(
    positions: FloatArray,
    labels: Sequence[str],
    *,
    subject: str = "Ada",
    rate: float = 100.0,
    devices: bool = False,
    units: bool = True,
    separator: str = ",",
) -> bytes:
    """A CSV file of Nexus; without `units` as Workstation writes it."""
    lines = []
    if devices:
        lines += ["Devices", "1000", ",,Force", "Frame,Sub Frame,Fx", ",,N", "1,0,2.5", ""]
    lines += ["Trajectories" if units else "TRAJECTORIES", f"{rate:g}" if units else f"{rate:g},Hz"]
    leading = ["Frame", "Sub Frame"] if units else ["Field #"]
    named = [cell for label in labels for cell in (f"{subject}:{label}", "", "")]
    lines.append(separator.join(["", *leading[1:2], *named] if units else ["", *named]))
    lines.append(separator.join([*leading, *[*"XYZ"] * len(labels)]))
    if units:
        lines.append(separator.join(["", "", *["mm"] * (3 * len(labels))]))
    for frame, row in enumerate(positions.reshape(len(positions), -1), 1):
        first = [str(frame), "0"] if units else [str(frame)]
        lines.append(separator.join([*first, *(number_text(number) for number in row)]))
    return ("\r\n".join([*lines, "", "Model Outputs", "100", "x"]) + "\r\n").encode()


def qtm(
    positions: FloatArray,
    labels: Sequence[str],
    *,
    rate: float = 200.0,
    leading: bool = True,
    titles: bool = True,
    data: str = "3D",
) -> bytes:
    """A TSV file of Qualisys Track Manager."""
    frames, points = positions.shape[:2]
    lines = [
        f"NO_OF_FRAMES\t{frames}", "NO_OF_CAMERAS\t8", f"NO_OF_MARKERS\t{points}",
        f"FREQUENCY\t{rate:g}", "NO_OF_ANALOG\t0", "ANALOG_FREQUENCY\t0", "DESCRIPTION\t--",
        "TIME_STAMP\t2022-06-03, 10:47:36.627\t94247.45402301", f"DATA_INCLUDED\t{data}",
    ]  # fmt: skip
    if labels:
        lines.append("\t".join(("MARKER_NAMES", *labels, "")))
        lines.append("\t".join(("TRAJECTORY_TYPES", *["Measured"] * points)))
    if titles:
        columns = [f"{label} {axis}" for label in labels for axis in "XYZ"]
        lines.append("\t".join((*(("Frame", "Time") if leading else ()), *columns)))
    for frame, row in enumerate(positions.reshape(frames, -1)):
        first = [str(frame + 1), f"{frame / rate:.5f}"] if leading else []
        lines.append("\t".join((*first, *(number_text(number, "") for number in row))))
    return ("\n".join(lines) + "\n").encode()
