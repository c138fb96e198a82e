"""Every call has a kind, by which it is let in after all else was checked."""

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
    "/v1/search/motion",
    "/v1/search/pose",
    "/v1/search/words",
    "/v1/recognize",
    "/v1/synthesize",
    "/v1/space",
    "/v1/clips/{clip_id}/motion",
    "/v1/clips/{clip_id}/export",
    "/v1/clips/{clip_id}/low-dimensional",
    "/v1/clips/{clip_id}/segments",
    "/v1/studies/low-dimensional/pairs/{pair_id}/{side}",
}
"""Those that take longest on a long clip."""
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


def _told(app: FastAPI, route: APIRoute) -> dict[str, Any]:
    """Of the OpenAPI description."""
    (method,) = route.methods
    told: dict[str, Any] = app.openapi()["paths"][route.path_format][method.lower()]
    return told


def test_every_call_has_one_kind(routes: list[APIRoute]) -> None:
    assert {route.path: len(_kinds(route)) for route in routes} == {
        route.path: 1 for route in routes
    }


def test_no_call_of_the_description_is_left_out(app: FastAPI, routes: list[APIRoute]) -> None:
    described = {
        (method.upper(), path) for path, told in app.openapi()["paths"].items() for method in told
    }
    assert described <= {
        (method, route.path_format) for route in routes for method in route.methods
    }


def test_a_call_is_let_in_when_its_key_was_checked_and_its_form_has_come(
    routes: list[APIRoute],
) -> None:
    for route in routes:
        calls = [dependant.call for dependant in route.dependant.dependencies]
        place = next(i for i, call in enumerate(calls) if isinstance(call, Admission))
        solved = {*calls[:place], get_library}  # what comes again was kept; that takes no time
        assert set(calls[place + 1 :]) <= solved, route.path


def test_what_takes_long_is_heavy(routes: list[APIRoute]) -> None:
    kinds = {route.path: _kinds(route)[0] for route in routes if route.path in HEAVY}
    assert kinds == dict.fromkeys(HEAVY, Kind.HEAVY)


def test_whether_it_lives_and_is_ready_is_told_without_a_gate(routes: list[APIRoute]) -> None:
    kinds = {route.path: _kinds(route)[0] for route in routes}
    assert kinds["/livez"] is kinds["/readyz"] is Kind.AT_ONCE


def test_who_may_be_refused_says_so(app: FastAPI, routes: list[APIRoute]) -> None:
    for route in routes:
        if route.include_in_schema and _kinds(route)[0] in GATED:
            assert "503" in _told(app, route)["responses"], route.path


def test_every_frame_rate_that_can_be_asked_for_has_the_same_bounds(
    app: FastAPI, routes: list[APIRoute]
) -> None:
    bounds = {}
    for route in routes:
        told = _told(app, route) if route.include_in_schema else {}
        for parameter in told.get("parameters", []):
            if parameter["name"] == "fps":
                number = next(s for s in parameter["schema"]["anyOf"] if s["type"] == "number")
                bounds[route.path] = number["minimum"], number["maximum"]
    assert len(bounds) == 4
    assert set(bounds.values()) == {(1.0, 1000.0)}
