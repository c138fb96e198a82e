"""Words on held-out real clips.

Figures of 618 other clips with consistent labels: top-3 .96, F .83, MAP .57; prior .50; cca as
printed .32, .11, .36. The labels of our clips differ as between annotators: a model that knows the
task and style of each clip would reach .99, .77, .46 (with the mean labels of similar clips).
Across sources, a cell is chance at the share of clips in parentheses.
"""

from __future__ import annotations

import time
from itertools import permutations

import numpy as np
import pytest

from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.movement_signs import movement_signs
from app.analysis.symbols.channels import symbol_features, symbol_statistics
from app.analysis.symbols.symbol import describe_symbol, symbol_from_arrays
from app.errors import BadContent
from app.formats.read import read_recording
from app.models.folds import recording_of
from app.models.held_out.ranking import average_precision
from app.models.held_out.words import WordEvaluation, WordFigures, held_out_word_figures
from app.models.words.calibration import calibrate
from app.models.words.library import default_scores
from app.models.words.model import fit_word_model
from app.models.words.symbol_space import symbol_distances
from app.models.words.vocabulary import WordVocabulary
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import BodyTrack, smooth_track
from app.numerics.arrays import FloatArray
from tests.bench.page import Section
from tests.real_clips import manifest, real_clips

FIGURES = Section(
    "words",
    "Words for clips and clips for words",
    trials="all labeled real clips, held out by recording; then taught by some sources, asked of "
    "another",
    chance="the frequency of the words, printed as `prior`",
)

pytestmark = pytest.mark.bench

SOURCES = {"bandai-namco-1": "1", "bandai-namco-2": "2"}
"""The sources by the folders of the clips; all others are CMU, c."""
MARGINS = np.array([0.04, 0.07, 0.07])
"""By which the default is better than any other method, in top-3, word F and set MAP."""
TAUGHT = 4
"""Taught clips that a word needs to be asked of another source."""
ASKED = ("walk", "run", "dance", "turn", "fight", "wave", "jog", "lift", "stroll")


@pytest.fixture(scope="module")
def tracks() -> list[tuple[dict[str, str], BodyTrack]]:
    found = []
    for row in manifest():
        try:
            recording = read_recording((real_clips() / row["path"]).read_bytes())
            motion = canonicalize(recording, frame_rate=float(row["fps"]))
        except BadContent:
            continue  # a format that Kinedex does not read
        found.append((row, active_part(smooth_track(motion))))
    return found


@pytest.fixture(scope="module")
def symbols(tracks: list[tuple[dict[str, str], BodyTrack]]) -> list[dict[str, FloatArray]]:
    return [_symbol(track) for _, track in tracks]


def test_symbols_take_at_most_three_milliseconds_a_second(
    tracks: list[tuple[dict[str, str], BodyTrack]],
) -> None:
    _symbol(tracks[0][1])  # loads hmmlearn
    started = time.process_time()
    for _, track in tracks[::5]:
        _symbol(track)
    took = time.process_time() - started
    seconds = sum(track.duration for _, track in tracks[::5])
    FIGURES.print(f"\nsymbols: {1e3 * took / seconds:.2f} ms a second of motion")
    assert took / seconds < 3e-3


def test_all_divergences_of_the_library_in_seconds(symbols: list[dict[str, FloatArray]]) -> None:
    models = [symbol_from_arrays(arrays) for arrays in symbols]
    started = time.process_time()
    symbol_distances(models, models)
    took = time.process_time() - started
    FIGURES.print(f"\n{len(models)} x {len(models)} divergences: {took:.1f} s")
    assert took < 15.0


def test_words_held_out(
    tracks: list[tuple[dict[str, str], BodyTrack]], symbols: list[dict[str, FloatArray]]
) -> None:
    rows = [row for row, _ in tracks]
    found = held_out_word_figures(
        [symbol_from_arrays(arrays) for arrays in symbols],
        inputs_of(symbols),
        [row["words"].split() for row in rows],
        [recording_of(row["path"]) for row in rows],
        persons=persons_of(rows),
        sequence=lambda row: symbol_features(tracks[row][1]),
        leave_one_out=True,
    )
    FIGURES.print(f"\n{found.clips} clips, {found.words} words, {found.folds} folds")
    FIGURES.print(f"{'':14}{'top-3':>8}{'word F':>8}{'set MAP':>8}")
    for one in found.figures:
        figures = one.top_3_recognition, one.word_f, one.set_map
        FIGURES.print(f"{one.method:14}" + "".join(f"{figure:8.3f}" for figure in figures))
    print_paper(found)
    by_method = {one.method: one for one in found.figures}
    default = columns(by_method.pop("default"))
    assert (default > (0.95, 0.71, 0.52)).all()
    for other in by_method.values():
        # the default must be better than the prior and every form of cca in every column
        assert (default > columns(other) + MARGINS).all(), other.method
    assert (columns(by_method["cca"]) > (0.87, 0.28, 0.38)).all()
    assert columns(by_method["prior"])[0] < 0.5


def print_paper(found: WordEvaluation) -> None:
    """The paper's figures beside ours: label sets in-sample, top-3 with one recording left out."""
    FIGURES.print(f"\n{'in-sample, and one left out':28}{'set F':>8}{'set MAP':>8}{'top-3':>8}")
    FIGURES.print(f"{'Takano, 618 motions':28}{0.598:8.3f}{0.822:8.3f}{0.72:8.3f}")
    for one in found.in_sample:
        if one.method in found.left_out:
            left_out = found.left_out[one.method]
            FIGURES.print(f"{one.method:28}{one.set_f:8.3f}{one.set_map:8.3f}{left_out:8.3f}")
    losses = ", ".join(f"{count}: {loss:.4f}" for count, loss in found.losses.items())
    FIGURES.print(f"log loss of held-out words in the mode cca, by dimensions: {losses}")


def test_words_across_sources(
    tracks: list[tuple[dict[str, str], BodyTrack]], symbols: list[dict[str, FloatArray]]
) -> None:
    rows = [row for row, _ in tracks]
    inputs, persons = inputs_of(symbols), persons_of(rows)
    sets = [row["words"].split() for row in rows]
    groups = [recording_of(row["path"]) + persons[i] for i, row in enumerate(rows)]
    words = WordVocabulary.of(sets)
    labels = words.label_matrix(sets)
    source = np.array([SOURCES.get(row["path"].split("/")[0], "c") for row in rows])
    cells = []
    FIGURES.print(
        "\naverage precision (share of clips) of words taught by sources, asked of another"
    )
    for first, second, asked in permutations("12c", 3):
        if first > second:
            continue
        taught = np.flatnonzero((source != asked) & labels.any(axis=1))
        theirs = source == asked
        model = fit_word_model(inputs[taught], labels[taught])
        own = [groups[row] for row in taught]
        curve = calibrate(model, inputs[taught], labels[taught], own, [persons[r] for r in taught])
        scores = default_scores(model, curve, words.words, inputs[theirs])
        shown = []
        for word in ASKED:
            column = words.columns([word])[0]
            carries = labels[theirs, column] > 0.0
            if carries.any() and labels[taught, column].sum() >= TAUGHT:
                precision = average_precision(scores[:, column], carries)
                likely = (
                    float(scores[carries, column].mean()),
                    float(scores[~carries, column].mean()),
                )
                cells.append((precision, *likely))
                shown.append(f"{word} {precision:.2f} ({carries.mean():.2f})")
        FIGURES.print(f"{first}{second}>{asked}  " + ", ".join(shown))
    precision, with_word, without = np.mean(cells, axis=0)
    FIGURES.print(
        f"mean average precision {precision:.3f}; mean score of clips with the word "
        f"{with_word:.3f}, without it {without:.3f}"
    )
    assert precision > 0.55
    assert with_word > 3.0 * without


def inputs_of(symbols: list[dict[str, FloatArray]]) -> FloatArray:
    """(N, 175) the inputs of the word model."""
    names = ("symbol_statistics", "movement_signs")
    return np.array([np.concatenate([arrays[name] for name in names]) for arrays in symbols])


def persons_of(rows: list[dict[str, str]]) -> list[str]:
    """The person of each clip, with the folder of the source."""
    return [row["path"].split("/")[0] + "|" + row["person"] for row in rows]


def _symbol(track: BodyTrack) -> dict[str, FloatArray]:
    channels = symbol_features(track)
    statistics = symbol_statistics(channels, track.rate).astype(np.float32)
    signs = movement_signs(track).astype(np.float32)
    return {**describe_symbol(channels), "symbol_statistics": statistics, "movement_signs": signs}


def columns(one: WordFigures) -> FloatArray:
    return np.array([one.top_3_recognition, one.word_f, one.set_map])
