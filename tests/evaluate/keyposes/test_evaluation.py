"""Table 1 and the curves of figures 4 and 5 for annotated clips."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree

import pytest

from app.analysis.keyposes.keyposes import find_keyposes
from app.demo import DemoClip
from app.errors import BadField, NotEnoughLabels
from app.evaluate import JUDGED_KEYPOSES, judge_keyposes
from app.evaluate.keyposes.pictures import clip_figure, clips_to_draw, threshold_figure
from app.models.keyposes.matching import match
from app.services.imports.imports import import_path
from app.services.library.library import Library
from app.services.training.annotated import read_annotated
from app.store.clips.filter import ClipFilter
from tests.libraries import settings_for, work
from tests.named_dances import write_dances

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def dances(tmp_path_factory: pytest.TempPathFactory) -> list[DemoClip]:
    return write_dances(tmp_path_factory.getbasetemp() / "named")


@pytest.fixture(scope="module")
def annotated(
    tmp_path_factory: pytest.TempPathFactory, dances: list[DemoClip]
) -> Iterator[Library]:
    opened = Library.open(settings_for(tmp_path_factory.mktemp("annotated")))
    import_path(opened, tmp_path_factory.getbasetemp() / "named")
    work(opened.settings)
    yield opened
    opened.close()


def test_the_table_counts_true_and_found_keyposes(
    annotated: Library, dances: list[DemoClip]
) -> None:
    found = judge_keyposes(annotated)
    assert [clip.name for clip in found.clips] == ["dance0", "dance1", "dance2"]
    assert [clip.true for clip in found.clips] == [len(dance.keyposes) for dance in dances]
    assert [judged.method for judged in found.methods] == list(JUDGED_KEYPOSES)
    for judged in found.methods:
        counts = [clip.counts[judged.method] for clip in found.clips]
        assert judged.counts.correct == sum(each.correct for each in counts)
        assert all(each.correct <= min(each.found, each.true) for each in counts)
        assert len(judged.t1.values) == len(judged.t1.precision) == len(judged.t1.recall)
    ours, printed, _ = found.methods
    assert ours.counts.f > 0.8
    assert ours.usual.f >= printed.usual.f


def test_the_usual_thresholds_give_the_keyposes_of_the_analysis(annotated: Library) -> None:
    counts = [
        match(find_keyposes(clip.track, beats=clip.beats).times, clip.true)
        for clip in read_annotated(annotated.store)
    ]
    usual = judge_keyposes(annotated).methods[0].usual
    assert usual.found == sum(each.found for each in counts)
    assert usual.correct == sum(each.correct for each in counts)


def test_a_smaller_tolerance_matches_less_and_a_wrong_one_is_refused(annotated: Library) -> None:
    strict, usual = (judge_keyposes(annotated, tolerance=t).methods[0] for t in (0.02, 0.1))
    assert strict.usual.correct < usual.usual.correct
    for tolerance in (0.0, 2.0, float("nan")):
        with pytest.raises(BadField):
            judge_keyposes(annotated, tolerance=tolerance)


def test_without_annotated_clips_the_message_says_how_to_annotate(
    annotated: Library, ready_library: Library
) -> None:
    with pytest.raises(NotEnoughLabels, match="manifest"):
        judge_keyposes(ready_library)
    with pytest.raises(NotEnoughLabels):
        judge_keyposes(annotated, ClipFilter(task=("walk",)))


def test_the_curves_are_drawn(annotated: Library) -> None:
    curves = threshold_figure(judge_keyposes(annotated), "svg")
    assert ElementTree.fromstring(curves).tag == f"{SVG}svg"


@pytest.mark.slow
def test_clips_are_drawn_with_and_without_annotation(annotated: Library) -> None:
    drawn = {clip.name: clip for clip in clips_to_draw(annotated, None)}
    assert sorted(drawn) == ["dance0", "dance1", "dance2", "unnamed"]
    named, unnamed = (clip_figure(annotated, drawn[n], "svg") for n in ("dance0", "unnamed"))
    for picture in (named, unnamed):
        assert ElementTree.fromstring(picture).tag == f"{SVG}svg"
    assert len(named) > len(unnamed)
