"""Common parts of the evaluation commands: the filter, and the library with a progress bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer

from app.cli.options import filter_of
from app.cli.output import progress_bar
from app.cli.settings import open_library
from app.search.index.filters import parse_filter
from app.services.library.library import Library
from app.store.clips.filter import ClipFilter

Progress = Callable[[int, int], None]
"""Called with the number of steps done and the total."""


def parsed_filter(filter_json: str | None) -> ClipFilter:
    """The filter of the option `--filter`. Without it, all clips pass. Raises BadField."""
    return parse_filter(filter_of(filter_json))


@contextmanager
def judging(context: typer.Context, label: str) -> Iterator[tuple[Library, Progress]]:
    """Open the library; also give a function that moves a progress bar with the text `label`."""
    with open_library(context) as lib, progress_bar() as bar:
        task = bar.add_task(label, total=None)
        yield lib, lambda done, total: bar.update(task, completed=done, total=total)
