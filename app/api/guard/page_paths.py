"""Which addresses show a page: `/`, `/docs`, and those of the application in `app/web`."""

from __future__ import annotations

DOCS = "/docs"
PAGE_NAMES = (
    "clips",
    "search",
    "map",
    "todo",
    "collections",
    "models",
    "compare",
    "study",
    "make",
    "live",
)
"""The first part of a page's address; `app/web/src/pages/pages.ts` names the same."""


def is_page(path: str) -> bool:
    """Whether a page stands at a path as `path_of` gives it."""
    return path in {"", DOCS} or path.removeprefix("/").partition("/")[0] in PAGE_NAMES
