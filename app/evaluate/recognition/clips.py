"""The clips that an evaluation of recognition learns from and probes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.errors import NotEnoughLabels
from app.evaluate.grouping import Grouping
from app.models.held_out.recognition import Clips
from app.models.recognition.copies import ClipCopies
from app.models.recognition.views import full_samples
from app.models.words.language.label_tree import LabelTree
from app.numerics.arrays import FloatArray, IntArray
from app.services.library.label_tree import get_tree
from app.services.library.library import Library
from app.services.training.training_set import TrainingSet, read_training_set, ready_only
from app.store.clips.filter import ClipFilter

Labels = Sequence[str | None]


NO_TREE = LabelTree(frozenset(), {})


@dataclass(frozen=True, slots=True)
class JudgedClips:
    """N clips that carry a person or a task.

    samples: (N, 1250) motion samples; persons, tasks: (N,) labels, None where there is none;
    groups: (N,) clips of one recording share a value and are never split between training and
    probes; sources: (N,) where they come from, None if unknown; unlabeled: the number of clips
    that carry neither label;
    angles: (N, 642) angle samples, None where a clip has none; wide: (N, 512) wide motion vectors;
    copies: (N,) disturbed copies of some clips; reported: (N,) the group of each clip for which
    figures are reported, None without groups; tree: of the tasks (no task is a kind of another
    without one).
    """

    samples: FloatArray
    persons: Labels
    tasks: Labels
    groups: Sequence[str]
    sources: Labels
    unlabeled: int = 0
    angles: FloatArray | None = None
    wide: FloatArray | None = None
    copies: ClipCopies | None = None
    reported: Sequence[str] | None = None
    tree: LabelTree = NO_TREE

    def __len__(self) -> int:
        return len(self.groups)

    def part(self, index: IntArray) -> Clips:
        """The training data of the clips at these indices (n,)."""
        whole = Clips(self.samples, self.persons, self.tasks, self.groups, self.copies)
        return whole.part(index)

    def in_full(self) -> JudgedClips:
        """The same clips with full samples (N, 1762), if they have wide motion vectors."""
        if self.wide is None:
            return self
        return replace(self, samples=full_samples(self.samples, self.wide))

    def in_angles(self) -> JudgedClips:
        """The same clips with angle samples. Raises NotEnoughLabels if a clip has none."""
        if self.angles is None:
            raise NotEnoughLabels(
                "Some clips have no joint angles: they were analyzed by an earlier version."
            )
        return replace(self, samples=self.angles)

    def labels(self, factor: str) -> Labels:
        """(N,) of the factor "person" or "task"."""
        return {"person": self.persons, "task": self.tasks}[factor]


def names_of(labels: Labels) -> list[str]:
    """The distinct labels, sorted."""
    return sorted({label for label in labels if label})


def read_judged_clips(
    lib: Library, filter: ClipFilter | None, grouping: Grouping | None = None
) -> JudgedClips:
    """The ready clips that pass the filter and carry a label, with their groups."""
    clips = judged_clips(read_training(lib, filter), grouping)
    return replace(clips, tree=get_tree(lib).tree)


def read_training(lib: Library, filter: ClipFilter | None) -> TrainingSet:
    """The ready clips that pass the filter.

    It holds no persons where the setting `recognize_persons` is off.
    """
    training = read_training_set(lib.store, ready_only(filter))
    return replace(training, is_anonymous=not lib.settings.recognize_persons)


def judged_clips(training: TrainingSet, grouping: Grouping | None = None) -> JudgedClips:
    """The clips of a training set that carry a person or a task."""
    pairs = zip(training.persons, training.tasks, strict=True)
    use = [i for i, labels in enumerate(pairs) if any(labels)]
    persons, tasks = training.persons, training.tasks
    angles = [training.angles.get(training.clips[i].id) for i in use]
    present = [one for one in angles if one is not None]
    copies = training.disturbed_copies()
    return JudgedClips(
        samples=training.samples[use].astype(np.float64) if use else np.zeros((0, 0)),
        persons=[persons[i] for i in use],
        tasks=[tasks[i] for i in use],
        groups=[training.groups[i] for i in use],
        sources=[training.clips[i].source for i in use],
        unlabeled=len(training) - len(use),
        angles=np.stack(present) if present and len(present) == len(use) else None,
        wide=training.wide[use].astype(np.float64) if use else None,
        copies=[copies[i] for i in use],
        reported=None if grouping is None else grouping.groups([training.clips[i] for i in use]),
    )
