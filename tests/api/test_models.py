"""Models over HTTP: their held-out figures, and the false-accept rate that can be set."""

from __future__ import annotations

import httpx2


def test_the_false_accept_rate_is_set_and_told(demo: httpx2.Client) -> None:
    of_kind = {model["kind"]: model for model in demo.get("/v1/models").json()["items"]}
    recogniser = of_kind["recogniser"]
    assert recogniser["false_accept_rate"] is None
    path = f"/v1/models/{recogniser['id']}"
    assert demo.patch(path, json={"false_accept_rate": 0.05}).json()["false_accept_rate"] == 0.05
    assert demo.patch(path, json={"false_accept_rate": None}).json()["false_accept_rate"] is None
    for wrong in ({"false_accept_rate": 2}, {"false_accept_rate": "x"}, {}, {"rate": 0.1}):
        assert demo.patch(path, json=wrong).status_code == 422, wrong
    words = f"/v1/models/{of_kind['words']['id']}"
    assert demo.patch(words, json={"false_accept_rate": 0.1}).status_code == 422
    assert demo.patch("/v1/models/nobody", json={"false_accept_rate": 0.1}).status_code == 404
