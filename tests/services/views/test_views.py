"""The motion, the descriptors and the thumbnail of a ready clip."""

from __future__ import annotations

import io
from xml.etree import ElementTree

import numpy as np
import pytest

from app.errors import BadField, ClipNotFound, ClipNotReady
from app.motion.roles.joint_roles import SUN_ROLES
from app.services.clips import catalogue as clips
from app.services.figures.thumbnail import thumbnail
from app.services.library.library import Library
from app.services.views import keyposes, views
from tests.libraries import FindClip

SVG = "{http://www.w3.org/2000/svg}"


def test_the_motion_has_all_joints_or_the_13_roles_at_any_rate(
    ready_library: Library, clip_of: FindClip
) -> None:
    clip = clip_of("ada", "walk")
    whole = views.motion(ready_library, clip.id)
    assert whole.positions.shape == (clip.frames, clip.joints, 3)
    assert whole.frame_rate == clip.frame_rate
    assert whole.parents[0] == -1
    assert all(parent < joint for joint, parent in enumerate(whole.parents))
    roles = views.motion(ready_library, clip.id, fps=10.0, joints="roles")
    assert roles.joint_names == tuple(SUN_ROLES)
    assert roles.positions.shape[1:] == (13, 3)
    assert clip.duration is not None
    assert abs(len(roles.positions) - 10 * clip.duration) <= 1
    hips = whole.joint_names.index(clip.roles["hips"])
    assert np.allclose(roles.positions[0, 4], whole.positions[0, hips], atol=0.02)


def test_the_descriptor_has_the_arrays_that_searches_compare(
    ready_library: Library, clip_of: FindClip
) -> None:
    found = views.descriptor(ready_library, clip_of("ada", "walk").id)
    assert found.motion_vector.shape == (128,)
    assert found.msv_rho.shape == (13,)
    assert np.linalg.norm(found.msv_rho) == pytest.approx(1, abs=1e-5)
    assert found.msv_convergence is not None
    assert found.msv_convergence.shape[1] == 2
    assert found.symbol_means.shape == found.symbol_variances.shape == (found.symbol_states, 26)
    assert found.analysis_version >= 1


def test_a_clip_without_stored_convergence_has_a_descriptor(
    ready_library: Library, clip_of: FindClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(views, "CONVERGENCE", "an array that no clip has")
    assert views.descriptor(ready_library, clip_of("ada", "walk").id).msv_convergence is None


def test_the_thumbnail_shows_a_few_figures_and_has_no_script(
    ready_library: Library, clip_of: FindClip
) -> None:
    picture = ElementTree.fromstring(views.thumbnail_svg(ready_library, clip_of("ada", "walk").id))
    assert (picture.get("width"), picture.get("height")) == ("320", "180")
    heads = list(picture.iter(f"{SVG}circle"))
    assert 3 <= len(heads) <= 8
    assert all(0 < float(h.get("cx", -1)) < 320 and 0 < float(h.get("cy", -1)) < 180 for h in heads)
    assert {e.tag.removeprefix(SVG) for e in picture.iter()} == {
        *("svg", "title", "rect", "path", "g", "circle")
    }


@pytest.mark.parametrize("frames", [1, 2, 50])
def test_any_motion_has_a_thumbnail(frames: int) -> None:
    still = np.zeros((frames, 13, 3), dtype=np.float32)
    ElementTree.fromstring(thumbnail(still, "<script>&\x00\ud800"))


@pytest.mark.parametrize(
    ("call", "location"),
    [
        (lambda lib, clip: views.motion(lib, clip, fps=0), "fps"),
        (lambda lib, clip: views.motion(lib, clip, joints="some"), "joints"),
    ],
)
def test_a_wrong_field_is_named(
    ready_library: Library, clip_of: FindClip, call: object, location: str
) -> None:
    with pytest.raises(BadField) as refused:
        call(ready_library, clip_of("ada", "walk").id)  # type: ignore[operator]
    assert refused.value.places[0].location == location


@pytest.mark.parametrize(
    "view", [views.motion, keyposes.view, views.descriptor, views.thumbnail_svg]
)
def test_only_ready_clips_have_views(lib: Library, view: object) -> None:
    queued = clips.create_clip(lib, io.BytesIO(b"HIERARCHY\n"), "a.bvh").clip
    with pytest.raises(ClipNotReady):
        view(lib, queued.id)  # type: ignore[operator]
    with pytest.raises(ClipNotFound):
        view(lib, "clip_none")  # type: ignore[operator]
