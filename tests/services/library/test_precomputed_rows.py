"""Outputs of a model that are stored with it are read for all clips that did not change since."""

from __future__ import annotations

import numpy as np
import pytest

from app.demo import DemoClip
from app.services.clips.catalogue import update_clip
from app.services.find import by_words as word_ranking
from app.services.find.find import find_words
from app.services.find.queries import WordQuery
from app.services.library.library import Library
from app.services.library.precomputed_rows import OUTPUTS, POINTS, read_precomputed
from app.services.training.models import request_fit
from tests.libraries import upload, work


def test_the_first_search_computes_outputs_only_for_changed_clips(
    lib: Library, some_demo_clips: list[DemoClip], monkeypatch: pytest.MonkeyPatch
) -> None:
    ids = [upload(lib, clip).clip.id for clip in some_demo_clips[:6]]
    request_fit(lib)
    work(lib.settings)
    computed: list[list[str]] = []
    predict = word_ranking._predict

    def watched(lib, model, clip_ids):  # type: ignore[no-untyped-def]
        computed.append(clip_ids)
        return predict(lib, model, clip_ids)

    monkeypatch.setattr(word_ranking, "_predict", watched)
    word = next(word for clip in some_demo_clips[:6] for word in clip.words)
    first = find_words(lib, WordQuery([word]))
    assert computed == []
    assert all(0 < hit.score < 1 for hit in first.items)
    update_clip(lib, ids[0], {"words": ["something"]})
    model = lib.models.words(lib.store)
    for name in (OUTPUTS, POINTS):
        unchanged, rows = read_precomputed(lib, model.id, name)
        assert set(unchanged) == set(ids[1:])
        assert len(rows) == 5
    outputs = predict(lib, model.model, ids[1:])
    unchanged, rows = read_precomputed(lib, model.id, OUTPUTS)
    for clip_id, row in zip(unchanged, rows, strict=True):
        np.testing.assert_allclose(row, outputs[clip_id], atol=1e-6)
