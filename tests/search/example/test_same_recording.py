"""A clip with the recording of the query: how surely it has it, and how it speaks for the query."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.analysis.analyze import describe_for_search
from app.motion.motion import Motion
from app.search.example.by_example import COMPARED
from app.search.example.methods import Method
from app.search.example.same_recording import HALF, MOST_BELIEF, SameRecording, same_recording
from app.search.example.window_distances import SCALE
from app.search.index.vector_index import PACED, VECTOR
from tests.bodies import motion_of, walking, waving
from tests.search.local_index import LocalLibrary


def test_a_clip_far_below_the_level_of_the_others_has_the_recording() -> None:
    found = same_recording(np.array([0.3, 0.35, 0.02, 0.33, np.inf]))
    assert found == SameRecording(2, MOST_BELIEF)
    two_files = same_recording(np.array([0.05, 0.3, 0.04, 0.33]))
    assert two_files == SameRecording(2, MOST_BELIEF)


def test_clips_that_contain_the_query_alike_have_not() -> None:
    assert same_recording(np.array([0.21, 0.21, 0.22, 0.3])) is None
    assert same_recording(np.full(5, np.inf)) is None
    assert same_recording(np.zeros(4)) is None
    assert same_recording(np.zeros(2)) is None


@given(ratio=st.floats(0.0, 1.0), level=st.floats(0.05, 0.4))
def test_belief_is_half_at_the_given_ratio_and_falls_with_it(ratio: float, level: float) -> None:
    def belief(smallest: float) -> float:
        found = same_recording(np.array([level, smallest, level]))
        return found.belief if found else 0.0

    assert np.isclose(belief(HALF * level), 0.5)
    assert belief(ratio * level) >= belief(min(1.0, ratio + 0.1) * level)
    assert 0.0 <= belief(ratio * level) <= MOST_BELIEF


def test_a_recording_is_near_and_the_others_are_as_far_as_from_it() -> None:
    own, others = np.array([2.0, 3.0, 5.0]), np.array([0.0, 4.0, 1.0])
    found = SameRecording(0, 0.75).seen(own, others)
    assert found.tolist() == [0.25 * 2.0, 0.25 * 3.0 + 0.75 * 4.0, 0.25 * 5.0 + 0.75 * 1.0]


def _turned_and_waved() -> dict[str, Motion]:
    """Walks on several curves and waves of several sizes."""
    bodies = {f"walk {n}": walking(arm=0.2 + 0.1 * n, turn=0.3 * n) for n in range(5)}
    bodies |= {f"wave {n}": waving(3 + 0.3 * n) for n in range(5)}
    return {name: motion_of(body) for name, body in bodies.items()}


def test_the_recording_speaks_against_a_misleading_vector() -> None:
    """The query is half of a walk, but its vectors say that it is a wave."""
    names = (*COMPARED, SCALE.vectors)
    motions = _turned_and_waved()
    library = LocalLibrary(
        {name: describe_for_search(motion, names).arrays for name, motion in motions.items()}
    )
    whole = motions["walk 3"]
    part = replace(whole, positions=whole.positions[: whole.frames // 2])
    misleading = {name: library.clips["wave 3"][name] for name in (VECTOR, PACED)}
    query = {**describe_for_search(part, names).arrays, **misleading}
    found = library.rank(query, Method.FUSED).ids.tolist()
    assert found[0] == "walk 3"
    assert {name.split()[0] for name in found[:5]} == {"walk"}
    by_vectors = library.rank(query, Method.FUSED, is_any_tempo=False).ids.tolist()
    assert by_vectors[0].startswith("wave")
