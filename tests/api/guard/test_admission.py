"""Every call has a kind. It decides where the call waits after all other checks."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.routing import APIRoute

from app.api.app import ROUTES, create_app
from app.api.deps import get_library
from app.api.guard.admission import Admission, Kind
from app.config import Settings

HEAVY = {
    "/v1/search",
    "/v1/search/motion",
    "/v1/search/pose",
    "/v1/search/words",
    "/v1/recognize",
    "/v1/synthesize",
    "/v1/space",
    "/v1/space/columns",
    "/v1/clips/{clip_id}/motion",
    "/v1/clips/{clip_id}/alignment",
    "/v1/clips/{clip_id}/export",
    "/v1/clips/{clip_id}/low-dimensional",
    "/v1/clips/{clip_id}/segments",
    "/v1/studies/low-dimensional/pairs/{pair_id}/{side:side}",
}
"""The calls that take longest on a long clip."""
GATED = {Kind.HEAVY, Kind.QUICK, Kind.CHANGES}


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> FastAPI:
    return create_app(Settings(data_dir=tmp_path_factory.mktemp("routes") / "data"))


@pytest.fixture(scope="module")
def routes(app: FastAPI) -> list[APIRoute]:
    found = [*app.routes, *(route for module in ROUTES for route in module.router.routes)]
    return [route for route in found if isinstance(route, APIRoute)]


def _kinds(route: APIRoute) -> list[Kind]:
    calls = [dependant.call for dependant in route.dependant.dependencies]
    return [call.kind for call in calls if isinstance(call, Admission)]


def _description(app: FastAPI, route: APIRoute) -> dict[str, Any]:
    """The call in the OpenAPI description."""
    (method,) = route.methods
    description: dict[str, Any] = app.openapi()["paths"][route.path_format][method.lower()]
    return description


def test_every_call_has_one_kind(routes: list[APIRoute]) -> None:
    assert {route.path: len(_kinds(route)) for route in routes} == {
        route.path: 1 for route in routes
    }


def test_every_described_call_is_a_checked_route(app: FastAPI, routes: list[APIRoute]) -> None:
    described = {
        (method.upper(), path)
        for path, description in app.openapi()["paths"].items()
        for method in description
    }
    assert described <= {
        (method, route.path_format) for route in routes for method in route.methods
    }


def test_a_call_takes_a_slot_after_its_key_was_checked_and_its_form_arrived(
    routes: list[APIRoute],
) -> None:
    for route in routes:
        calls = [dependant.call for dependant in route.dependant.dependencies]
        index = next(i for i, call in enumerate(calls) if isinstance(call, Admission))
        # FastAPI caches the value of a repeated dependency, so it takes no time.
        solved = {*calls[:index], get_library}
        assert set(calls[index + 1 :]) <= solved, route.path


def test_long_calls_are_heavy(routes: list[APIRoute]) -> None:
    kinds = {route.path: _kinds(route)[0] for route in routes if route.path in HEAVY}
    assert kinds == dict.fromkeys(HEAVY, Kind.HEAVY)


def test_health_checks_pass_no_gate(routes: list[APIRoute]) -> None:
    kinds = {route.path: _kinds(route)[0] for route in routes}
    assert kinds["/livez"] is kinds["/readyz"] is Kind.AT_ONCE


def test_calls_that_may_be_refused_describe_503(app: FastAPI, routes: list[APIRoute]) -> None:
    for route in routes:
        if route.include_in_schema and _kinds(route)[0] in GATED:
            assert "503" in _description(app, route)["responses"], route.path


def test_every_fps_parameter_has_the_same_bounds(app: FastAPI, routes: list[APIRoute]) -> None:
    bounds = {}
    for route in routes:
        description = _description(app, route) if route.include_in_schema else {}
        for parameter in description.get("parameters", []):
            if parameter["name"] == "fps":
                number = parameter["schema"]
                bounds[route.path] = number["minimum"], number["maximum"]
    assert len(bounds) == 5
    assert set(bounds.values()) == {(1.0, 1000.0)}
