"""Our own functions that a library also has, compared with that library in one run.

Run: OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 pytest -m bench -s tests/bench/test_libraries.py
The docstrings of the modules cite these figures. DTW (test_dtw.py) and the cross-correlation
(test_cross_correlation.py) have their own benches. Times are CPU times: the best of several rounds,
in which the candidates take turns.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hmmlearn import hmm as learning
from scipy.signal import correlate
from scipy.spatial.transform import Rotation
from sklearn.decomposition import PCA
from sklearn.kernel_ridge import KernelRidge
from sklearn.manifold import ClassicalMDS
from sklearn.model_selection import GridSearchCV
from sklearn.neighbors import NearestNeighbors

from app.motion.skeleton import rotations
from app.numerics import kernel_ridge
from app.numerics.alignment.cross_correlation import max_cross_correlations
from app.numerics.hmm.divergence import symmetric_divergences
from app.numerics.hmm.fit import fit_left_to_right
from app.numerics.hmm.model import log_likelihoods
from app.numerics.mds import classical_mds, metric_mds, stress
from app.numerics.nearest import Block, nearest
from app.numerics.principal_axes import principal_axes
from app.numerics.smacof import smacof
from tests.bench.page import Section
from tests.numerics.hmm_reference import wavy

FIGURES = Section(
    "libraries",
    "Own functions compared with a library that has them",
    trials="the best of several rounds of CPU time, on random arrays of the sizes that are printed",
)

pytestmark = pytest.mark.bench

ROUNDS = 7


def compare(name: str, ways: dict[str, Callable[[], Any]]) -> dict[str, Any]:
    """Run each candidate and return its result. Prints its time, also relative to the first one."""
    best, given = dict.fromkeys(ways, np.inf), {}
    for _ in range(ROUNDS):
        for way, work in ways.items():
            began = time.process_time()
            given[way] = work()
            best[way] = min(best[way], time.process_time() - began)
    ours = next(iter(best.values()))
    FIGURES.print(f"\n{name}:", end="")
    for way, seconds in best.items():
        FIGURES.print(f"  {way} {1e3 * seconds:.3g} ms ({seconds / ours:.1f} x)", end="")
    return given


def test_many_models_score_one_clip() -> None:
    models = [
        fit_left_to_right(wavy(150, seed, 26), states=30, variance_floor=np.full(26, 0.1))
        for seed in range(50)
    ]
    theirs = []
    for model in models:
        one = learning.GaussianHMM(model.states, "diag", implementation="log")
        one.startprob_, one.transmat_ = np.eye(model.states)[0], model.transitions
        one.means_, one.covars_ = model.means, model.variances
        theirs.append(one)
    clip = wavy(150, 7, 26)
    given = compare(
        "50 models score a clip of 5 s",
        {
            "ours": lambda: log_likelihoods(models, clip),
            "hmmlearn": lambda: [one.score(clip) for one in theirs],
        },
    )
    np.testing.assert_allclose(given["ours"], given["hmmlearn"], rtol=1e-6)


def test_kernel_ridge_is_tuned() -> None:
    rng = np.random.default_rng(0)
    rows = rng.normal(size=(500, 131))
    outputs = np.tanh(rows @ rng.normal(size=(131, 55)) / 10) + 0.1 * rng.normal(size=(500, 55))
    centered = outputs - outputs.mean(axis=0)
    squares = kernel_ridge._squared_distances(rows, rows)
    unit = float(np.sqrt(np.median(squares[np.triu_indices(500, 1)])))
    grid = {
        "gamma": [1 / (2 * (share * unit) ** 2) for share in kernel_ridge.WIDTHS],
        "alpha": list(kernel_ridge.PENALTIES),
    }
    search = GridSearchCV(KernelRidge(kernel="rbf"), grid, scoring="neg_mean_squared_error", cv=5)
    compare(
        "kernel ridge tuned on 500 clips",
        {
            "ours, each clip left out": lambda: kernel_ridge._tune(rows, centered),
            "scikit-learn, five folds": lambda: search.fit(rows, centered),
        },
    )


@pytest.mark.parametrize("share", [1.0, 0.5, 0.02])
def test_nearest_of_a_hundred_thousand(share: float) -> None:
    rng = np.random.default_rng(0)
    vectors = rng.normal(size=(100_000, 128)).astype(np.float32)
    query = rng.normal(size=128).astype(np.float32)
    block = Block.of(vectors)
    mask = None if share == 1.0 else rng.random(len(vectors)) < share
    whole = NearestNeighbors(n_neighbors=10, algorithm="brute").fit(vectors)

    def by_library() -> Any:
        if mask is None:
            return whole.kneighbors(query[None])[0][0]
        part = NearestNeighbors(n_neighbors=10, algorithm="brute").fit(vectors[mask])
        return part.kneighbors(query[None])[0][0]

    given = compare(
        f"10 nearest of 100,000, {share:.0%} of them meant",
        {
            "ours": lambda: np.sort(nearest([block], [mask], query, 10)[1]),
            "scikit-learn": by_library,
        },
    )
    np.testing.assert_allclose(given["ours"][:10], given["scikit-learn"], rtol=1e-3)


@pytest.mark.parametrize("count", [20, 100, 200])
def test_classical_scaling(count: int) -> None:
    distances = _distances(count)
    compare(
        f"classical scaling of {count} points",
        {
            "ours": lambda: classical_mds(distances, 10),
            "scikit-learn": lambda: ClassicalMDS(10, metric="precomputed").fit_transform(distances),
        },
    )


def test_eq_3_is_lower_if_it_is_minimized() -> None:
    distances = _distances(100)
    given = compare(
        "scaling of 100 symbols in 10 dimensions",
        {
            "eq. 3, ours": lambda: metric_mds(distances, 10),
            "SMACOF of scikit-learn": lambda: smacof(distances, 10),
        },
    )
    FIGURES.print(
        "\n  eq. 3:", {name: round(stress(points, distances), 1) for name, points in given.items()}
    )


@pytest.mark.parametrize("frames", [150, 3000])
def test_rotations(frames: int) -> None:
    rng = np.random.default_rng(0)
    angles = rng.normal(size=(frames, 31, 3))
    one = rotations.euler_to_quaternions(angles, "ZXY")
    other = rotations.euler_to_quaternions(rng.normal(size=angles.shape), "ZXY")
    left, right = (Rotation.from_quat(q.reshape(-1, 4)[:, [1, 2, 3, 0]]) for q in (one, other))
    points = rng.normal(size=angles.shape)
    flat_angles, flat_points = angles.reshape(-1, 3), points.reshape(-1, 3)
    compare(
        f"{frames} frames of 31 joints, angles to quaternions",
        {
            "ours": lambda: rotations.euler_to_quaternions(angles, "ZXY"),
            "scipy": lambda: Rotation.from_euler("ZXY", flat_angles).as_quat(),
        },
    )
    compare(
        "  product",
        {"ours": lambda: rotations.multiply(one, other), "scipy": lambda: left * right},
    )
    compare(
        "  points turned",
        {"ours": lambda: rotations.rotate(one, points), "scipy": lambda: left.apply(flat_points)},
    )


def test_cross_correlations_of_five_hundred() -> None:
    rng = np.random.default_rng(0)
    lengths = np.clip(np.exp(rng.normal(np.log(140), 0.6, size=500)), 20, 1900).astype(int)
    rows = [rng.random(length) for length in lengths]
    given = compare(
        "cross-correlation with 500 clips",
        {
            "ours": lambda: max_cross_correlations(rows[3], rows),
            "scipy": lambda: np.array([correlate(rows[3], row).max() for row in rows]),
            "numpy": lambda: np.array([np.correlate(rows[3], r, "full").max() for r in rows]),
        },
    )
    np.testing.assert_allclose(given["ours"], given["scipy"])


def test_principal_axes_of_wide_rows() -> None:
    rows = np.random.default_rng(0).normal(size=(500, 1509))
    compare(
        "160 principal axes of 500 rows of 1509",
        {
            "ours": lambda: principal_axes(rows, 160),
            "scikit-learn": lambda: PCA(160, svd_solver="full").fit(rows),
        },
    )


def _distances(count: int) -> np.ndarray:
    symbols = [
        fit_left_to_right(wavy(60 + seed, seed, 26), states=15, variance_floor=np.full(26, 0.1))
        for seed in range(count)
    ]
    return np.log1p(symmetric_divergences(symbols, symbols))
