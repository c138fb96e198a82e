"""The licenses that the library may give out, while a call is served.

The setting KINEDEX_ALLOWED_LICENSES names them. Searches then find no clip with another license, or
without one (`mask` of the search index), and no such clip is exported. Lists still show them, so
that people can correct a license.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from app.errors import LicenseNotAllowed


@contextmanager
def only_licenses(allowed: tuple[str, ...]) -> Iterator[None]:
    """In the block, only clips with these licenses are given out; empty: all are."""
    token = _allowed.set(allowed)
    try:
        yield
    finally:
        _allowed.reset(token)


def allowed_licenses() -> tuple[str, ...]:
    """The allowed licenses; empty if all are."""
    return _allowed.get()


def check(license: str | None) -> None:
    """Raises LicenseNotAllowed for a clip with this license, if the policy refuses it."""
    allowed = _allowed.get()
    if allowed and license not in allowed:
        named = "no license" if license is None else f"the license {license}"
        raise LicenseNotAllowed(f"The clip has {named}. Allowed are {', '.join(allowed)}.")


_allowed: ContextVar[tuple[str, ...]] = ContextVar("allowed_licenses", default=())
