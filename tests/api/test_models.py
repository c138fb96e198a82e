"""Models over HTTP: held-out figures, and the false-accept rate."""

from __future__ import annotations

import httpx2
import pytest


def test_the_false_accept_rate_is_set_and_shown(demo: httpx2.Client) -> None:
    of_kind = {model["kind"]: model for model in demo.get("/v1/models").json()["items"]}
    recognizer = of_kind["recognizer"]
    assert of_kind["words"]["errors_in_force"] is None
    assert set(recognizer["errors_in_force"]) <= {"person", "task"}
    assert recognizer["false_accept_rate"] is None
    path = f"/v1/models/{recognizer['id']}"
    strict = demo.patch(path, json={"false_accept_rate": 0.05}).json()
    assert strict["false_accept_rate"] == 0.05
    assert strict["errors_in_force"].keys() == recognizer["errors_in_force"].keys()
    assert all(one["false_acceptance"] <= 0.05 for one in strict["errors_in_force"].values())
    listed = {model["kind"]: model for model in demo.get("/v1/models").json()["items"]}
    assert listed["recognizer"] == strict
    assert demo.patch(path, json={"false_accept_rate": None}).json()["false_accept_rate"] is None
    for wrong in ({"false_accept_rate": 2}, {"false_accept_rate": "x"}, {}, {"rate": 0.1}):
        assert demo.patch(path, json=wrong).status_code == 422, wrong
    words = f"/v1/models/{of_kind['words']['id']}"
    assert demo.patch(words, json={"false_accept_rate": 0.1}).status_code == 422
    assert demo.patch("/v1/models/nobody", json={"false_accept_rate": 0.1}).status_code == 404


@pytest.mark.parametrize("factor", ["person", "task"])
def test_the_confusion_matrix_counts_every_labeled_clip(demo: httpx2.Client, factor: str) -> None:
    matrix = demo.get("/v1/models/confusion", params={"factor": factor}).json()
    fitted = {model["kind"]: model for model in demo.get("/v1/models").json()["items"]}
    size = fitted["recognizer"]["library_size"]
    cells = matrix["items"]
    assert {cell["label"] for cell in cells} | {cell["guess"] for cell in cells} <= set(
        matrix["names"]
    )
    assert sum(cell["count"] for cell in cells) == size
    right = sum(cell["count"] for cell in cells if cell["label"] == cell["guess"])
    share = fitted["recognizer"]["figures"]["held_out"]["default"][factor]
    assert right / size == pytest.approx(share)
    for cell in cells:
        params = {"factor": factor, "label": cell["label"], "guess": cell["guess"]}
        clips = demo.get("/v1/models/confusion/clips", params=params).json()["items"]
        assert len(clips) == cell["count"]
        assert {clip[factor] for clip in clips} == {cell["label"]}
    nobody = {"factor": factor, "label": "nobody", "guess": "nobody"}
    assert demo.get("/v1/models/confusion/clips", params=nobody).json()["items"] == []
    assert demo.get("/v1/models/confusion", params={"factor": "word"}).status_code == 422


def test_confusions_need_models(idle: httpx2.Client) -> None:
    for path in ("confusion", "confusion/clips?label=a&guess=b"):
        answer = idle.get(f"/v1/models/{path}")
        assert (answer.status_code, answer.json()["code"]) == (409, "model_not_fitted")
