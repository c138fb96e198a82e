"""Models over HTTP: held-out figures, and the false-accept rate."""

from __future__ import annotations

import httpx2


def test_the_false_accept_rate_is_set_and_shown(demo: httpx2.Client) -> None:
    of_kind = {model["kind"]: model for model in demo.get("/v1/models").json()["items"]}
    recognizer = of_kind["recogniser"]
    assert of_kind["words"]["errors_in_force"] is None
    assert set(recognizer["errors_in_force"]) <= {"person", "task"}
    assert recognizer["false_accept_rate"] is None
    path = f"/v1/models/{recognizer['id']}"
    strict = demo.patch(path, json={"false_accept_rate": 0.05}).json()
    assert strict["false_accept_rate"] == 0.05
    assert strict["errors_in_force"].keys() == recognizer["errors_in_force"].keys()
    assert all(one["false_acceptance"] <= 0.05 for one in strict["errors_in_force"].values())
    listed = {model["kind"]: model for model in demo.get("/v1/models").json()["items"]}
    assert listed["recogniser"] == strict
    assert demo.patch(path, json={"false_accept_rate": None}).json()["false_accept_rate"] is None
    for wrong in ({"false_accept_rate": 2}, {"false_accept_rate": "x"}, {}, {"rate": 0.1}):
        assert demo.patch(path, json=wrong).status_code == 422, wrong
    words = f"/v1/models/{of_kind['words']['id']}"
    assert demo.patch(words, json={"false_accept_rate": 0.1}).status_code == 422
    assert demo.patch("/v1/models/nobody", json={"false_accept_rate": 0.1}).status_code == 404
