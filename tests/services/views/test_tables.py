"""Tables of ready clips: angles, segments, gait, strides and cycles."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest

from app.analysis.angles.definitions import ANGLE_NAMES
from app.analysis.angles.segment_frames import Neutral
from app.analysis.gait.parameters import PARAMETERS
from app.errors import NoGait, NotEnoughKeyposes
from app.services.clips import catalogue as clips
from app.services.library.library import Library
from app.services.views import keyposes
from app.services.views.export import export
from app.services.views.segments import list_segments
from app.store.clips.record import ClipRecord
from tests.formats.npz.files import npz
from tests.libraries import FindClip, work
from tests.people import CONVENTIONS, person

Table = list[dict[str, str]]


def table(lib: Library, clip: ClipRecord, content: str, **options: object) -> Table:
    found = export(lib, clip.id, "csv", content=content, **options)  # type: ignore[arg-type]
    text = b"".join(found.blocks).decode()
    assert found.file_name == f"{clip.name}-{content}.csv"
    return list(csv.DictReader(io.StringIO(text, newline="")))


def column(rows: Table, name: str) -> np.ndarray:
    return np.array([float(row[name]) if row[name] else np.nan for row in rows])


def test_angles_are_those_of_the_files_rotations(ready_library: Library, clip_of: FindClip) -> None:
    walk = clip_of("ada", "walk")
    rows = table(ready_library, walk, "angles")
    assert len(rows) == walk.frames
    assert list(rows[0]) == ["time_s", *ANGLE_NAMES, "neutral_pose"]
    assert rows[0]["neutral_pose"] == Neutral.REST_POSE
    assert column(rows, "time_s")[-1] == pytest.approx((walk.frames or 0) / 60 - 1 / 60, abs=1e-3)
    for side in ("left", "right"):
        knee = column(rows, f"{side}_knee_flexion_deg")
        assert knee.min() > -5
        assert 30 < knee.max() < 90
        assert np.isfinite(column(rows, f"{side}_hip_flexion_deg")).all()


def test_angles_may_be_resampled(ready_library: Library, clip_of: FindClip) -> None:
    walk = clip_of("ada", "walk")
    all_of_them, few = (
        table(ready_library, walk, "angles", **options) for options in ({}, {"fps": 10.0})
    )
    assert column(few, "time_s")[1] == pytest.approx(0.1)
    at = column(few, "time_s")
    dense = np.interp(
        at, column(all_of_them, "time_s"), column(all_of_them, "left_hip_flexion_deg")
    )
    assert np.abs(dense - column(few, "left_hip_flexion_deg"))[1:-1].max() < 6


def test_gait_is_a_row_a_parameter(ready_library: Library, clip_of: FindClip) -> None:
    rows = table(ready_library, clip_of("ada", "walk"), "gait")
    assert [row["parameter"] for row in rows] == [one.name for one in PARAMETERS]
    by_name = {row["parameter"]: row for row in rows}
    cadence = by_name["cadence_steps_per_min"]
    assert 60 < float(cadence["mean"]) < 160
    assert int(cadence["left_strides"]) + int(cadence["right_strides"]) == int(cadence["strides"])
    assert abs(float(by_name["stride_length_m"]["symmetry_index_pct"])) < 10
    total = float(by_name["stance_pct"]["mean"]) + float(by_name["swing_pct"]["mean"])
    assert total == pytest.approx(100, abs=1e-5)


def test_strides_have_their_events_in_order(ready_library: Library, clip_of: FindClip) -> None:
    walk = clip_of("ada", "walk")
    rows = table(ready_library, walk, "strides")
    events = [column(rows, f"{name}_s") for name in (
        "foot_strike", "opposite_foot_off", "opposite_foot_strike", "foot_off", "next_foot_strike"
    )]  # fmt: skip
    assert (np.diff(events, axis=0) > 0).all()
    assert events[0].min() >= 0
    assert events[-1].max() <= (walk.duration or 0)
    assert {row["gait"] for row in rows} == {"walk"}
    gait = {row["parameter"]: row for row in table(ready_library, walk, "gait")}
    left = [float(row["stride_length_m"]) for row in rows if row["side"] == "left"]
    assert float(gait["stride_length_m"]["left_mean"]) == pytest.approx(np.mean(left), abs=1e-5)


def test_cycles_have_101_points_a_side(ready_library: Library, clip_of: FindClip) -> None:
    rows = table(ready_library, clip_of("ada", "walk"), "cycles")
    assert [row["side"] for row in rows] == ["left"] * 101 + ["right"] * 101
    assert [int(row["cycle_pct"]) for row in rows] == [*range(101)] * 2
    for side in (rows[:101], rows[101:]):
        knee = column(side, "knee_flexion_deg_mean")
        assert 60 <= int(np.argmax(knee)) <= 90  # bent most in swing
        hip = column(side, "hip_flexion_deg_mean")
        assert hip[0] > hip[50] + 20
        assert abs(hip[100] - hip[0]) < 5


def test_segments_are_those_of_the_clip(ready_library: Library, clip_of: FindClip) -> None:
    kick = clip_of("ada", "kick")
    rows = table(ready_library, kick, "segments")
    expected = list_segments(ready_library, kick.id).segments
    assert [float(row["start_s"]) for row in rows] == [one.start for one in expected]
    assert [row["cycle"] for row in rows] == [
        "" if one.cycle is None else str(one.cycle) for one in expected
    ]


@pytest.mark.parametrize("content", ["gait", "strides", "cycles"])
def test_who_does_not_walk_is_told_what_is_missing(
    ready_library: Library, clip_of: FindClip, content: str
) -> None:
    with pytest.raises(NoGait, match="expected at least one stride"):
        export(ready_library, clip_of("ada", "wave").id, "csv", content=content)


def test_positions_without_rotations_give_some_angles(lib: Library) -> None:
    recording = person(CONVENTIONS["SMPL"], frames=60)
    content = npz(
        positions=recording.positions,
        joint_names=np.array(recording.skeleton.names),
        parents=recording.skeleton.parents,
        frame_rate=60.0,
    )
    clip = clips.create_clip(lib, io.BytesIO(content), "person.npz").clip
    work(lib.settings)
    rows = table(lib, clips.get_clip(lib, clip.id), "angles")
    assert rows[0]["neutral_pose"] == "positions"
    assert rows[0]["left_hip_flexion_deg"] == ""
    assert np.isfinite(column(rows, "left_knee_flexion_deg")).all()
    keyposes.annotate_keyposes(lib, clip.id, [0.5])
    with pytest.raises(NotEnoughKeyposes):
        export(lib, clip.id, "csv", content="segments")
