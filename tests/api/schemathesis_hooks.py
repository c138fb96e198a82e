"""Hooks of Schemathesis (`test_schemathesis.py`)."""

from __future__ import annotations

from typing import Any

import schemathesis


@schemathesis.hook
def map_query(_: schemathesis.HookContext, query: dict[str, Any]) -> dict[str, Any]:
    """Without `fields`: it leaves out members that the schema of the answer requires."""
    return {name: value for name, value in (query or {}).items() if name != "fields"}
