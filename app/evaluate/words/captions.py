"""Clips ranked by held-out captions: sentences about clips that the library does not store."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.models.held_out.captions import CaptionFigures, caption_figures
from app.numerics.arrays import FloatArray
from app.search.index.labels import LabelView
from app.services import fields
from app.services.find.by_words import measure, probabilities
from app.services.find.find import word_mode
from app.services.library.library import Library
from app.services.training.training_set import ready_only
from app.store.clips import listing as clip_listing
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

PATH, CAPTIONS = ("path", "id", "name"), ("caption", "captions")
"""The columns of a file of captions: the clip, by any of these, and one or several captions."""


@dataclass(frozen=True, slots=True)
class CaptionEvaluation:
    """Figures by protocol. unknown: clips of the file that the library does not have; stored:
    captions that were left out, since the library stores them; silent: captions of which the word
    model knows no word, which rank all clips alike."""

    mode: str
    figures: tuple[CaptionFigures, ...]
    unknown: tuple[str, ...]
    stored: int
    silent: int


def judge_captions(
    lib: Library, file: Path, mode: str = "default", filter: ClipFilter | None = None
) -> CaptionEvaluation:
    """Rank the ready clips that pass the filter by each caption of a CSV file.

    Raises BadField for a file without usable captions, ModelNotFitted, and NotEnoughLabels.
    """
    mode = word_mode(mode)
    lib.index.catch_up(lib.store)
    labels = lib.index.state[1].labels
    clip_filter = ready_only(filter)
    with lib.store.read() as tx:
        records = clips.get_many(tx, sorted(clip_listing.list_ids(tx, clip_filter)))
    column_of = {clip_id: column for column, clip_id in enumerate(records)}
    found, unknown, stored = [], [], 0
    by_name = _by_name(records.values())
    for name, text in _read(file):
        clip = by_name.get(name)
        if clip is None:
            unknown.append(name)
        elif text in clip.captions:
            stored += 1
        else:
            found.append((column_of[clip.id], text))
    if not found:
        raise fields.bad_field("file", "holds no caption of a clip of this library")
    captions = [text for _, text in found]
    scores, silent = _scores(lib, labels, list(records), captions, mode)
    own = np.array([column for column, _ in found])
    figures = caption_figures(scores, own, captions)
    return CaptionEvaluation(mode, figures, tuple(dict.fromkeys(unknown)), stored, silent)


def _scores(
    lib: Library, labels: LabelView, ids: Sequence[str], captions: Sequence[str], mode: str
) -> tuple[FloatArray, int]:
    """(Q, N) probabilities that clips `ids` carry the words of captions, and how many captions
    have no known word; 0 for clips that the model does not know."""
    fitted = lib.models.words(lib.store)
    numbers = labels.find(np.array(ids, dtype=object))
    mask = np.zeros(len(labels.ids), dtype=bool)
    mask[numbers[numbers >= 0]] = True
    scores, silent = np.zeros((len(captions), len(ids))), 0
    for row, text in enumerate(captions):
        asked = fitted.model.ask([text])
        if not asked.items:
            silent += 1
            continue
        rows, distances = measure(lib, fitted, labels, mask, asked, mode)
        every = np.zeros(len(labels.ids))
        every[rows] = probabilities(fitted.model, asked, mode, distances)
        scores[row] = np.where(numbers >= 0, every[numbers], 0.0)
    return scores, silent


def _by_name(records: Iterable[ClipRecord]) -> dict[str, ClipRecord]:
    """The clips by id and path, and by their name if only one has it."""
    every = list(records)
    names: dict[str, ClipRecord | None] = {}
    for clip in every:
        names[clip.name] = None if clip.name in names else clip
    found = {name: clip for name, clip in names.items() if clip is not None}
    found |= {clip.path: clip for clip in every if clip.path}
    return found | {clip.id: clip for clip in every}


def _read(file: Path) -> Iterator[tuple[str, str]]:
    """(clip, caption) for each caption of a CSV file. Raises BadField for another file."""
    try:
        with file.open(encoding="utf-8-sig", newline="") as lines:
            table = csv.DictReader(lines)
            header = tuple(name.strip().lower() for name in table.fieldnames or ())
            table.fieldnames = header
            path = next((name for name in PATH if name in header), None)
            texts = next((name for name in CAPTIONS if name in header), None)
            if path is None or texts is None:
                expected = f"{' or '.join(PATH)}, and {' or '.join(CAPTIONS)}"
                raise fields.bad_field("file", f"must be a CSV file with the columns {expected}")
            for row in table:
                for text in fields.captions(row[texts] or "") or ():
                    yield (row[path] or "").strip(), text
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise fields.bad_field("file", f"cannot be read: {error}") from error
