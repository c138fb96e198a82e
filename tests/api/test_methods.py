"""405 lists the methods of a path, and none of another path whose parameter has such a value."""

from __future__ import annotations

from typing import Any

import httpx2

from app.api.app import create_app
from app.config import Settings
from tests.api.conftest import assert_problem

METHODS = ["GET", "POST", "PUT", "PATCH", "DELETE", "QUERY"]
PATHS: dict[str, dict[str, Any]] = create_app(Settings()).openapi()["paths"]


def test_405_lists_the_methods_that_are_described(idle: httpx2.Client) -> None:
    for path, item in PATHS.items():
        allowed = sorted(method for method in METHODS if method.lower() in item)
        url = path.replace("{side}", "left").replace("{", "").replace("}", "")
        for method in set(METHODS) - set(allowed):
            answer = idle.request(method, url)
            assert_problem(answer, 405, "method_not_allowed")
            assert answer.headers["allow"].split(", ") == allowed, (method, path)
            assert answer.headers["allow"] in answer.json()["detail"]
