"""Curation on real clips: planted near-duplicates, clips made bad on purpose, 100,000 clips.

Run: pytest -m bench -s tests/bench/test_curation.py
All real clips of the folder are imported, and copies of some of them. Persons are split in two
halves: the limits of `app/search/duplicates/kinds.py` and the definitions of the measures were
chosen on the persons of one half, and the figures are of the other half. "Person" is the source and
the label; of CMU the subject.
"""

from __future__ import annotations

import hashlib
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import rankdata

from app.analysis.analyze import analyze
from app.analysis.descriptors.moments import WIDTH
from app.config import Settings
from app.formats.npz.writer import write_npz
from app.formats.read import read_recording
from app.models.recognition.disturbances import Disturb, jitter, kept, noise, with_positions
from app.motion.canonical.canonical import canonicalize
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.resampling import resample
from app.numerics.binomial import wilson_interval
from app.search.duplicates.candidates import by_moments, by_vectors
from app.search.duplicates.kinds import PairKind
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.curation import comparison, duplicates
from app.services.imports import imports
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.services.views.export import export
from app.services.views.export_format import ExportFormat
from app.store.clips.record import ClipRecord, ClipState
from app.worker.loop import run_worker
from tests.bench.page import Section
from tests.real_clips import manifest, real_clips

FIGURES = Section(
    "curation",
    "Curation: near-duplicates and measures",
    trials="one planted copy of a kind for each drawn clip, numbers printed; bad clips beside all"
    " clips of the half",
    chance="a random pair is a copy with probability .0001; AUC .5",
)
pytestmark = pytest.mark.bench

COPIES = 40
"""Clips of each half that are copied in each way."""
MIN_SECONDS = 3.0
"""Clips that are cut; a cut keeps at least 1.5 s."""
CLIPS, MOMENTS = 100_000, 8


def is_held_out(row: dict[str, str]) -> bool:
    """Whether a person's clips are of the half that is reported."""
    subject = Path(row["path"]).stem.split("_")[0] if row["path"].startswith("cmu") else ""
    key = f"{row['source']}/{row['person']}/{subject}"
    return hashlib.sha256(key.encode()).digest()[0] % 2 == 1


def mirror(motion: Motion, _: int) -> Motion:
    roles = {role.mirrored(): joint for role, joint in motion.roles.items()}
    positions = motion.positions * np.array([-1.0, 1.0, 1.0], dtype=np.float32)
    return replace(motion, positions=positions, roles=roles)


def other_rate(motion: Motion, seed: int) -> Motion:
    rate = (24.0, 25.0, 50.0, 100.0)[seed % 4]
    positions = resample(motion.positions.astype(np.float64), motion.frame_rate, rate)
    return replace(with_positions(motion, positions), frame_rate=rate)


COPIED: dict[str, Disturb] = {
    "rate": other_rate,
    "first 70 %": kept(0.0, 0.7),
    "last 60 %": kept(0.4, 1.0),
    "middle half": kept(0.25, 0.75),
    "mirror": mirror,
    "noise 3 mm": noise(3.0),
    "noise 5 mm": noise(5.0),
}
CUT = ("first 70 %", "last 60 %", "middle half")


def sliding(motion: Motion, seed: int) -> Motion:
    """The whole body slides by .5 m/s."""
    angle = np.random.default_rng(seed).uniform(0, 2 * np.pi)
    way = 0.5 * np.arange(motion.frames) / motion.frame_rate
    moved = np.stack([np.cos(angle) * way, 0 * way, np.sin(angle) * way], axis=1)
    return with_positions(motion, motion.positions + moved[:, None])


def sunk(motion: Motion, _: int) -> Motion:
    """Both feet sink by 10 cm in the last 35 % of the clip."""
    start = 0.65 * motion.frames
    depth = 0.1 * np.clip((np.arange(motion.frames) - start) / (0.05 * motion.frames), 0, 1)
    feet = (JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT, JointRole.LEFT_TOES, JointRole.RIGHT_TOES)
    positions = np.array(motion.positions)
    for joint in {motion.roles[role] for role in feet if role in motion.roles}:
        positions[:, joint, 1] -= depth
    return with_positions(motion, positions)


MADE_BAD: tuple[tuple[str, str, Disturb], ...] = (
    ("feet slide by .5 m/s", "foot_skate", sliding),
    ("feet sunk by 10 cm", "ground_penetration", sunk),
    ("noise 10 mm", "jitter", noise(10.0)),
    ("joints turned by 1 degree", "jitter", jitter(1.0)),
)


@dataclass(frozen=True)
class Planted:
    """A library of real clips and copies. truth: pairs of paths of copies, with the kind."""

    lib: Library
    held_out: dict[str, bool]
    truth: dict[frozenset[str], str]


def _work(lib: Library, folder: Path) -> None:
    job = imports.import_path(lib, folder)
    run_worker(
        replace_settings(lib),
        threading.Event(),
        until=lambda _: jobs.get_job(lib, job.id).finished_at is not None,
    )


def replace_settings(lib: Library) -> Settings:
    return lib.settings.model_copy(update={"analysis_processes": 1})


def _records(lib: Library) -> list[ClipRecord]:
    found = clips.list_clips(lib, limit=1000)
    items = list(found.items)
    while found.next is not None:
        found = clips.list_clips(lib, limit=1000, cursor=found.next)
        items += found.items
    return [clip for clip in items if clip.state is ClipState.READY]


@pytest.fixture(scope="module")
def planted(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Planted]:
    folder = tmp_path_factory.mktemp("curation")
    lib = Library.open(Settings(data_dir=folder / "data", refit_growth=1e9))
    _work(lib, real_clips())
    halves = {row["path"]: is_held_out(row) for row in manifest()}
    truth: dict[frozenset[str], str] = {}
    rng = np.random.default_rng(0)
    target = folder / "copies"
    target.mkdir()
    for half in (False, True):
        pool = sorted(
            (c for c in _records(lib) if halves.get(str(c.path)) is half), key=lambda c: str(c.path)
        )
        for kind, copied in (*COPIED.items(), ("glb", None)):
            usable = [c for c in pool if kind not in CUT or (c.duration or 0) >= MIN_SECONDS]
            for place in rng.choice(len(usable), min(COPIES, len(usable)), replace=False).tolist():
                clip = usable[place]
                name = f"{kind} of {clip.full_name}".replace("/", "_")
                name = f"{name}.{'glb' if copied is None else 'npz'}"
                (target / name).write_bytes(_copy(lib, clip, copied, place))
                halves[name] = half
                truth[frozenset((str(clip.path), name))] = kind
    _work(lib, target)
    yield Planted(lib, halves, truth)
    lib.close()


def _copy(lib: Library, clip: ClipRecord, copied: Disturb | None, seed: int) -> bytes:
    if copied is None:
        exported = export(lib, clip.id, ExportFormat.GLB)
        return b"".join(exported.blocks)
    motion = copied(load_motion(lib, clip), seed)
    names = list(motion.names)
    for role, joint in motion.roles.items():
        names[joint] = role.value  # the reader finds the sides by name
    return write_npz(names, motion.parents, motion.positions, motion.frame_rate)


def test_planted_copies_are_found_and_nothing_else(planted: Planted) -> None:
    lib = planted.lib
    began, compared = time.process_time(), 0
    while some := list(comparison.compare_pending(lib)):
        compared += some[-1]
    seconds = time.process_time() - began
    path_of = {clip.id: str(clip.path) for clip in _records(lib)}
    found: dict[frozenset[str], str] = {}
    for pair in _pairs(lib):
        found[frozenset((path_of[pair.clip_id], path_of[pair.other_id]))] = pair.kind
    allowed = _allowed(planted.truth)
    for half in (False, True):
        title = "held-out persons" if half else "persons of the choice"
        truth = {p: k for p, k in planted.truth.items() if planted.held_out[min(p)] is half}
        FIGURES.print(f"\nPlanted copies, {title}: found of planted")
        for kind in (*COPIED, "glb"):
            mine = [pair in found for pair, name in truth.items() if name == kind]
            low, high = wilson_interval(sum(mine), len(mine))
            FIGURES.print(f"  {kind:12}{sum(mine):4} of {len(mine):3}   {low:.3f} to {high:.3f}")
        mine = [pair in found for pair in truth]
        here = [pair for pair in found if planted.held_out.get(min(pair)) is half]
        wrong = [pair for pair in here if pair not in allowed]
        recall, precision = float(np.mean(mine)), 1 - len(wrong) / max(len(here), 1)
        FIGURES.print(
            f"  recall {recall:.3f} of {len(mine)}, precision {precision:.3f} of {len(here)}"
        )
        for pair in wrong[:12]:
            FIGURES.print(f"    wrong: {found[pair]}: {' | '.join(sorted(pair))}")
    FIGURES.print(f"\n{compared} clips compared: {seconds:.0f} s of processor time")
    assert recall >= 0.98
    assert precision >= 0.98


def _pairs(lib: Library) -> Iterator[duplicates.DuplicatePair]:
    cursor = None
    while True:
        page = duplicates.list_groups(lib, limit=1000, cursor=cursor).page
        for group in page.items:
            yield from (pair for pair in group.pairs if pair.kind != PairKind.SIMILAR)
        if (cursor := page.next) is None:
            return


def _allowed(truth: dict[frozenset[str], str]) -> set[frozenset[str]]:
    """All pairs among a clip and its copies, and the takes of CMU that the folder has twice."""
    families: dict[str, set[str]] = {}
    for pair in truth:
        copy = next(path for path in pair if " of " in path)
        (original,) = pair - {copy}
        families.setdefault(original, {original}).add(copy)
    for take in ("02_01", "02_03", "02_04"):
        bvh, amc = f"cmu-bvh/{take}.bvh", f"cmu-asfamc/{take}.amc"
        both = families.pop(bvh, {bvh}) | families.pop(amc, {amc})
        families[bvh] = both
    return {
        frozenset((one, other))
        for family in families.values()
        for one in family
        for other in family
        if one != other
    }


def test_clips_made_bad_are_told_from_good_ones() -> None:
    rows = [row for row in manifest() if row["path"].endswith(".bvh")]
    aucs = []
    for half in (False, True):
        motions = [
            canonicalize(
                read_recording((real_clips() / row["path"]).read_bytes()),
                frame_rate=float(row["fps"]),
            )
            for row in rows
            if is_held_out(row) is half
        ]
        good = [_quality(motion) for motion in motions]
        title = "held-out persons" if half else "persons of the choice"
        FIGURES.print(f"\nClips made bad, {title}: AUC ({len(motions)} good, as many bad)")
        for name, measure, disturb in MADE_BAD:
            bad = [_quality(disturb(motion, seed)) for seed, motion in enumerate(motions)]
            auc = _auc([one[measure] for one in good], [one[measure] for one in bad])
            FIGURES.print(f"  {name:28}{measure:20}{auc:.4f}")
            if half:
                aucs.append(auc)
    assert min(aucs) >= 0.99


def _quality(motion: Motion) -> dict[str, float]:
    found = analyze(motion).quality or {}
    return {name: np.nan if value is None else value for name, value in found.items()}


def _auc(good: list[float], bad: list[float]) -> float:
    values = np.array([*good, *bad])
    known = np.isfinite(values)
    is_bad = (np.arange(len(values)) >= len(good))[known]
    ranks = rankdata(values[known])
    pairs = is_bad.sum() * (~is_bad).sum()
    return float((ranks[is_bad].sum() - is_bad.sum() * (is_bad.sum() + 1) / 2) / pairs)


@pytest.mark.parametrize("name", ["vectors", "moments"])
def test_a_hundred_thousand_clips_take_minutes(name: str) -> None:
    """Random vectors in clusters, as clips of tasks are; every hundredth clip is a copy."""
    rng = np.random.default_rng(0)
    asked = np.arange(CLIPS)
    find: Callable[[], set[object]]
    if name == "vectors":
        centers = rng.normal(size=(300, 128))
        vectors = centers[rng.integers(300, size=CLIPS)] + 0.3 * rng.normal(size=(CLIPS, 128))
        vectors[1::100] = vectors[::100] + 0.01 * rng.normal(size=vectors[::100].shape)
        find = lambda: by_vectors(vectors, asked)  # noqa: E731
    else:
        centers = rng.normal(size=(3000, WIDTH)) * 0.06
        rows = CLIPS * MOMENTS
        points = centers[rng.integers(3000, size=rows)] + 0.02 * rng.normal(size=(rows, WIDTH))
        points = points.reshape(CLIPS, MOMENTS, WIDTH)
        points[1::100] = points[::100] + 0.002 * rng.normal(size=points[::100].shape)
        owners = np.repeat(asked, MOMENTS)
        find = lambda: by_moments(points.reshape(-1, WIDTH), owners, asked)  # noqa: E731
    began = time.process_time()
    found = find()
    seconds = time.process_time() - began
    pairs = {(one.one, one.other) for one in found}
    copies = [(first, first + 1) in pairs for first in range(0, CLIPS, 100)]
    FIGURES.print(
        f"\n{CLIPS:,} clips by {name}: {seconds:.0f} s of processor time, {len(pairs):,}"
        f" candidates, {sum(copies)} of {len(copies)} copies among them"
    )
    assert np.mean(copies) >= 0.98
    assert seconds < 900
