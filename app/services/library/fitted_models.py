"""The active fitted models. A model is loaded on its first use, and again when it was replaced.

The code of a model is imported on its first use too: a worker opens the same library and needs
almost none of it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from app.analysis.array_shapes import SHAPES
from app.numerics.arrays import FloatArray
from app.services.library.missing_model import missing_model, outdated_model
from app.store import models as stored
from app.store.store import Store

if TYPE_CHECKING:
    from app.models.keyposes.thresholds import KeyposeThresholds
    from app.models.metric.learned_metric import LearnedMetric
    from app.models.recognition.multilinear import Multilinear
    from app.models.recognition.perera import TensorRecognizer
    from app.models.recognition.recognizer import Recognizer
    from app.models.synthesis.model import Synthesis
    from app.models.words.library import LibraryWords

Model = TypeVar("Model")


class ModelKind(StrEnum):
    """The kinds of models that are fitted on a library."""

    WORDS = "words"
    """Kernel ridge to words, Takano's symbol space and correlated space."""
    MULTILINEAR = "multilinear"
    """Vasilescu's N-mode decomposition of persons and tasks."""
    SIGNATURES = "signatures"
    """The same decomposition on joint angles, as in Vasilescu's paper."""
    PERERA = "perera"
    """Perera's task model: recognizes person and task by weighted distances of joints."""
    RECOGNIZER = "recognizer"
    """The default recognizer of person and task. It answers "unknown" for new ones."""
    METRIC_TASK = "metric-task"
    """A distance that is small for clips of the same task."""
    METRIC_PERSON = "metric-person"
    """A distance that is small for clips of the same person, or the same style."""
    KEYPOSES = "keyposes"
    """Thresholds of keyposes, learned from clips whose keyposes people annotated."""
    SYNTHESIS = "synthesis"
    """Motion shapes by person and task. They predict tasks that a person never recorded."""


METRICS = (ModelKind.METRIC_TASK, ModelKind.METRIC_PERSON)
"""Learned metrics."""

FALSE_ACCEPT_RATE = "false_accept_rate"
"""A setting of a recognizer: how often it may call a new person or task a known one."""

KINDS_WITH_UNKNOWN = (ModelKind.RECOGNIZER, ModelKind.PERERA)
"""Recognizers that can answer "unknown": they have the setting FALSE_ACCEPT_RATE."""

KINDS_WITH_SIGNATURES = (ModelKind.MULTILINEAR, ModelKind.SIGNATURES)
"""Models that have signatures of persons: `FittedModels.multilinear` and `signatures`."""

_WITHOUT_PERSONS = frozenset({ModelKind.WORDS, ModelKind.METRIC_TASK, ModelKind.KEYPOSES})

INPUT_SHAPES = "shapes"
"""Key in the metadata of a model: the shapes of the arrays that it was fitted on."""


def input_shapes() -> dict[str, list[int | None]]:
    """The shapes of the arrays that the models of this version of Kinedex use, by array name."""
    return {name: list(shape) for name, shape in SHAPES.items()}


def holds_persons(kind: ModelKind) -> bool:
    """Whether a model of this kind stores data of single persons.

    Such a model must be removed when one of its persons is forgotten.
    """
    return kind not in _WITHOUT_PERSONS


@dataclass(frozen=True, slots=True)
class Fitted(Generic[Model]):
    """An active model.

    id: of its record, a new one after each fit; version: grows by one with each fit of its kind;
    settings: the settings that a client made.
    """

    id: str
    version: int
    model: Model
    settings: Mapping[str, Any]


class FittedModels:
    """The active models by kind. Each access makes a cheap query for a newer model."""

    def __init__(self) -> None:
        self._loaded: dict[ModelKind, Fitted[Any]] = {}
        self._lock = threading.Lock()

    def words(self, store: Store) -> Fitted[LibraryWords]:
        """The active word models. Raises ModelNotFitted."""
        from app.models.words.library import LibraryWords

        return self._get(store, ModelKind.WORDS, LibraryWords.from_arrays)

    def recognizer(self, store: Store) -> Fitted[Recognizer]:
        """The active default recognizer. Raises ModelNotFitted."""
        from app.models.recognition.recognizer import Recognizer

        fitted = self._get(store, ModelKind.RECOGNIZER, Recognizer.from_arrays)
        rate = fitted.settings.get(FALSE_ACCEPT_RATE)
        return fitted if rate is None else replace(fitted, model=fitted.model.accepting(rate))

    def multilinear(self, store: Store) -> Fitted[Multilinear]:
        """The active multilinear model. Raises ModelNotFitted."""
        from app.models.recognition.multilinear import Multilinear

        return self._get(store, ModelKind.MULTILINEAR, Multilinear.from_arrays)

    def signatures(self, store: Store) -> Fitted[Multilinear]:
        """The active multilinear model of joint angles. Raises ModelNotFitted."""
        from app.models.recognition.multilinear import Multilinear

        return self._get(store, ModelKind.SIGNATURES, Multilinear.from_arrays)

    def perera(self, store: Store) -> Fitted[TensorRecognizer]:
        """Perera's active recognizer. Raises ModelNotFitted."""
        from app.models.recognition.perera import TensorRecognizer

        fitted = self._get(store, ModelKind.PERERA, TensorRecognizer.from_arrays)
        rate = fitted.settings.get(FALSE_ACCEPT_RATE)
        return fitted if rate is None else replace(fitted, model=fitted.model.accepting(rate))

    def keyposes(self, store: Store) -> Fitted[KeyposeThresholds]:
        """The active learned thresholds. Raises ModelNotFitted."""

        def build(arrays: Mapping[str, FloatArray], meta: Mapping[str, Any]) -> KeyposeThresholds:
            # Imported here: a worker calls this before each clip, and most libraries have no
            # learned thresholds.
            from app.models.keyposes.thresholds import KeyposeThresholds

            return KeyposeThresholds.from_arrays(arrays, meta)

        return self._get(store, ModelKind.KEYPOSES, build, explain=False)

    def synthesis(self, store: Store) -> Fitted[Synthesis]:
        """The active synthesis model. Raises ModelNotFitted."""
        from app.models.synthesis.model import Synthesis

        return self._get(store, ModelKind.SYNTHESIS, Synthesis.from_arrays)

    def metric(self, store: Store, kind: ModelKind) -> Fitted[LearnedMetric]:
        """The active learned metric; kind: one of METRICS. Raises ModelNotFitted."""
        from app.models.metric.learned_metric import LearnedMetric

        return self._get(store, kind, LearnedMetric.from_arrays)

    def _get(
        self,
        store: Store,
        kind: ModelKind,
        build: Callable[[Mapping[str, FloatArray], Mapping[str, Any]], Model],
        *,
        explain: bool = True,
    ) -> Fitted[Model]:
        """The active model of a kind, from memory if it was not replaced since.

        explain: whether the error gives the reason why there is no model (two more queries).
        """
        with store.read() as tx:
            active = stored.current_ids(tx).get(kind.value)
            with self._lock:
                loaded = self._loaded.get(kind)
                if loaded is not None and (loaded.id, loaded.settings) != active:
                    # A removed model must leave the memory too: it may hold a forgotten person.
                    del self._loaded[kind]
                    loaded = None
            if loaded is not None:
                return loaded
            if active is None and explain:
                raise missing_model(tx, kind.value)
            record = stored.current(tx, kind.value)
            arrays = stored.load_arrays(tx, record.id)
        if record.meta.get(INPUT_SHAPES, input_shapes()) != input_shapes():
            # After an upgrade the worker analyzes all clips again, and then fits the models again.
            with store.read() as tx:
                raise outdated_model(tx, kind.value)
        try:
            model = build(arrays, record.meta["model"])
            fitted = Fitted(record.id, record.version, model, record.settings)
        except (ValueError, KeyError) as unreadable:
            # Another version of Kinedex stored the model in another form.
            with store.read() as tx:
                raise outdated_model(tx, kind.value) from unreadable
        with self._lock:
            self._loaded[kind] = fitted
        return fitted
