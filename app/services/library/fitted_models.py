"""The fitted models in force, loaded when they are asked for and when a newer one is there.

Their code is imported then too: a worker, which opens the same library, needs none of it.
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
    """What is fitted on a library."""

    WORDS = "words"
    """Kernel ridge to words, Takano's symbol space and correlated space."""
    MULTILINEAR = "multilinear"
    """Vasilescu's N-mode decomposition of persons and tasks."""
    SIGNATURES = "signatures"
    """The same on joint angles, as Vasilescu did it."""
    PERERA = "perera"
    """Perera's task model: who does what by weighted distances of joints."""
    RECOGNIZER = "recogniser"
    """Who does what, with an honest unknown."""
    METRIC_TASK = "metric-task"
    """How near two clips are in task."""
    METRIC_PERSON = "metric-person"
    """How near two clips are in person, or style."""
    KEYPOSES = "keyposes"
    """Thresholds of keyposes, from clips whose keyposes a person named."""
    SYNTHESIS = "synthesis"
    """What persons did by task, of which motions that they never recorded are made."""


METRICS = (ModelKind.METRIC_TASK, ModelKind.METRIC_PERSON)
"""Learned metrics."""

FALSE_ACCEPT_RATE = "false_accept_rate"
"""A setting of a recogniser: how often something new may be called known."""

KINDS_WITH_UNKNOWN = (ModelKind.RECOGNIZER, ModelKind.PERERA)
"""Recognisers that have that setting."""

_WITHOUT_PERSONS = frozenset({ModelKind.WORDS, ModelKind.METRIC_TASK, ModelKind.KEYPOSES})

INPUT_SHAPES = "shapes"
"""In a model's meta: the shapes of the arrays that it was fitted on."""


def input_shapes() -> dict[str, list[int | None]]:
    """The shapes of arrays that this version's models look at."""
    return {name: list(shape) for name, shape in SHAPES.items()}


def holds_persons(kind: ModelKind) -> bool:
    """Whether a model of this kind tells persons apart, so that it must go with any of them."""
    return kind not in _WITHOUT_PERSONS


@dataclass(frozen=True, slots=True)
class Fitted(Generic[Model]):
    """A model in force; id: of its record, another one after each fit; settings: a client's."""

    id: str
    version: int
    model: Model
    settings: Mapping[str, Any]


class FittedModels:
    """Models by kind; a cheap query each time tells whether a newer one is in force."""

    def __init__(self) -> None:
        self._loaded: dict[ModelKind, Fitted[Any]] = {}
        self._lock = threading.Lock()

    def words(self, store: Store) -> Fitted[LibraryWords]:
        """The word models in force; raises ModelNotFitted."""
        from app.models.words.library import LibraryWords

        return self._get(store, ModelKind.WORDS, LibraryWords.from_arrays)

    def recognizer(self, store: Store) -> Fitted[Recognizer]:
        """The default recogniser in force; raises ModelNotFitted."""
        from app.models.recognition.recognizer import Recognizer

        fitted = self._get(store, ModelKind.RECOGNIZER, Recognizer.from_arrays)
        rate = fitted.settings.get(FALSE_ACCEPT_RATE)
        return fitted if rate is None else replace(fitted, model=fitted.model.accepting(rate))

    def multilinear(self, store: Store) -> Fitted[Multilinear]:
        """The multilinear model in force; raises ModelNotFitted."""
        from app.models.recognition.multilinear import Multilinear

        return self._get(store, ModelKind.MULTILINEAR, Multilinear.from_arrays)

    def signatures(self, store: Store) -> Fitted[Multilinear]:
        """The multilinear model of joint angles in force; raises ModelNotFitted."""
        from app.models.recognition.multilinear import Multilinear

        return self._get(store, ModelKind.SIGNATURES, Multilinear.from_arrays)

    def perera(self, store: Store) -> Fitted[TensorRecognizer]:
        """Perera's recogniser in force; raises ModelNotFitted."""
        from app.models.recognition.perera import TensorRecognizer

        fitted = self._get(store, ModelKind.PERERA, TensorRecognizer.from_arrays)
        rate = fitted.settings.get(FALSE_ACCEPT_RATE)
        return fitted if rate is None else replace(fitted, model=fitted.model.accepting(rate))

    def keyposes(self, store: Store) -> Fitted[KeyposeThresholds]:
        """The learned thresholds in force; raises ModelNotFitted."""

        def build(arrays: Mapping[str, FloatArray], meta: Mapping[str, Any]) -> KeyposeThresholds:
            # A worker asks before each clip; most libraries have none to load.
            from app.models.keyposes.thresholds import KeyposeThresholds

            return KeyposeThresholds.from_arrays(arrays, meta)

        return self._get(store, ModelKind.KEYPOSES, build, explain=False)

    def synthesis(self, store: Store) -> Fitted[Synthesis]:
        """The synthesis in force; raises ModelNotFitted."""
        from app.models.synthesis.model import Synthesis

        return self._get(store, ModelKind.SYNTHESIS, Synthesis.from_arrays)

    def metric(self, store: Store, kind: ModelKind) -> Fitted[LearnedMetric]:
        """The learned metric of METRIC_TASK or METRIC_PERSON in force; raises ModelNotFitted."""
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
        """explain: whether to look up why there is none, which costs two queries."""
        with store.read() as tx:
            in_force = stored.current_ids(tx).get(kind.value)
            with self._lock:
                held = self._loaded.get(kind)
                if held is not None and (held.id, held.settings) != in_force:
                    del self._loaded[kind]  # nothing that was removed is kept in memory
                    held = None
            if held is not None:
                return held
            if in_force is None and explain:
                raise missing_model(tx, kind.value)
            record = stored.current(tx, kind.value)
            arrays = stored.load_arrays(tx, record.id)
        if record.meta.get(INPUT_SHAPES, input_shapes()) != input_shapes():
            # The worker analyses the clips anew, then fits anew.
            with store.read() as tx:
                raise outdated_model(tx, kind.value)
        try:
            model = build(arrays, record.meta["model"])
            fitted = Fitted(record.id, record.version, model, record.settings)
        except (ValueError, KeyError) as other:
            with store.read() as tx:
                raise outdated_model(tx, kind.value) from other
        with self._lock:
            self._loaded[kind] = fitted
        return fitted
