from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.motion_shape import SHAPE_LENGTH, clearance, mirrored
from app.errors import NotEnoughLabels
from app.models.synthesis import prediction as synthesis_prediction
from app.models.synthesis.basis import parts, weights
from app.models.synthesis.model import Synthesis, fit_synthesis
from app.models.synthesis.prediction import predict
from app.models.synthesis.solving import PART_RIDGE, WHOLE_RIDGE, effects_only, solve
from tests.models.invented_shapes import InventedShapes, invented_shapes


@pytest.fixture(scope="module")
def all_cells() -> InventedShapes:
    return invented_shapes()


@pytest.fixture(scope="module")
def lacking(all_cells: InventedShapes) -> Synthesis:
    left = all_cells.without("p0", "t0")
    return fit_synthesis(left.shapes, left.persons, left.tasks)


def far(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.linalg.norm((one - other) * weights()))


def slow_solve(basis: np.ndarray, target: np.ndarray, own: np.ndarray) -> np.ndarray:
    """Each set of weights by stacked least squares with the ridge as further rows."""
    scale, (persons, tasks, _) = weights(), basis.shape
    every = np.stack([np.vstack([rows, mirrored(rows)]) for rows in basis]) * scale
    mine = np.vstack([own, mirrored(own)]) * scale

    def fitted(columns: np.ndarray, prior: np.ndarray, ridge: float) -> np.ndarray:
        rows = np.vstack([every[k][:, columns].T for k in range(persons)])
        aim = np.concatenate([(target[k] * scale)[columns] for k in range(persons)])
        pull = np.sqrt(ridge * (rows**2).sum() / (2 * tasks)) * np.eye(2 * tasks)
        aims = np.concatenate([aim, pull @ prior])
        return np.linalg.lstsq(np.vstack([rows, pull]), aims, rcond=None)[0]

    prior = np.array([1 / tasks] * tasks + [0.0] * tasks)
    shared = fitted(np.arange(SHAPE_LENGTH), prior, WHOLE_RIDGE)
    made = np.zeros(SHAPE_LENGTH)
    for part in parts():
        w = fitted(part, shared, PART_RIDGE)
        left = [(target[k] * scale)[part] - w @ every[k][:, part] for k in range(persons)]
        made[part] = w @ mine[:, part] + np.mean(left, axis=0)
    return made / scale


def test_the_parts_are_the_whole_body_once() -> None:
    np.testing.assert_array_equal(np.sort(np.concatenate(parts())), np.arange(SHAPE_LENGTH))


def test_the_solution_is_that_of_stacked_least_squares(all_cells: InventedShapes) -> None:
    cells = np.array([[all_cells.cell(f"p{p}", f"t{t}") for t in range(4)] for p in range(3)])
    args = cells[1:, :3], cells[1:, 3], cells[0, :3]
    np.testing.assert_allclose(solve(*args).shape, slow_solve(*args), atol=1e-8)


def test_a_task_is_predicted_for_a_person_who_never_did_it(
    all_cells: InventedShapes, lacking: Synthesis
) -> None:
    truth = all_cells.cell("p0", "t0")
    own = lacking.tasks_of("p0")
    made = predict(lacking, own, "t0").shape
    others = np.array([lacking.tasks_of(name)["t0"] for name in lacking.who_did("t0")])
    basis = np.array(
        [[lacking.tasks_of(name)[task] for task in own] for name in lacking.who_did("t0")]
    )
    added = effects_only(basis, others, np.array(list(own.values())))
    assert far(made, truth) < 0.5 * far(added, truth)
    assert far(made, truth) < 0.5 * far(others.mean(axis=0), truth)


def test_more_takes_of_the_person_improve_the_prediction(
    all_cells: InventedShapes, lacking: Synthesis
) -> None:
    truth, own = all_cells.cell("p0", "t0"), lacking.tasks_of("p0")
    names = sorted(own)
    off = [
        far(
            predict(lacking, {n: own[n] for n in names[:count]}, "t0", exclude=("p0",)).shape, truth
        )
        for count in (1, 3, 5)
    ]
    assert off[0] > off[1] > off[2]


def test_missing_cells_are_predicted(all_cells: InventedShapes) -> None:
    left = all_cells.without("p0", "t0").without("p1", "t1").without("p2", "t3")
    made = predict(fit := fit_synthesis(left.shapes, left.persons, left.tasks),
                   fit.tasks_of("p0"), "t0").shape  # fmt: skip
    assert np.isfinite(made).all()
    truth = all_cells.cell("p0", "t0")
    others = np.mean([fit.tasks_of(name)["t0"] for name in ("p1", "p2", "p3")], axis=0)
    assert far(made, truth) < far(others, truth)


def test_a_mirrored_task_helps_to_predict_the_other_side() -> None:
    rng = np.random.default_rng(1)
    right = rng.normal(size=(3, SHAPE_LENGTH))
    right[:, -2:] = 0.0
    still = np.tile(rng.normal(size=SHAPE_LENGTH) * 0.1, (3, 1))
    still[:, -2:] = 0.0
    left = mirrored(right)
    made = solve(np.stack([right, still], axis=1)[1:], left[1:], np.stack([right[0], still[0]]))
    assert far(made.shape, left[0]) < 0.2 * far(left[1:].mean(axis=0), left[0])


def moments(shapes: np.ndarray) -> np.ndarray:
    return shapes[..., :-2].reshape(*shapes.shape[:-1], 32, 43)


def test_of_an_unrelated_task_only_the_posture_is_used() -> None:
    rng = np.random.default_rng(4)
    stance, bearing = np.pad(np.tile(rng.normal(size=(2, 43)), 32), ((0, 0), (0, 2)))
    kick, bow = 4 * stance + rng.normal(size=(2, 3, SHAPE_LENGTH))
    own = 4 * stance + rng.normal(size=(1, SHAPE_LENGTH))
    upright, bent = (solve(kick[:, None], bow, own + b).shape for b in (0 * bearing, bearing))
    mean = moments(bow.mean(axis=0))
    for made in (upright, bent):
        away = moments(made) - mean
        np.testing.assert_allclose(away, np.broadcast_to(away[:1], away.shape), atol=0.05)
    moved = moments(bent - upright)[0]
    assert np.corrcoef(moved, moments(bearing)[0])[0, 1] > 0.7


def test_a_prediction_is_at_a_usual_height_above_the_floor(
    all_cells: InventedShapes, lacking: Synthesis
) -> None:
    own = lacking.tasks_of("p0")
    bent = {name: shape.copy() for name, shape in own.items()}
    for shape in bent.values():  # the feet drawn up, the hips where they were
        moments(shape)[:, :39].reshape(32, 13, 3)[:, :, 1] += 0.3
    others = np.array([lacking.tasks_of(name)["t0"] for name in lacking.who_did("t0")])
    there = clearance(moments(others))
    for given in (own, bent):
        made = clearance(moments(predict(lacking, given, "t0", exclude=("p0",)).shape))
        assert (made >= there.min(axis=0) - 1e-9).all()
        assert (made <= there.max(axis=0) + 1e-9).all()


def test_cells_that_are_partly_cyclic_keep_the_more_frequent_kind() -> None:
    made = invented_shapes(persons=2, tasks=2, takes=3)
    made.shapes[:2, -1] = 1.0
    found = fit_synthesis(made.shapes, made.persons, made.tasks)
    np.testing.assert_allclose(found.cell("p0", "t0"), made.shapes[:2].mean(axis=0), atol=1e-12)


def test_a_model_is_stored_completely_and_fits_are_equal(
    all_cells: InventedShapes, lacking: Synthesis
) -> None:
    arrays, meta = lacking.to_arrays()
    again = Synthesis.from_arrays(arrays, meta)
    own = lacking.tasks_of("p0")
    np.testing.assert_allclose(
        predict(again, again.tasks_of("p0"), "t0").shape,
        predict(lacking, own, "t0").shape,
        atol=1e-4,
    )
    left = all_cells.without("p0", "t0")
    twin = fit_synthesis(left.shapes, left.persons, left.tasks)
    assert all(
        np.asarray(a).tobytes() == np.asarray(twin.to_arrays()[0][name]).tobytes()
        for name, a in arrays.items()
    )
    with pytest.raises(ValueError, match="version"):
        Synthesis.from_arrays(arrays, meta | {"version": 0})


def test_too_few_labels_are_refused_with_what_is_needed(lacking: Synthesis) -> None:
    shape = np.zeros((2, SHAPE_LENGTH))
    with pytest.raises(NotEnoughLabels, match="two persons and of two tasks"):
        fit_synthesis(shape, ["a", None], ["x", "y"])
    with pytest.raises(NotEnoughLabels, match="two persons did"):
        fit_synthesis(shape, ["a", "b"], ["x", "y"])
    with pytest.raises(NotEnoughLabels, match="another task"):
        predict(lacking, {"t0": shape[0]}, "t0")
    with pytest.raises(NotEnoughLabels, match="Another person must have a clip"):
        predict(lacking, lacking.tasks_of("p0"), "t0", exclude=("p1", "p2", "p3"))


def test_of_a_large_library_the_most_similar_tasks_and_persons_are_used(
    all_cells: InventedShapes, lacking: Synthesis, monkeypatch: pytest.MonkeyPatch
) -> None:
    truth, own = all_cells.cell("p0", "t0"), lacking.tasks_of("p0")
    everything = predict(lacking, own, "t0").shape
    monkeypatch.setattr(synthesis_prediction, "MAX_TASKS", 4)
    monkeypatch.setattr(synthesis_prediction, "MAX_PERSONS", 2)
    made = predict(lacking, own, "t0").shape
    mean = np.mean([lacking.tasks_of(name)["t0"] for name in ("p1", "p2", "p3")], axis=0)
    assert not np.array_equal(made, everything)
    assert far(made, truth) < far(mean, truth)
