"""Candidates: the nearest of a plain search are among them, mirrored ones too."""

from __future__ import annotations

import numpy as np

from app.analysis.descriptors.moments import WIDTH, mirrored
from app.search.duplicates.candidates import NEAREST, Candidate, by_moments, by_vectors


def test_the_nearest_vectors_are_those_of_a_plain_search() -> None:
    vectors = np.random.default_rng(0).normal(size=(300, 12))
    asked = np.array([3, 50, 299])
    expected = set()
    for one in asked:
        away = np.linalg.norm(vectors - vectors[one], axis=1)
        for other in np.argsort(away)[1 : NEAREST + 1]:
            low, high = sorted((int(one), int(other)))
            expected.add(Candidate(low, high, is_mirrored=False))
    assert by_vectors(vectors, asked) == expected
    assert by_vectors(vectors[:1], np.array([0])) == set()


def test_copies_share_moments_in_many_cells() -> None:
    rng = np.random.default_rng(1)
    points = rng.normal(scale=0.2, size=(600, 8, WIDTH))
    points[300] = points[10] + rng.normal(scale=0.001, size=(8, WIDTH))
    points[301, :3] = mirrored(points[20, 4:7])
    owners = np.repeat(np.arange(600), 8)
    found = by_moments(points.reshape(-1, WIDTH), owners, np.array([300, 301]))
    assert Candidate(10, 300, is_mirrored=False) in found
    assert Candidate(20, 301, is_mirrored=True) in found
    assert len(found) < 10
    assert not any(one.one == one.other for one in found)
