"""Figures 6, 7 and 8 of Sun 2011 for a library."""

from __future__ import annotations

import pytest

from app import evaluate
from app.evaluate import RetrievalEvaluation, VolumeEvaluation
from app.evaluate.retrieval import pictures as retrieval_pictures
from app.search.example.methods import Method
from app.services.library.library import Library


@pytest.fixture(scope="module")
def found(ready_library: Library) -> RetrievalEvaluation:
    return evaluate.judge_retrieval(ready_library, methods=[Method.VECTOR, Method.MSV_XCORR])


@pytest.fixture(scope="module")
def volumes(ready_library: Library) -> VolumeEvaluation:
    return evaluate.judge_volumes(ready_library, classes=["walk", "kick"], q=1, threshold=0.4)


def test_every_picture_is_drawn_and_named(
    found: RetrievalEvaluation, volumes: VolumeEvaluation
) -> None:
    drawn = retrieval_pictures.all_figures(found, volumes, "svg")
    assert set(drawn) == {
        "confusion-vector.svg",
        "confusion-msv-xcorr.svg",
        "confusion-msv-xcorr-q1.svg",
        "confusion-msv-xcorr-normalized.svg",
        "confusion-rho-alone.svg",
        "matrices.svg",
        "volumes.svg",
        "vectors.svg",
        "convergence.svg",
    }
    assert all(content.startswith(b"<?xml") for content in drawn.values())
    assert len(set(drawn.values())) == len(drawn)


def test_the_methods_of_the_paper_are_drawn_with_the_default(found: RetrievalEvaluation) -> None:
    assert retrieval_pictures.shown_methods(found) == ("msv-xcorr",)
    only = RetrievalEvaluation(found.methods[:1], found.chosen, found.classes, 20, 12, 0, 0)
    assert retrieval_pictures.shown_methods(only) == ("vector",)
    one = retrieval_pictures.confusion_figure(found, ["vector"], "png")
    two = retrieval_pictures.confusion_figure(found, ["vector", "msv-xcorr"], "png")
    assert len(two) > len(one)
