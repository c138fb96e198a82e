"""Keyposes of ready clips: found, annotated by people, and found with learned thresholds."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.analysis.energy.energy import EnergyMethod
from app.analysis.keyposes.candidates import Scope
from app.demo import DemoClip
from app.demo.dances import dance
from app.errors import BadField, ClipNotFound
from app.models.keyposes.thresholds import KeyposeThresholds, Thresholds
from app.services.clips import catalogue as clips
from app.services.imports.imports import import_path
from app.services.library.library import Library
from app.services.training.annotated import read_annotated
from app.services.training.keypose_learning import examples_of, learn_keyposes
from app.services.views import keyposes
from app.services.views.keyposes import ThresholdSource, annotate_keyposes, view
from app.store import models
from app.store.clips import arrays, keypose_annotations
from app.store.clips.record import ClipState
from tests.libraries import FindClip, settings_for, work


@pytest.fixture(scope="module")
def dances() -> list[DemoClip]:
    return [dance(70 + seed, bpm=bpm, seconds=10.0) for seed, bpm in enumerate((80.0, 110.0))]


@pytest.fixture(scope="module")
def danced(tmp_path_factory: pytest.TempPathFactory, dances: list[DemoClip]) -> Iterator[Library]:
    """Two ready dances. Each test removes its annotations at its end."""
    opened = Library.open(settings_for(tmp_path_factory.mktemp("danced")))
    for made in dances:
        clips.create_clip(opened, io.BytesIO(made.content), made.path, {"task": "dance"})
    work(opened.settings)
    yield opened
    opened.close()


@pytest.fixture
def ids(danced: Library) -> Iterator[list[str]]:
    found = [clip.id for clip in clips.list_clips(danced, sort="created_at").items]
    yield found
    for clip_id in found:
        annotate_keyposes(danced, clip_id, ())


def stored(lib: Library, clip_id: str, name: str) -> np.ndarray:
    with lib.store.read() as tx:
        return arrays.get_one(tx, clip_id, name)


def test_keyposes_have_poses(ready_library: Library, clip_of: FindClip) -> None:
    found = view(ready_library, clip_of("ada", "kick").id)
    assert found.poses.shape == (len(found.found.frames), 13, 3)
    assert len(found.found.chosen_by) == len(found.found.frames) > 0
    assert found.named is None
    strict = view(ready_library, clip_of("ada", "kick").id, "printed", t1=1e-6, t2=99.0)
    assert set(strict.found.chosen_by) <= {Scope.TURN}  # thresholds do not concern turning points


@pytest.mark.parametrize(
    ("given", "location"),
    [({"method": "best"}, "method"), ({"weights": "most"}, "weights"), ({"t1": np.nan}, "t1")],
)
def test_a_wrong_field_is_named(
    ready_library: Library, clip_of: FindClip, given: dict[str, object], location: str
) -> None:
    with pytest.raises(BadField) as refused:
        view(ready_library, clip_of("ada", "walk").id, **given)  # type: ignore[arg-type]
    assert refused.value.places[0].location == location


def test_annotated_keyposes_are_shown_beside_found_ones_and_are_used(
    danced: Library, ids: list[str]
) -> None:
    found = stored(danced, ids[0], "keypose_frames")
    segments = stored(danced, ids[0], "segment_spans")
    assert annotate_keyposes(danced, ids[0], [2.0, 0.5, 2.0, 4.25]) == (0.5, 2.0, 4.25)
    shown = view(danced, ids[0])
    assert shown.named == (0.5, 2.0, 4.25)
    assert shown.found.frames.tolist() == found.tolist()
    assert stored(danced, ids[0], "keypose_frames").tolist() == [15, 60, 128]
    assert stored(danced, ids[0], "segment_spans").tolist()[0] == [0.5, 2.0]
    assert annotate_keyposes(danced, ids[0], ()) == ()
    assert view(danced, ids[0]).named is None
    assert stored(danced, ids[0], "keypose_frames").tolist() == found.tolist()
    np.testing.assert_array_equal(stored(danced, ids[0], "segment_spans"), segments)


def test_an_annotation_stays_after_another_analysis(danced: Library, ids: list[str]) -> None:
    annotate_keyposes(danced, ids[0], [1.0, 3.0])
    clips.update_clip(danced, ids[0], {"frame_rate": 50.0})
    work(danced.settings)
    assert stored(danced, ids[0], "keypose_frames").tolist() == [30, 90]
    clips.update_clip(danced, ids[0], {"frame_rate": None})
    work(danced.settings)


@pytest.mark.parametrize("times", [[-0.1], [1e5], [float("nan")], list(range(10_001))])
def test_times_outside_the_clip_are_refused(
    danced: Library, ids: list[str], times: list[float]
) -> None:
    with pytest.raises(BadField) as refused:
        annotate_keyposes(danced, ids[0], times)
    assert refused.value.places[0].location == "times"
    with danced.store.read() as tx:
        assert keypose_annotations.annotated(tx) == ()


def test_a_clip_may_be_annotated_before_it_is_analyzed(
    lib: Library, dances: list[DemoClip]
) -> None:
    queued = clips.create_clip(lib, io.BytesIO(dances[0].content), "a.bvh").clip
    annotate_keyposes(lib, queued.id, [1.0])
    work(lib.settings)
    assert clips.get_clip(lib, queued.id).state is ClipState.READY
    assert stored(lib, queued.id, "keypose_frames").tolist() == [30]
    with pytest.raises(ClipNotFound):
        annotate_keyposes(lib, "clip_none", [1.0])


def learn(lib: Library, *pair: float) -> None:
    """Store thresholds as if a fit had learned them."""
    arrays, meta = KeyposeThresholds({"rms": Thresholds(*pair)}).to_arrays()
    with lib.store.write() as tx:
        models.save(
            tx, "keyposes", meta={"model": meta}, arrays=arrays, library_version=1, library_size=1
        )


def forget_learned(lib: Library) -> None:
    with lib.store.write() as tx:
        models.remove(tx, ["keyposes"])
    work(lib.settings)


def test_thresholds_have_a_source_given_learned_or_default(danced: Library, ids: list[str]) -> None:
    usual = view(danced, ids[0]).thresholds
    assert (usual.t1_source, usual.t2_source) == (ThresholdSource.DEFAULT,) * 2
    learn(danced, 0.4, 1.5)
    waiting = view(danced, ids[0]).thresholds
    assert (waiting.t1_source, waiting.model_version) == (ThresholdSource.DEFAULT, None)
    work(danced.settings)
    learned = view(danced, ids[0], t2=0.9)
    assert learned.thresholds.values == Thresholds(0.4, 0.9)
    assert learned.thresholds.t1_source is ThresholdSource.LEARNED
    assert learned.thresholds.t2_source is ThresholdSource.GIVEN
    assert learned.thresholds.model_version == 1
    assert (learned.found.t1, learned.found.t2) == (0.4, 0.9)
    assert view(danced, ids[0], "printed").thresholds.t1_source is ThresholdSource.DEFAULT
    assert view(danced, ids[0], t1=1.0, t2=1.0).thresholds.model_version is None
    learn(danced, 0.3, 1.5)
    older = view(danced, ids[0]).thresholds
    assert older.values == Thresholds(0.4, 1.5)
    assert (older.t1_source, older.model_version) == (ThresholdSource.LEARNED, None)
    forget_learned(danced)


def test_analyses_use_learned_thresholds_and_default_ones_after_them(
    danced: Library, ids: list[str]
) -> None:
    before = stored(danced, ids[1], "keypose_frames")
    learn(danced, 1e-6, 99.0)
    work(danced.settings)
    assert len(stored(danced, ids[1], "keypose_frames")) == 0
    forget_learned(danced)
    np.testing.assert_array_equal(stored(danced, ids[1], "keypose_frames"), before)


def test_figures_are_held_out_by_recording(
    danced: Library, ids: list[str], dances: list[DemoClip]
) -> None:
    annotate_keyposes(danced, ids[0], dances[0].keyposes)
    _, alone = learn_keyposes(read_annotated(danced.store))
    assert alone["clips"] == 1
    assert "reason" in alone
    assert "learned" not in alone["methods"]["rms"]
    annotate_keyposes(danced, ids[1], dances[1].keyposes)
    _, both = learn_keyposes(read_annotated(danced.store))
    assert both["methods"]["rms"]["learned"]["f"] > 0.85
    assert both["methods"]["rms"]["learned"]["true"] == sum(len(d.keyposes) for d in dances)


def test_a_clips_beats_are_used_to_find_learn_and_judge_keyposes(
    danced: Library, ids: list[str], dances: list[DemoClip]
) -> None:
    annotate_keyposes(danced, ids[0], dances[0].keyposes)
    (before,) = read_annotated(danced.store)
    clips.update_clip(danced, ids[0], {"beats": dances[0].beats})
    work(danced.settings)
    (annotated,) = read_annotated(danced.store)
    assert before.beats is not None
    assert annotated.beats is not None
    assert (before.beats.source in ("motion", "none"), annotated.beats.source) == (True, "given")
    (example,) = examples_of([annotated], EnergyMethod.RMS)
    found = view(danced, ids[0]).found
    assert found.beats.source == "given"
    assert example.candidates.times(found.t1, found.t2).tolist() == found.times.tolist()
    clips.update_clip(danced, ids[0], {"beats": None})
    work(danced.settings)


def test_a_manifest_names_keyposes(lib: Library, tmp_path: Path, dances: list[DemoClip]) -> None:
    folder = tmp_path / "set"
    folder.mkdir()
    (folder / "a.bvh").write_bytes(dances[0].content)
    (folder / "b.bvh").write_bytes(dances[1].content)
    (folder / "manifest.csv").write_text("path,keyposes\na.bvh,2.5 1 1.75\nb.bvh,\n")
    import_path(lib, folder)
    by_name = {clip.name: clip.id for clip in clips.list_clips(lib).items}
    with lib.store.read() as tx:
        assert keypose_annotations.get(tx, by_name["a"]) == (1.0, 1.75, 2.5)
        assert keypose_annotations.get(tx, by_name["b"]) is None
    # The same files again change nothing of what was said since.
    annotate_keyposes(lib, by_name["a"], [3.0])
    import_path(lib, folder)
    with lib.store.read() as tx:
        assert keypose_annotations.get(tx, by_name["a"]) == (3.0,)


def test_keyposes_need_no_fitted_model(danced: Library, ids: list[str]) -> None:
    assert keyposes.thresholds(danced, ids[0]).model_version is None
