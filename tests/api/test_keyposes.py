"""Keyposes over HTTP: those that are found, with their sources, and those that people name."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest

from tests.api.conftest import assert_problem


def test_keyposes_come_with_energies_thresholds_and_beats(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    reply = demo.get(f"/v1/clips/{walk['id']}/keyposes").json()
    frames = len(reply["energy"]["global"])
    assert frames == len(reply["energy"]["local"]) == pytest.approx(30 * walk["duration"], abs=2)
    assert (reply["method"], reply["weights"]) == ("rms", "uniform")
    assert reply["energy_unit"] == "body lengths per second"
    assert reply["thresholds"] == {"t1": "default", "t2": "default", "model_version": None}
    assert reply["beats_source"] in ("motion", "none")
    assert 0 <= reply["beats_confidence"] <= 1
    assert set(reply["noise"]) == {"global", "local"}
    assert reply["annotated"] is None
    count = len(reply["frames"])
    assert count == len(reply["times"]) == len(reply["chosen_by"]) == len(reply["poses"]) > 2
    assert reply["times"] == pytest.approx(
        [frame / reply["frame_rate"] for frame in reply["frames"]]
    )
    assert set(reply["chosen_by"]) <= {"global", "local", "turn"}


def test_weights_and_method_change_the_curves(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    def curve(**params: str) -> list[float]:
        answer = demo.get(f"/v1/clips/{walk['id']}/keyposes", params=params).json()
        assert {name: answer[name] for name in params} == params
        found: list[float] = answer["energy"]["global"]
        return found

    curves = [
        curve(method=method, weights=weights)
        for method in ("rms", "printed")
        for weights in ("uniform", "mass")
    ]
    assert len({tuple(values) for values in curves}) == 4


def test_named_keyposes_are_stored_shown_and_deleted(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    address = f"/v1/clips/{walk['id']}/keyposes"
    assert demo.put(address, json={"times": [1.5, 0.5, 1.5]}).json() == {"times": [0.5, 1.5]}
    assert demo.get(address).json()["annotated"] == [0.5, 1.5]
    assert demo.put(address, json={"times": [0.75]}).json() == {"times": [0.75]}
    assert demo.delete(address).status_code == 204
    assert demo.get(address).json()["annotated"] is None
    assert demo.put(address, json={"times": [0.5]}).status_code == 200
    assert demo.put(address, json={"times": []}).json() == {"times": []}
    assert demo.get(address).json()["annotated"] is None
    assert demo.delete(address).status_code == 204


@pytest.mark.parametrize(
    ("body", "location"),
    [
        ({}, "body.times"),
        ({"times": 3}, "body.times"),
        ({"times": ["soon"]}, "body.times.0"),
        ({"times": [-1.0]}, "body.times.0"),
        ({"times": [1.0], "beats": []}, "body.beats"),
        ({"times": [1.0] * 10_001}, "body.times"),
        ({"times": [1e5]}, "body.times"),
    ],
)
def test_bad_annotations_are_refused_by_name(
    demo: httpx2.Client, walk: dict[str, Any], body: dict[str, Any], location: str
) -> None:
    answer = demo.put(f"/v1/clips/{walk['id']}/keyposes", json=body)
    assert_problem(answer, 422, "bad_field", location)


def test_unknown_clips_and_forms_are_refused(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    for answer in (
        demo.get("/v1/clips/none/keyposes"),
        demo.put("/v1/clips/none/keyposes", json={"times": [1.0]}),
        demo.delete("/v1/clips/none/keyposes"),
    ):
        assert_problem(answer, 404, "clip_not_found")
    answer = demo.put(f"/v1/clips/{walk['id']}/keyposes", content="times=1")
    assert_problem(answer, 415, "unsupported_media_type")
    for params in ({"weights": "most"}, {"t1": "0"}, {"method": "x"}):
        answer = demo.get(f"/v1/clips/{walk['id']}/keyposes", params=params)
        assert_problem(answer, 422, "bad_field", f"query.{next(iter(params))}")
