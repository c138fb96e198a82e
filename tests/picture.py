"""The README's picture: a search by example in the demo library.

`make picture` makes the demo library in a temporary directory, searches it, and writes
`.github/search.svg`.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from app.cli.library import follow, register, working
from app.config import load_settings
from app.demo.library import write_demo
from app.services.figures.stick_figure import TRUNK, text
from app.services.figures.thumbnail import HEIGHT, WIDTH
from app.services.find.find import find_motion
from app.services.find.hits import Hits
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.views.views import thumbnail_svg
from app.store.clips import listing as clip_listing
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

PICTURE = Path(__file__).resolve().parents[1] / ".github" / "search.svg"
PERSON, NAME = "chika", "kick_01"
COLUMNS, HITS = 3, 5
GAP = 4
"""Pixels between the figures."""
_TITLE = re.compile("<title>.*?</title>")


@contextmanager
def demo_library() -> Iterator[Library]:
    """The whole demo library, analyzed, in a temporary directory."""
    with tempfile.TemporaryDirectory() as folder:
        files, data = Path(folder) / "files", Path(folder) / "data"
        write_demo(files)
        lib = Library.open(load_settings(data_dir=data))
        try:
            job = register(lib, files)
            with working(lib):
                follow(lib, job.id, "analyzing")
            yield lib
        finally:
            lib.close()


def search(lib: Library) -> tuple[ClipRecord, Hits]:
    """The query clip and its hits."""
    with lib.store.read() as tx:
        page = clip_listing.list_clips(tx, ClipFilter(person=(PERSON,), q=NAME), limit=1)
    (query,) = page.items
    return query, find_motion(lib, MotionQuery(QuerySource(query.id), limit=HITS))


def captions(query: ClipRecord, hits: Hits) -> list[str]:
    """The line above each figure: the query's, then each hit's."""
    found = [
        f"{hit.rank}. {hit.clip.person}, {hit.clip.name}: score {hit.score:.2f}"
        for hit in hits.items
    ]
    return [f"query: {query.person}, {query.name}", *found]


def picture(lib: Library) -> str:
    """The SVG: the query and its hits, each as a thumbnail with a caption."""
    query, hits = search(lib)
    clips = [query, *(hit.clip for hit in hits.items)]
    rows = -(-len(clips) // COLUMNS)
    width, height = COLUMNS * (WIDTH + GAP) - GAP, rows * (HEIGHT + GAP) - GAP
    cells = "".join(
        _cell(number, thumbnail_svg(lib, clip.id), caption)
        for number, (clip, caption) in enumerate(zip(clips, captions(query, hits), strict=True))
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}" font-family="sans-serif">'
        "<title>A search by example in the demo library</title>"
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>{cells}</svg>\n'
    )


def _cell(number: int, thumbnail: str, caption: str) -> str:
    x, y = number % COLUMNS * (WIDTH + GAP), number // COLUMNS * (HEIGHT + GAP)
    figure = _TITLE.sub("", thumbnail).replace("<svg ", f'<svg x="{x}" y="{y}" ', 1)
    weight = ' font-weight="bold"' if number == 0 else ""
    label = f'<text x="{x + 10}" y="{y + 18}" font-size="12" fill="{TRUNK}"{weight}>'
    return f"{figure}{label}{text(caption)}</text>"


if __name__ == "__main__":
    with demo_library() as library:
        PICTURE.write_text(picture(library))
