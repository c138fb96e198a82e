"""Curation on real clips: planted near-duplicates, clips made bad on purpose, 100,000 clips.

Run: pytest -m bench -s tests/bench/test_curation.py
All real clips of the folder and copies of some of them are compared with each other. Persons are
split in two halves: the limits of `app/search/duplicates/kinds.py` and the definitions of the
measures were chosen on the persons of one half (and on trials without copies on a third of all
clips), and the figures are of the other half. "Person" is the source and the label; of CMU the
subject.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import rankdata

from app.analysis.analyze import describe_for_search
from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.moments import WIDTH, moments
from app.analysis.descriptors.movement_signs import movement_signs
from app.analysis.quality.measure import measure_quality
from app.formats.npz.writer import write_npz
from app.formats.read import read_recording
from app.models.recognition.disturbances import Disturb, jitter, kept, noise, with_positions
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import body_track, smooth_track
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.resampling import resample
from app.numerics.binomial import wilson_interval
from app.search.duplicates.candidates import Candidate, by_moments, by_vectors
from app.search.duplicates.kinds import ClipFacts, PairKind, kind_of
from app.search.duplicates.overlay import mirrored_features, overlay
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
    """n real clips and copies, with what the comparison reads of each.

    names: (n,) paths, of a copy "KIND of PATH"; held_out: (n,) the half; truth: pairs of numbers of
    a clip and its copy, with the kind. arrays: by name.
    """

    names: list[str]
    held_out: list[bool]
    facts: list[ClipFacts]
    arrays: list[dict[str, np.ndarray]]
    truth: dict[tuple[int, int], str]


@pytest.fixture(scope="module")
def real() -> list[tuple[dict[str, str], Motion]]:
    """The clips of the folder."""
    found = []
    for row in manifest():
        path = real_clips() / row["path"]
        skeleton = (path.parent / "02.asf").read_bytes() if path.suffix == ".amc" else None
        recording = read_recording(path.read_bytes(), skeleton)
        found.append((row, canonicalize(recording, frame_rate=float(row["fps"]))))
    return found


@pytest.fixture(scope="module")
def planted(real: list[tuple[dict[str, str], Motion]]) -> Planted:
    motions = [motion for _, motion in real]
    names = [row["path"] for row, _ in real]
    halves = [is_held_out(row) for row, _ in real]
    truth: dict[tuple[int, int], str] = {}
    rng = np.random.default_rng(0)
    for half in (False, True):
        pool = [place for place in range(len(real)) if halves[place] is half]
        for kind, copied in COPIED.items():
            usable = [i for i in pool if kind not in CUT or motions[i].duration >= MIN_SECONDS]
            chosen = rng.choice(usable, min(COPIES, len(usable)), replace=False).tolist()
            for seed, place in enumerate(chosen):
                truth[place, len(motions)] = kind
                motions.append(copied(motions[place], seed))
                names.append(f"{kind} of {names[place]}")
                halves.append(half)
    facts = [ClipFacts(m.duration, m.frame_rate, m.format, len(m.names)) for m in motions]
    return Planted(names, halves, facts, [_described(motion) for motion in motions], truth)


def _described(motion: Motion) -> dict[str, np.ndarray]:
    arrays = describe_for_search(motion, ("features_10hz", "motion_vector")).arrays
    return {**arrays, "moments": moments(smooth_track(motion))}


def as_npz(motion: Motion, _: int) -> Motion:
    """Written as positions in another format and read again, at 60 Hz."""
    names = list(motion.names)
    for role, joint in motion.roles.items():
        names[joint] = role.value
    positions = resample(motion.positions.astype(np.float64), motion.frame_rate, 60.0)
    return canonicalize(read_recording(write_npz(names, motion.parents, positions, 60.0)))


COPIED["npz, 60 Hz"] = as_npz


def _compared(planted: Planted) -> dict[tuple[int, int], PairKind]:
    """The pairs that are found, as `services.curation.comparison` finds them."""
    asked = np.arange(len(planted.names))
    vectors = np.stack([arrays["motion_vector"] for arrays in planted.arrays])
    some = [arrays["moments"][:, 1:] for arrays in planted.arrays]
    owners = np.repeat(asked, [len(rows) for rows in some])
    found: dict[tuple[int, int], tuple[float, PairKind]] = {}
    for one in by_vectors(vectors, asked) | by_moments(np.concatenate(some), owners, asked):
        pair = one.one, one.other
        first, second = (planted.arrays[place]["features_10hz"] for place in pair)
        second = mirrored_features(second) if one.is_mirrored else second
        laid = overlay(first, second)
        if laid is None:
            continue
        kind = kind_of(*(planted.facts[i] for i in pair), laid, is_mirrored=one.is_mirrored)
        if kind is not None and laid.distance < found.get(pair, (np.inf, kind))[0]:
            found[pair] = laid.distance, kind
    return {pair: kind for pair, (_, kind) in found.items() if kind is not PairKind.SIMILAR}


def test_planted_copies_are_found_and_nothing_else(planted: Planted) -> None:
    began = time.process_time()
    found = _compared(planted)
    seconds = time.process_time() - began
    allowed = _allowed(planted)
    for half in (False, True):
        title = "held-out persons" if half else "persons of the choice"
        truth = {p: k for p, k in planted.truth.items() if planted.held_out[p[0]] is half}
        FIGURES.print(f"\nPlanted copies, {title}: found of planted, with 95 % intervals")
        for kind in COPIED:
            mine = [pair in found for pair, name in truth.items() if name == kind]
            low, high = wilson_interval(sum(mine), len(mine))
            FIGURES.print(f"  {kind:14}{sum(mine):4} of {len(mine):3}   {low:.3f} to {high:.3f}")
        mine = [pair in found for pair in truth]
        here = [pair for pair in found if planted.held_out[pair[0]] is half]
        wrong = [pair for pair in here if pair not in allowed]
        recall, precision = float(np.mean(mine)), 1 - len(wrong) / max(len(here), 1)
        FIGURES.print(f"  recall {recall:.3f} of {len(mine)}")
        FIGURES.print(f"  precision {precision:.3f} of {len(here)}")
        for pair in wrong[:20]:
            named = " | ".join(planted.names[place] for place in pair)
            FIGURES.print(f"    wrong: {found[pair]}: {named}")
        for pair in truth:
            if pair not in found:
                FIGURES.print(f"    missed: {planted.names[pair[1]]}")
    twice = [p for p in allowed & found.keys() if {planted.names[i][:4] for i in p} == {"cmu-"}]
    FIGURES.print(f"\nTakes of CMU as BVH and as AMC: {len(twice)} of 3 found")
    FIGURES.print(f"{len(planted.names)} clips compared: {seconds:.0f} s of processor time")
    assert recall >= 0.98
    assert precision >= 0.98


def _allowed(planted: Planted) -> set[tuple[int, int]]:
    """All pairs among a clip and its copies, and the takes of CMU that the folder has twice."""
    family = list(range(len(planted.names)))
    for original, copy in planted.truth:
        family[copy] = original
    for take in ("02_01", "02_03", "02_04"):
        bvh = planted.names.index(f"cmu-bvh/{take}.bvh")
        amc = planted.names.index(f"cmu-asfamc/{take}.amc")
        family = [bvh if one == amc else one for one in family]
    members: dict[int, list[int]] = {}
    for place, one in enumerate(family):
        members.setdefault(one, []).append(place)
    return {pair for some in members.values() for pair in combinations(some, 2)}


def test_clips_made_bad_are_told_from_good_ones(real: list[tuple[dict[str, str], Motion]]) -> None:
    aucs = []
    for half in (False, True):
        motions = [motion for row, motion in real if is_held_out(row) is half]
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
    smooth = smooth_track(motion)
    found = measure_quality(body_track(motion), smooth, movement_signs(active_part(smooth)))
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
    find: Callable[[], set[Candidate]]
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
