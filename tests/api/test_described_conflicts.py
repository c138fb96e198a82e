"""The description shows of each call the conflicts (409) that it can answer, and no others."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest

from app.errors import Conflict
from tests.api.conftest import assert_problem

MEDIA_TYPE = "application/problem+json"
OF_A_KEY = {"call_in_progress", "call_overtaken", "answer_lost"}


@pytest.fixture
def paths(demo: httpx2.Client) -> dict[str, Any]:
    found: dict[str, Any] = demo.get("/openapi.json").json()["paths"]
    return found


def codes_of(paths: dict[str, Any], method: str, path: str) -> set[str]:
    """The codes of the examples of 409."""
    answer = paths[path][method]["responses"].get("409")
    examples = answer["content"][MEDIA_TYPE]["examples"] if answer else {}
    assert all(example["value"]["code"] == code for code, example in examples.items())
    return set(examples)


@pytest.mark.parametrize(
    ("method", "path", "codes"),
    [
        ("post", "/v1/webhooks", {"conflict"}),
        ("delete", "/v1/jobs/{job_id}", {"conflict"}),
        ("get", "/v1/models/confusion", {"model_not_fitted"}),
        ("get", "/v1/clips/{clip_id}/low-dimensional", {"clip_not_ready", "not_enough_keyposes"}),
        ("post", "/v1/studies/low-dimensional/pairs/{pair_id}/votes", {"already_voted"}),
        ("patch", "/v1/clips/{clip_id}", set()),
        ("post", "/v1/models/fit", set()),
    ],
)
def test_a_call_shows_its_own_conflicts(
    paths: dict[str, Any], method: str, path: str, codes: set[str]
) -> None:
    assert codes_of(paths, method, path) - OF_A_KEY == codes


def test_every_described_conflict_has_a_code_that_exists(paths: dict[str, Any]) -> None:
    known = {Conflict.code} | {kind.code for kind in _kinds(Conflict)}
    for path, item in paths.items():
        for method, operation in item.items():
            if "409" in operation["responses"]:
                assert codes_of(paths, method, path) <= known
                assert codes_of(paths, method, path)


def test_a_described_conflict_is_answered(idle: httpx2.Client) -> None:
    answer = idle.get("/v1/models/confusion")
    assert_problem(answer, 409, "model_not_fitted")


def _kinds(kind: type[Any]) -> list[type[Any]]:
    return [deep for child in kind.__subclasses__() for deep in (child, *_kinds(child))]
