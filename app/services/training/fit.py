"""Fits all models of a library with their held-out figures. Each model is replaced as a whole."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any

from app.analysis.descriptors.motion_sample import SAMPLES
from app.errors import NotEnoughLabels
from app.models.held_out.metric import held_out_metric
from app.models.held_out.recognition import (
    held_out_recognition,
    signature_figures,
    unknown_figures,
)
from app.models.held_out.words import held_out_word_figures
from app.models.metric.learned_metric import Factor, LearnedMetric, fit_axes
from app.models.recognition.multilinear import fit_multilinear
from app.models.recognition.perera import fit_tensor_recognizer
from app.models.recognition.recognizer import fit_recognizer
from app.models.words.language.wordnet import Meanings
from app.models.words.library import fit_library_words
from app.services.library.fitted_models import INPUT_SHAPES, ModelKind, holds_persons, input_shapes
from app.services.library.guessed_labels import guess_arrays
from app.services.library.precomputed_rows import precomputed_arrays
from app.services.training.annotated import read_annotated
from app.services.training.keypose_learning import learn_keyposes
from app.services.training.models import enqueue_fit
from app.services.training.synthesis_fit import fit_synthesis_on
from app.services.training.training_set import TrainingSet, read_training_set
from app.store import models
from app.store.clips import labels
from app.store.database.engine import Tx
from app.store.store import Store

_log = logging.getLogger(__name__)

Meta = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Fit:
    """A fitted model as it is stored; figures: held-out figures by method."""

    arrays: dict[str, Any]
    meta: Meta
    figures: Meta


@dataclass(frozen=True, slots=True)
class Before:
    """The context of a fit: metadata and settings of the model that it replaces (empty if there
    is none), whether to look up new words in WordNet (takes seconds), and the store."""

    meta: Meta
    settings: Meta
    wordnet: bool
    store: Store


def fit_library(store: Store, *, wordnet: bool = False, persons: bool = True) -> dict[str, Any]:
    """Fit and save every model that the labels allow.

    The result has the `library_version` and `library_size` of the fit, and for each kind of
    model its `outcome`: "fitted" with version and figures, or "skipped" with the reason. If one
    model fails, the others are still fitted. wordnet: look up new words there (takes seconds);
    persons: whether persons may be recognized.
    """
    training = replace(read_training_set(store), is_anonymous=not persons)
    outcomes = {kind.value: _fit_one(store, training, kind, wordnet) for kind in ModelKind}
    return {
        "library_version": training.library_version,
        "library_size": len(training),
        "models": outcomes,
    }


def _fit_one(store: Store, training: TrainingSet, kind: ModelKind, wordnet: bool) -> dict[str, Any]:
    before = _before(store, kind, wordnet)
    try:
        fit = _FITS[kind](training, before)
    except NotEnoughLabels as reason:
        return {"outcome": "skipped", "reason": reason.detail}
    except Exception as defect:  # noqa: BLE001
        # a defect in one model must not stop the others; it goes to the log and to the result
        _log.exception("the %s model could not be fitted", kind.value)
        return {"outcome": "failed", "reason": f"{type(defect).__name__}: {defect}"}
    with store.write() as tx:
        # Somebody may have asked to forget a person during the fit, which takes long.
        if holds_persons(kind) and _is_someone_gone(tx, training):
            enqueue_fit(tx)
            return {"outcome": "skipped", "reason": "A person was removed during the fit."}
        record = models.save(
            tx,
            kind.value,
            meta={
                "model": fit.meta,
                "figures": fit.figures,
                "settings": before.settings,
                INPUT_SHAPES: input_shapes(),
            },
            arrays=fit.arrays,
            library_version=training.library_version,
            library_size=len(training),
        )
    return {"outcome": "fitted", "version": record.version, "figures": fit.figures}


def _is_someone_gone(tx: Tx, training: TrainingSet) -> bool:
    """Whether a person of the training set is no longer in the library."""
    return not set(filter(None, training.persons)) <= labels.person_names(tx)


def _before(store: Store, kind: ModelKind, wordnet: bool) -> Before:
    with store.read() as tx:
        found = next((m for m in models.list_current(tx) if m.kind == kind.value), None)
    if found is None:
        return Before({}, {}, wordnet, store)
    return Before(dict(found.meta.get("model", {})), found.settings, wordnet, store)


def _fit_words(training: TrainingSet, before: Before) -> Fit:
    fitted = fit_library_words(
        training.symbols,
        training.word_inputs,
        training.label_sets,
        training.groups,
        training.strangers,
        training.taught_parts,
    )
    # Meanings are looked up once, since a look-up is slow: the model before has them already.
    earlier = Meanings.from_meta(before.meta.get("meanings", {}))
    meanings = earlier.of(fitted.words.vocabulary.words, look_up=before.wordnet)
    model = replace(fitted.words, meanings=meanings)
    arrays, meta = model.to_arrays()
    ids = [clip.id for clip in training.clips]
    scores = model.all_scores(training.word_inputs)
    arrays |= precomputed_arrays(ids, scores, fitted.points, fitted.cca_points)
    return Fit(arrays, meta, word_figures(training))


def word_figures(training: TrainingSet) -> Meta:
    """Held-out figures of the word models and the prior, or the reason why there are none."""
    try:
        found = held_out_word_figures(
            training.symbols,
            training.word_inputs,
            training.label_sets,
            training.groups,
            persons=training.strangers,
        )
    except NotEnoughLabels as reason:
        return {"reason": reason.detail}
    shown = asdict(found)
    # curves and figures of single words are long; `kinedex evaluate words` shows them
    del shown["by_word"], shown["left_out"]
    for name in ("figures", "in_sample"):
        shown[name] = [{k: v for k, v in row.items() if k != "precision"} for row in shown[name]]
    correlations = {
        kind: {str(number): value for number, value in enumerate(values, 1)}
        for kind, values in found.correlations.items()
    }
    losses = {str(count): loss for count, loss in found.losses.items()}
    return shown | {"correlations": correlations, "losses": losses}


def _fit_recognizer(training: TrainingSet, _: Before) -> Fit:
    persons, tasks, groups = training.persons, training.tasks, training.groups
    copies = training.disturbed_copies()
    model = fit_recognizer(training.full_samples, persons, tasks, groups, copies)
    arrays, meta = model.to_arrays()
    judged = held_out_recognition(
        training.samples, persons, tasks, groups, wide=training.wide, copies=copies
    )
    ids = [clip.id for clip in training.clips]
    guesses, names = guess_arrays(ids, persons, tasks, judged.guesses)
    figures: Meta = {"held_out": judged.figures, "unknown": unknown_figures(model)}
    return Fit(arrays | guesses, meta | names, figures)


def _fit_multilinear(training: TrainingSet, _: Before) -> Fit:
    # its held-out figures are with those of the default recognizer
    model = fit_multilinear(training.samples, training.persons, training.tasks)
    arrays, meta = model.to_arrays()
    return Fit(arrays, meta, {})


def _fit_signatures(training: TrainingSet, _: Before) -> Fit:
    angles, persons, tasks, groups = training.with_angles()
    model = fit_multilinear(angles, persons, tasks, moments=SAMPLES)
    arrays, meta = model.to_arrays()
    return Fit(arrays, meta, {"held_out": signature_figures(angles, persons, tasks, groups)})


def _fit_perera(training: TrainingSet, _: Before) -> Fit:
    model = fit_tensor_recognizer(
        training.samples, training.persons, training.tasks, training.groups
    )
    arrays, meta = model.to_arrays()
    return Fit(arrays, meta, {"unknown": unknown_figures(model)})


def _fit_keyposes(_: TrainingSet, before: Before) -> Fit:
    model, figures = learn_keyposes(read_annotated(before.store))
    arrays, meta = model.to_arrays()
    return Fit(arrays, meta, figures)


def _fit_synthesis(training: TrainingSet, before: Before) -> Fit:
    model, figures = fit_synthesis_on(before.store, training)
    arrays, meta = model.to_arrays()
    return Fit(arrays, meta, figures)


def _fit_metric(factor: Factor, training: TrainingSet, _: Before) -> Fit:
    persons, tasks, described = training.persons, training.tasks, training.described
    judged = held_out_metric(described, persons, tasks, training.groups, factor)
    labels = tasks if factor is Factor.TASK else persons
    model = LearnedMetric(fit_axes(described, labels, factor), judged.calibration)
    arrays, meta = model.to_arrays()
    ids = [clip.id for clip in training.clips]
    arrays |= precomputed_arrays(ids, None, model.axes.project(described))
    return Fit(arrays, meta, judged.figures)


_FITS: dict[ModelKind, Callable[[TrainingSet, Before], Fit]] = {
    ModelKind.WORDS: _fit_words,
    ModelKind.RECOGNIZER: _fit_recognizer,
    ModelKind.MULTILINEAR: _fit_multilinear,
    ModelKind.SIGNATURES: _fit_signatures,
    ModelKind.PERERA: _fit_perera,
    ModelKind.METRIC_TASK: partial(_fit_metric, Factor.TASK),
    ModelKind.METRIC_PERSON: partial(_fit_metric, Factor.PERSON),
    ModelKind.KEYPOSES: _fit_keyposes,
    ModelKind.SYNTHESIS: _fit_synthesis,
}
