"""Calls: evaluations. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from kinedex.call import Call, nothing, path_of, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.bodies import Filter
    from kinedex.types.choices import EvaluationKind
    from kinedex.types.evaluations import Evaluation, EvaluationList
    from kinedex.types.jobs import JobStarted


def list_evaluations(
    *, kind: EvaluationKind | None = None, limit: int | None = None, cursor: str | None = None
) -> Call[EvaluationList]:
    """The kept evaluations with their main figures, the newest first.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.evaluations import EvaluationList

    return Call(
        "list_evaluations",
        "GET",
        "/v1/evaluations",
        record(EvaluationList),
        query=given(kind=kind, limit=limit, cursor=cursor),
    )


def start_evaluation(
    kind: EvaluationKind,
    *,
    filter: Filter | Mapping[str, Any] | None = None,
    by: str | None = None,
    methods: Sequence[str] | None = None,
    false_accept_rate: float | None = None,
    classes: Sequence[str] | None = None,
    k: int | None = None,
    eta: float | None = None,
    max_queries: int | None = None,
    queries: Sequence[str] | None = None,
    tolerance: float | None = None,
) -> Call[JobStarted]:
    """Measure how well the methods do on the labels of this library, in the background.

    Words and recognition are held out: no clip is judged by a model that has seen its recording.
    150 clips take from a second to a minute, by the kind; more clips take longer. Follow the
    job; when it has succeeded, its result has the `evaluation_id`. Cancel it with `DELETE
    /v1/jobs/{id}`. If the library has too few labels, the job fails with the reason.

    kind: recognition: persons and tasks of clips that were held out. retrieval: search by
        example, with each labeled clip as the query. words: words for clips, and clips for
        words. keyposes: found keyposes against those that people named. low-dimensional: motions
        reduced to few dimensions. symbols: the motion symbol space. The last two need no labels.
    filter: The clips to judge. Default: all.
    by: recognition, retrieval, keyposes: figures for each group of clips too. `meta.KEY`, or one
        of person, task, license, source, folder, format.
    methods: The methods to judge; default: all. Of recognition: default, multilinear,
        signatures, pca, perera, mean-motion, prior; retrieval: fused, vector, dtw, msv-dtw,
        msv-xcorr, metric-task, metric-person.
    false_accept_rate: recognition: how often new persons and tasks may be called known.
    classes: retrieval: the tasks of Sun's table 1. Default: the four largest.
    k: retrieval: nearest clips to judge. Default: 20.
    eta: retrieval: judge the MSV methods with this threshold too, in body lengths.
    max_queries: retrieval: largest number of query clips, evenly from the tasks. Default: 1000.
    queries: words: words of the examples, as `high kick`. Default: the most frequent.
    tolerance: keyposes: seconds between a found keypose and the true one, at most.
    """
    from kinedex.types.jobs import JobStarted

    return Call(
        "start_evaluation",
        "POST",
        "/v1/evaluations",
        record(JobStarted),
        json=given(
            kind=kind,
            filter=filter,
            by=by,
            methods=methods,
            false_accept_rate=false_accept_rate,
            classes=classes,
            k=k,
            eta=eta,
            max_queries=max_queries,
            queries=queries,
            tolerance=tolerance,
        ),
    )


def get_evaluation(evaluation_id: str) -> Call[Evaluation]:
    """One evaluation with all its results, and the one before it to compare with."""
    from kinedex.types.evaluations import Evaluation

    return Call(
        "get_evaluation",
        "GET",
        path_of("/v1/evaluations/{evaluation_id}", evaluation_id=evaluation_id),
        record(Evaluation),
    )


def delete_evaluation(evaluation_id: str) -> Call[None]:
    """Delete a kept evaluation."""
    return Call(
        "delete_evaluation",
        "DELETE",
        path_of("/v1/evaluations/{evaluation_id}", evaluation_id=evaluation_id),
        nothing,
    )
