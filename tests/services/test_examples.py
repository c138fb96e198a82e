"""What the demo library has besides clips."""

from __future__ import annotations

from pathlib import Path

from app.demo import demo_clips
from app.services.examples import add_examples
from app.services.library.library import Library
from app.services.views import studies
from app.services.webhooks import registry
from tests.libraries import settings_for, upload, work


def test_examples_are_added_once(tmp_path: Path) -> None:
    lib = Library.open(settings_for(tmp_path))
    upload(lib, next(demo_clips(["ada"], ["dance"], takes=1)))
    work(lib.settings)
    for _ in range(2):
        add_examples(lib)
        assert len(studies.list_pairs(lib).items) == 1
        (webhook,) = registry.list_webhooks(lib)
        assert not webhook.is_enabled
    lib.close()


def test_a_library_without_ready_clips_gets_no_pair(lib: Library) -> None:
    add_examples(lib)
    assert studies.list_pairs(lib).items == ()
