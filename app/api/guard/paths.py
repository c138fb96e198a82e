"""The path of a request as routes know it."""

from __future__ import annotations

from starlette.types import Scope


def path_of(scope: Scope) -> str:
    """Without the prefix that a proxy puts before it, and without a closing slash; "/" is ""."""
    path: str = scope["path"]
    return path.removeprefix(scope.get("root_path", "")).rstrip("/")
