"""Animated pictures: well-formed, without scripts, with the right positions of joints over time."""

from __future__ import annotations

import re
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest

from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from app.numerics.arrays import FloatArray
from app.services.figures.animated_figure import MAX_FRAMES, animated_svg
from app.services.figures.camera import HEIGHT, WIDTH, Figure
from app.services.figures.stick_figure import LEFT, RIGHT, limbs
from app.services.views.animations import role_figure
from tests.bodies import standing, walking, waving

SVG = "{http://www.w3.org/2000/svg}"
HARMLESS = {"svg", "title", "rect", "g", "path", "polyline", "circle", "text", "animate",
            "animateTransform"}  # fmt: skip


def _parsed(*bodies: FloatArray, rate: float = 30.0, title: str = "a clip") -> ElementTree.Element:
    return ElementTree.fromstring(animated_svg([role_figure(b) for b in bodies], rate, title))


def _points(element: ElementTree.Element, color: str) -> list[FloatArray]:
    """(frames, joints, 2) of each line of a color; one frame if nothing moves."""
    found = []
    for line in element.iter(f"{SVG}polyline"):
        moves = line.find(f"{SVG}animate")
        values = line.get("points", "") if moves is None else moves.get("values", "")
        if line.get("stroke") == color:
            frames = [[xy.split(",") for xy in frame.split()] for frame in values.split(";")]
            found.append(np.array(frames, dtype=float))
    return found


def _arm(element: ElementTree.Element, color: str) -> FloatArray:
    """(frames, 4, 2): neck, shoulder, elbow, hand."""
    return next(line for line in _points(element, color) if line.shape[1] == 4)


def test_a_picture_has_no_active_content_except_animations() -> None:
    drawn = _parsed(walking(), title="<script>&\x00\u202e")
    tags = {element.tag.removeprefix(SVG) for element in drawn.iter()}
    assert tags <= HARMLESS
    names = {name for element in drawn.iter() for name in element.attrib}
    assert not {
        name for name in names if name.startswith("on") or "href" in name or name == "style"
    }
    title = drawn.find(f"{SVG}title")
    assert title is not None
    assert title.text == "<script>&"


def test_all_animations_have_the_same_duration_and_number_of_values() -> None:
    drawn = _parsed(walking(4.0), waving(4.0))
    animations = [e for e in drawn.iter() if e.tag.removeprefix(SVG).startswith("animate")]
    assert {e.get("dur") for e in animations} == {"4.000s"}
    assert {e.get("repeatCount") for e in animations} == {"indefinite"}
    assert {len(e.get("values", "").split(";")) for e in animations} == {
        61,
        2,
    }  # 15 Hz, and the bar


@pytest.mark.parametrize("body", [waving(), walking(1.5), walking(20.0, turn=0.2)])
def test_all_bodies_stay_within_the_picture(body: FloatArray) -> None:
    drawn = _parsed(body)
    for points in _points(drawn, LEFT) + _points(drawn, RIGHT):
        assert points.min() >= 0
        assert points[..., 0].max() <= WIDTH
        assert points[..., 1].max() <= HEIGHT


def test_joints_have_the_positions_of_the_body_seen_from_the_side() -> None:
    body = waving()  # the hand moves along x, which becomes the picture's
    names = [role.value for role in SUN_ROLES]
    drawn = _arm(_parsed(body), RIGHT)
    arm = body[
        ::2, [names.index(n) for n in ("neck", "right_shoulder", "right_elbow", "right_hand")]
    ]
    scale = (drawn[0, 1, 1] - drawn[0, 0, 1]) / (arm[0, 0, 1] - arm[0, 1, 1])
    expected = drawn[:, :1] + scale * (arm - arm[:, :1])[..., :2] * [1, -1]
    assert np.abs(drawn - expected).max() < 2.0


def test_the_camera_follows_a_body_that_goes_far_and_the_floor_moves() -> None:
    near, far = _parsed(walking(1.0)), _parsed(walking(20.0))
    assert near.find(f".//{SVG}animateTransform") is None
    moved = far.find(f".//{SVG}animateTransform")
    assert moved is not None
    shifts = [float(value.split()[0]) for value in moved.get("values", "").split(";")]
    assert shifts[0] - shifts[-1] > 3 * WIDTH
    assert (np.diff(shifts) < 0.2).all()


def test_two_motions_of_one_person_have_one_scale() -> None:
    both = _parsed(waving(), 0.5 * waving())
    left = [svg for svg in both.iter(f"{SVG}svg") if svg.get("x") is not None]
    assert [svg.get("x") for svg in left] == ["0", str(WIDTH)]
    large, small = (np.ptp(_arm(svg, LEFT)[0, :, 1]) for svg in left)
    assert large == pytest.approx(2 * small, abs=0.3)


def test_labels_are_above_the_figures_and_escaped() -> None:
    figures = [role_figure(waving(), "A <b>"), role_figure(waving(), "original")]
    drawn = ElementTree.fromstring(animated_svg(figures, 30.0, "pair"))
    assert [text.text for text in drawn.iter(f"{SVG}text")] == ["A <b>", "original"]


def test_long_motions_keep_their_duration_with_fewer_frames() -> None:
    body = np.tile(waving(4.0)[:-1], (50, 1, 1))
    picture = animated_svg([role_figure(body)], 30.0, "long")
    values = re.findall(
        r'<animate attributeName="cx" dur="([\d.]+)s"[^>]* values="([^"]*)"', picture
    )
    (seconds,) = re.findall(r'attributeName="width" dur="([\d.]+)s"', picture)
    assert float(seconds) == pytest.approx(200, abs=0.5)
    assert all(len(moves.split(";")) <= MAX_FRAMES for _, moves in values)
    assert len(picture) < 400_000


@pytest.mark.parametrize("body", [standing(1), standing(40), np.zeros((5, 13, 3))])
def test_a_body_that_does_not_move_has_no_animation(body: FloatArray) -> None:
    drawn = _parsed(body)
    assert [e.get("attributeName") for e in drawn.iter(f"{SVG}animate")] in ([], ["width"])
    assert len(list(drawn.iter(f"{SVG}polyline"))) == 6


def test_any_skeleton_can_be_drawn() -> None:
    parents = np.array([-1, 0, 1, 1, -1, 4])
    draw = np.random.default_rng(1)
    figure = Figure(draw.normal(size=(20, 6, 3)), parents)
    drawn = ElementTree.fromstring(animated_svg([figure], 24.0, "two roots"))
    assert len(list(drawn.iter(f"{SVG}polyline"))) == 4
    assert drawn.find(f".//{SVG}circle") is None
    assert sorted(limbs(parents)) == [[0, 1], [1, 2], [1, 3], [4, 5]]


def test_every_bone_is_in_one_line() -> None:
    lines = limbs(np.array(SUN_PARENTS))
    bones = sorted((b, a) for line in lines for a, b in pairwise(line))
    assert bones == [(joint, parent) for joint, parent in enumerate(SUN_PARENTS) if parent >= 0]


@pytest.mark.parametrize("figures", [[], [role_figure(np.zeros((0, 13, 3)))]])
def test_figures_without_frames_are_refused(figures: list[Figure]) -> None:
    with pytest.raises(ValueError, match="at least one figure"):
        animated_svg(figures, 30.0, "nothing")
