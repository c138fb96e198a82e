"""Pictures of self-similarity matrices and motion volumes."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from app.errors import BadField
from app.services.library.library import Library
from app.services.views import volumes
from app.services.volume_options import VolumeOptions
from app.store.clips.record import ClipRecord

PLAIN = VolumeOptions()


def _cells(picture: str) -> int:
    return sum(d.count("M") for d in re.findall(r' d="([^"]*)"', picture))


def test_a_matrix_has_a_cell_for_each_pair_of_joints(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    clip = ready_clips[0]
    picture = volumes.ssm_svg(ready_library, clip.id, None, PLAIN)
    assert ElementTree.fromstring(picture).tag.endswith("svg")
    assert _cells(picture) == 13 * 13
    assert picture.count("left knee") == 2
    start = volumes.ssm_svg(ready_library, clip.id, 0.0, PLAIN)
    assert "0.00 s" in start
    assert start != picture


def test_a_volume_has_its_slices_with_their_times(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    clip = ready_clips[0]
    picture = volumes.msv_svg(ready_library, clip.id, 6, PLAIN)
    assert ElementTree.fromstring(picture).tag.endswith("svg")
    assert _cells(picture) == 6 * 13 * 13
    assert len(re.findall(r">\d+\.\d\d s<", picture)) == 6
    assert picture != volumes.msv_svg(ready_library, clip.id, 6, VolumeOptions(q=1))


def test_a_threshold_leaves_two_colors(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    picture = volumes.ssm_svg(ready_library, ready_clips[0].id, None, VolumeOptions(eta=0.4))
    assert len(set(re.findall(r'<path fill="(#\w+)"', picture))) == 2


def test_a_wrong_moment_or_number_of_slices_is_refused(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    with pytest.raises(BadField, match="time"):
        volumes.ssm_svg(ready_library, ready_clips[0].id, 1000.0, PLAIN)
    with pytest.raises(BadField, match="slices"):
        volumes.msv_svg(ready_library, ready_clips[0].id, 1, PLAIN)
    with pytest.raises(BadField, match="q"):
        volumes.msv_svg(ready_library, ready_clips[0].id, 5, VolumeOptions(q=3))
