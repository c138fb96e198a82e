"""Tables of a ready clip: joint angles, segments, gait parameters, strides and gait cycles."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from app.analysis.angles.angles import JointAngles, angles_of
from app.analysis.angles.definitions import ANGLE_NAMES
from app.analysis.gait.gait_cycle import POINTS, mean_cycles
from app.analysis.gait.parameters import PARAMETERS
from app.analysis.gait.strides import Stride, strides_of
from app.analysis.gait.summary import summarize
from app.analysis.gait.walk import walk_of
from app.errors import NotEnoughKeyposes
from app.formats.csv.writer import Cell, csv_table, csv_tracks
from app.motion.motion import Motion
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.services.views.clip_rotations import file_animation, resampled
from app.services.views.export_format import ExportContent
from app.services.views.segments import list_segments
from app.store.clips.record import ClipRecord

ANGLE_DECIMALS = 4
NEUTRAL = "neutral_pose"
"""The column that says where the neutral pose of the angles comes from."""


def table_of(
    lib: Library, clip: ClipRecord, content: ExportContent, rate: float
) -> Iterable[bytes]:
    """A CSV file of the clip, piece by piece.

    rate: Hz, of the angles; the other tables do not depend on it. Raises NoGait for a clip without
    walking, and NotEnoughKeyposes for one without segments.
    """
    if content is ExportContent.SEGMENTS:
        return _segments(lib, clip)
    motion = load_motion(lib, clip)
    if content is ExportContent.ANGLES:
        return _angles(_joint_angles(lib, clip, motion, rate))
    strides = strides_of(walk_of(motion))
    if content is ExportContent.GAIT:
        return _gait(strides)
    if content is ExportContent.STRIDES:
        return _strides(strides)
    return _cycles(_joint_angles(lib, clip, motion, motion.frame_rate), strides)


def _joint_angles(lib: Library, clip: ClipRecord, motion: Motion, rate: float) -> JointAngles:
    return angles_of(resampled(motion, rate), file_animation(lib, clip, motion, rate))


def _angles(angles: JointAngles) -> Iterator[bytes]:
    return csv_tracks(
        ANGLE_NAMES,
        angles.degrees,
        angles.frame_rate,
        decimals=ANGLE_DECIMALS,
        constants=[(NEUTRAL, angles.neutral.value)],
    )


def _segments(lib: Library, clip: ClipRecord) -> Iterator[bytes]:
    found = list_segments(lib, clip.id)
    if not found.segments:
        raise NotEnoughKeyposes("The clip has fewer than two keyposes, so it has no segments.")
    runs = {cycle.index: cycle.run for cycle in found.cycles}
    rows: list[list[Cell]] = [
        [one.index, one.start, one.end, one.duration, one.cycle,
         None if one.cycle is None else runs[one.cycle]]
        for one in found.segments
    ]  # fmt: skip
    return csv_table(["segment", "start_s", "end_s", "duration_s", "cycle", "run"], rows)


def _gait(strides: Iterable[Stride]) -> Iterator[bytes]:
    rows: list[list[Cell]] = [
        [
            row.parameter.name,
            *(value for one in (row.left, row.right, row.both)
              for value in (one.mean, one.sd, one.count)),
            row.symmetry,
        ]
        for row in summarize(tuple(strides))
    ]  # fmt: skip
    columns = [
        f"{side}{what}" for side in ("left_", "right_", "") for what in ("mean", "sd", "strides")
    ]
    return csv_table(["parameter", *columns, "symmetry_index_pct"], rows)


def _strides(strides: Iterable[Stride]) -> Iterator[bytes]:
    events = {
        "foot_strike_s": "strike",
        "opposite_foot_off_s": "other_off",
        "opposite_foot_strike_s": "other_strike",
        "foot_off_s": "off",
        "next_foot_strike_s": "next_strike",
    }
    rows: list[list[Cell]] = [
        [
            number,
            stride.side,
            "run" if stride.is_run else "walk",
            *(float(getattr(stride, name)) for name in events.values()),
            *(parameter.of(stride) for parameter in PARAMETERS),
        ]
        for number, stride in enumerate(strides)
    ]
    names = [parameter.name for parameter in PARAMETERS]
    return csv_table(["stride", "side", "gait", *events, *names], rows)


def _cycles(angles: JointAngles, strides: Iterable[Stride]) -> Iterator[bytes]:
    cycles = mean_cycles(angles, tuple(strides))
    names = [f"{name}_{what}" for name in cycles[0].names for what in ("mean", "sd")]
    rows: Iterator[list[Cell]] = (
        [
            cycle.side,
            percent,
            cycle.strides,
            *_paired(cycle.mean[percent], cycle.sd[percent]),
            angles.neutral.value,
        ]
        for cycle in cycles
        for percent in range(POINTS)
    )
    return csv_table(["side", "cycle_pct", "strides", *names, NEUTRAL], rows)


def _paired(means: Iterable[float], deviations: Iterable[float]) -> list[Cell]:
    pairs = zip(means, deviations, strict=True)
    return [float(value) for pair in pairs for value in pair]
