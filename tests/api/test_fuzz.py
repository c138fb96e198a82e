"""Calls that schemathesis generates from the description: answers are as described, no 5xx."""

from __future__ import annotations

import pytest
import requests
import schemathesis
from hypothesis import HealthCheck, given, settings
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from app.api.app import create_app
from app.config import Settings
from tests.live import Live

CHECKS = [
    not_a_server_error,
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
]


SCHEMA = schemathesis.openapi.from_dict(create_app(Settings()).openapi())
# The events of a job that no worker takes would never end.
OPERATIONS = [
    (path, method)
    for path, item in SCHEMA.raw_schema["paths"].items()
    for method in item
    if not path.endswith("/events")
]


@pytest.mark.parametrize(("path", "method"), OPERATIONS)
def test_calls_are_answered_as_described(idle_service: Live, path: str, method: str) -> None:
    session = requests.Session()
    session.trust_env = False

    @settings(
        max_examples=15,
        deadline=None,
        derandomize=True,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(case=SCHEMA[path][method.upper()].as_strategy())
    def call(case: schemathesis.Case) -> None:
        case.query.pop("fields", None)  # it leaves out members that the schema requires
        case.call_and_validate(base_url=idle_service.url, session=session, checks=CHECKS)

    with session:
        call()
