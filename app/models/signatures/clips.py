"""The parameters of single clips: the signature and the action that each of them shows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from app.models.recognition.multilinear import Multilinear
from app.models.signatures.eigenmotions import Eigenmotions
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class ClipParameters:
    """The parameters of a clip.

    signature: (R1,) p = B_a^-T d, None if the model does not know the clip's task. action: (R2,)
    a = C_p^-T d, None if it does not know the person. weights: (R3,) of the eigenmotions.
    """

    signature: FloatArray | None
    action: FloatArray | None
    weights: FloatArray


def clip_parameters(
    model: Multilinear,
    motions: Eigenmotions,
    samples: FloatArray,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
) -> list[ClipParameters]:
    """The parameters of n clips (Vasilescu 2002, section 5).

    samples: (n, w); persons, tasks: (n,) labels. As at the fit, the poses of a clip are warped onto
    the mean of its task, if the model has such means.
    """
    aligned = np.array(
        [
            sample if task not in model.tasks or task is None else model.aligned(sample, task)
            for sample, task in zip(samples, tasks, strict=True)
        ]
    )
    signatures = _by_label(aligned, tasks, model.tasks, model.signature)
    actions = _by_label(aligned, persons, model.persons, model.action)
    weights = motions.weights(aligned)
    return [ClipParameters(*each) for each in zip(signatures, actions, weights, strict=True)]


def _by_label(
    samples: FloatArray,
    labels: Sequence[str | None],
    known: Sequence[str],
    solve: Callable[[FloatArray, str], FloatArray],
) -> list[FloatArray | None]:
    """(n,) the solution for each sample (n, w); None for a label that is not `known`.

    The samples of one label are solved together, so that its basis is inverted once.
    """
    found: list[FloatArray | None] = [None] * len(samples)
    for label in known:
        places = [place for place, own in enumerate(labels) if own == label]
        if not places:
            continue
        for place, row in zip(places, solve(samples[places], label), strict=True):
            found[place] = row
    return found
