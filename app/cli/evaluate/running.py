"""How every evaluation begins: which clips are meant, and the library with a progress bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer

from app.cli.find import filter_of
from app.cli.output import progress_bar
from app.cli.settings import open_library
from app.search.index.filters import parse_filter
from app.services.library.library import Library
from app.store.clips.filter import ClipFilter

Progress = Callable[[int, int], None]
"""Is told how many steps are done, of how many."""


def parsed_filter(filter_json: str | None) -> ClipFilter:
    """The clips that `--filter` means, all without it. Raises BadField."""
    return parse_filter(filter_of(filter_json))


@contextmanager
def judging(context: typer.Context, doing: str) -> Iterator[tuple[Library, Progress]]:
    """The library of the settings, and what moves a bar that says what is being done."""
    with open_library(context) as lib, progress_bar() as bar:
        task = bar.add_task(doing, total=None)
        yield lib, lambda done, total: bar.update(task, completed=done, total=total)
