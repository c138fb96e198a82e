"""The query clips of an evaluation of retrieval, and the clips that are relevant to them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import NotEnoughLabels
from app.models.held_out.class_rankings import JudgedRanking, judge_ranking
from app.services import fields
from app.services.library.library import Library
from app.services.training.training_set import ready_only, recording_of_clip
from app.store.clips import listing as clip_listing
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

MAX_TASKS_IN_MESSAGE = 30
"""Largest number of tasks in a message."""


@dataclass(frozen=True, slots=True)
class LabeledClips:
    """The ready clips that carry a task.

    clips: (N,) sorted by id; classes: (C,) tasks with at least two recordings, the largest first;
    code: by clip id, the index of its class, C for no class; recording: by clip id, equal for
    files of one recording; unlabeled: number of clips without a task, which are left out since
    they may be right or wrong answers.
    """

    clips: tuple[ClipRecord, ...]
    classes: tuple[str, ...]
    code: dict[str, int]
    recording: dict[str, str]
    unlabeled: int

    @property
    def in_a_class(self) -> tuple[ClipRecord, ...]:
        """The clips that can be queries."""
        return tuple(clip for clip in self.clips if self.code[clip.id] < len(self.classes))

    def queries(self, max_count: int) -> tuple[ClipRecord, ...]:
        """At most `max_count` query clips, evenly from the classes, and at least one of each class.

        For each query there is another recording of its task.
        """
        candidates = self.in_a_class
        counts: Counter[int] = Counter()
        turns: list[tuple[int, int]] = []
        # a clip's turn is its number within its class, so that classes alternate
        for index in np.random.RandomState(0).permutation(len(candidates)).tolist():
            code = self.code[candidates[index].id]
            turns.append((counts[code], index))
            counts[code] += 1
        chosen_turns = sorted(turns)[: max(max_count, len(self.classes))]
        return tuple(candidates[index] for index in sorted(index for _, index in chosen_turns))

    def judge(self, query: ClipRecord, found: Sequence[str], k: int) -> JudgedRanking:
        """Judge a ranking; clips without a task and files of the query's recording are ignored."""
        own = self.recording[query.id]
        codes = [self.code[i] for i in found if i in self.code and self.recording[i] != own]
        return judge_ranking(np.array(codes), self.code[query.id], len(self.classes), k)

    def chosen(self, names: Sequence[str] | None, count: int) -> tuple[str, ...]:
        """These classes, or the `count` largest. Raises BadField for an unknown one."""
        if names is None:
            return self.classes[:count]
        for name in names:
            if name not in self.classes:
                tasks = ", ".join(self.classes[:MAX_TASKS_IN_MESSAGE])
                message = f"no two recordings carry the task {name!r}, only the tasks {tasks}"
                raise fields.bad_field("classes", message)
        return tuple(dict.fromkeys(names))


def read_labeled(lib: Library, filter: ClipFilter | None) -> LabeledClips:
    """Read the labeled clips. Raises NotEnoughLabels unless there are two classes to separate."""
    with lib.store.read() as tx:
        ids = sorted(clip_listing.list_ids(tx, ready_only(filter)))
        return labeled_among(tuple(clips.get_many(tx, ids).values()))


def labeled_among(ready: Sequence[ClipRecord]) -> LabeledClips:
    """The labeled ones of these clips. Raises NotEnoughLabels as `read_labeled`."""
    labeled = tuple(clip for clip in ready if clip.task)
    recording = {clip.id: recording_of_clip(clip) for clip in labeled}
    takes = Counter(task for task, _ in {(clip.task, recording[clip.id]) for clip in labeled})
    sizes = Counter(clip.task for clip in labeled if takes[clip.task] > 1)
    classes = tuple(sorted(filter(None, sizes), key=lambda task: (-sizes[task], task)))
    if not classes:
        raise NotEnoughLabels("No two ready clips carry the same task, so nothing can be judged.")
    if len(classes) == len(takes) == 1:
        raise NotEnoughLabels(
            f"All labeled clips carry the task {classes[0]!r}, so every answer would be right. "
            "Clips of a second task are needed."
        )
    codes = {task: number for number, task in enumerate(classes)}
    return LabeledClips(
        clips=labeled,
        classes=classes,
        code={clip.id: codes.get(clip.task or "", len(classes)) for clip in labeled},
        recording=recording,
        unlabeled=len(ready) - len(labeled),
    )
