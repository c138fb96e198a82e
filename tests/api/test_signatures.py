"""Signatures, actions and eigenmotions over HTTP."""

from __future__ import annotations

from typing import Any

import httpx2
import numpy as np
import pytest

from tests.api.conftest import assert_problem

KINDS = {"multilinear": ("positions", 39), "signatures": ("angles", 20)}


def path_of(demo: httpx2.Client, kind: str) -> str:
    models = {model["kind"]: model["id"] for model in demo.get("/v1/models").json()["items"]}
    return f"/v1/models/{models[kind]}"


def all_pages(demo: httpx2.Client, path: str, limit: int) -> list[dict[str, Any]]:
    clips, cursor = [], None
    while True:
        params = {"limit": limit, "eigenmotions": 0} | ({"cursor": cursor} if cursor else {})
        page = demo.get(path, params=params).json()
        assert len(page["clips"]) <= limit
        clips += page["clips"]
        cursor = page["next"]
        if cursor is None:
            return clips


@pytest.mark.parametrize("kind", KINDS)
def test_a_model_shows_its_vectors_with_names(demo: httpx2.Client, kind: str) -> None:
    found = demo.get(f"{path_of(demo, kind)}/signatures", params={"eigenmotions": 3}).json()
    coordinates, width = KINDS[kind]
    assert (found["kind"], found["coordinates"]) == (kind, coordinates)
    assert len(found["channels"]) == width
    for factor, names in (("persons", {"ada", "bruno"}), ("tasks", {"walk", "kick"})):
        space = found[factor]
        listed = [one["name"] for one in space["items"]]
        assert listed == sorted(listed)
        assert names <= set(listed)  # another test may have added more
        vectors = np.array([one["vector"] for one in space["items"]])
        assert vectors.shape[1] == len(space["singular_values"])
        np.testing.assert_allclose(vectors.T @ vectors, np.eye(vectors.shape[1]), atol=1e-6)
        assert 0 < space["variance_kept"] <= 1
    assert [one["number"] for one in found["eigenmotions"]] == [1, 2, 3]
    for one in found["eigenmotions"]:
        vector = one["vector"]
        curves = np.array(vector["curves"])
        assert curves.shape == (32, width)
        length = (curves**2).sum() + vector["turn"] ** 2 + vector["speed"] ** 2
        assert length == pytest.approx(1.0)


@pytest.mark.parametrize("kind", KINDS)
def test_each_clip_has_its_weights(demo: httpx2.Client, kind: str) -> None:
    path = f"{path_of(demo, kind)}/signatures"
    found = demo.get(path, params={"eigenmotions": 100, "limit": 1000}).json()
    nearest = 0
    persons = {one["name"]: np.array(one["vector"]) for one in found["persons"]["items"]}
    learned = [clip for clip in found["clips"] if clip["person"] in persons]  # see above
    for clip in learned:
        assert len(clip["weights"]) == found["eigenmotion_count"]
        own = np.array(clip["signature"])
        far = {name: np.linalg.norm(own - vector) for name, vector in persons.items()}
        nearest += min(far, key=far.__getitem__) == clip["person"]
        assert len(clip["person_point"]) == len(clip["task_point"]) == 2
    # the clips were learned, so a wrong basis or order is what would confuse the persons
    assert nearest >= 0.8 * len(learned) > 0
    assert found["total"] == len(found["clips"])


def test_clips_are_listed_page_by_page(demo: httpx2.Client) -> None:
    path = f"{path_of(demo, 'multilinear')}/signatures"
    pages, whole = all_pages(demo, path, 5), all_pages(demo, path, 1000)
    assert [clip["clip_id"] for clip in pages] == [clip["clip_id"] for clip in whole]
    for clip, same in zip(pages, whole, strict=True):
        assert clip["signature"] == pytest.approx(same["signature"])
    kicks = demo.get(path, params={"task": "kick", "person": "ada"}).json()["clips"]
    assert kicks
    assert {(one["person"], one["task"]) for one in kicks} == {("ada", "kick")}


@pytest.mark.parametrize("kind", KINDS)
def test_an_eigenmotion_is_played_like_a_clip(demo: httpx2.Client, kind: str) -> None:
    path = f"{path_of(demo, kind)}/eigenmotions/2/motion"
    moved = {}
    for deviations in (-2, 0, 2):
        answer = demo.get(path, params={"deviations": deviations, "seconds": 1}).json()
        assert (answer["frame_rate"], len(answer["joint_names"])) == (30, 13)
        moved[deviations] = np.array(answer["positions"])
        assert moved[deviations].shape == (30, 13, 3)
    assert np.abs(moved[2] - moved[0]).max() > 0.02
    assert np.abs(moved[-2] - moved[2]).max() > np.abs(moved[2] - moved[0]).max()
    octets = demo.get(
        path,
        params={"deviations": 2, "seconds": 1},
        headers={"Accept": "application/octet-stream"},
    )
    assert octets.headers["X-Shape"] == "30,13,3"
    sent = np.frombuffer(octets.content, dtype="<f4").reshape(30, 13, 3)
    np.testing.assert_allclose(sent, moved[2], atol=1e-5)


def test_what_has_no_signatures_is_refused(demo: httpx2.Client) -> None:
    words, multilinear = path_of(demo, "words"), path_of(demo, "multilinear")
    for part in ("signatures", "eigenmotions/1/motion"):
        assert_problem(demo.get(f"{words}/{part}"), 409, "no_signatures")
        assert_problem(demo.get(f"/v1/models/nobody/{part}"), 404, "not_found")
    far = demo.get(f"{multilinear}/eigenmotions/100/motion")
    assert_problem(far, 404, "not_found", "path.number")
    for wrong in ({"deviations": 7}, {"deviations": "nan"}, {"seconds": 0}, {"x": 1}):
        answer = demo.get(f"{multilinear}/eigenmotions/1/motion", params=wrong)
        assert_problem(answer, 422, "bad_field")
    for wrong in ({"eigenmotions": -1}, {"limit": 0}):
        answer = demo.get(f"{multilinear}/signatures", params=wrong)
        assert_problem(answer, 422, "bad_field")
