"""Pictures of keyposes: figures 4 and 5 for a library, figures 3 and 6 for any of its clips."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from app.analysis.keyposes.candidates import Scope
from app.evaluate.charts import Curve, Format, Panel, curves_picture, shown
from app.evaluate.charts.drawing import rendered
from app.evaluate.keyposes.evaluation import KeyposeEvaluation
from app.motion.frame.body_frame import turned
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from app.services.figures.stick_figure import LEFT, RIGHT, TRUNK
from app.services.library.library import Library
from app.services.training.training_set import ready_only
from app.services.views.keyposes import KeyposesView, view
from app.store.clips import listing as clip_listing
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

COLORS = {Scope.GLOBAL: "#D55E00", Scope.LOCAL: "#009E73", Scope.TURN: "#CC79A7"}
REASONS = {Scope.GLOBAL: "global energy", Scope.LOCAL: "local energy", Scope.TURN: "turning point"}
ANNOTATED = "#0072B2"
BEAT = "#888888"
INCHES_PER_SECOND = 0.9
WIDTH_RANGE = (7.0, 36.0)
"""Smallest and largest width of a picture, in inches."""
FIGURES_PER_INCH = 1.4
VIEW_ANGLE = 0.6
"""Radians from the front, so that arms before the body are visible."""
FIGURE_DISTANCE = 1.3
"""Distance between two stick figures in meters."""

_LIMBS = [
    (SUN_ROLES.index(role), SUN_ROLES.index(role.toward_trunk()))
    for role in SUN_ROLES
    if role.toward_trunk() is not role
]


def threshold_figure(evaluation: KeyposeEvaluation, form: Format) -> bytes:
    """Precision and recall over T1 and over T2, with a row for each method."""
    panels = [
        Panel(
            [Curve(curve.values, curve.precision, "precision"),
             Curve(curve.values, curve.recall, "recall")],
            title=f"{judged.method}, {other} = {held:g}",
            x_label=name,
            y_range=(0.0, 1.02),
            marked=[at],
        )
        for judged in evaluation.methods
        for name, curve, at, other, held in (
            ("T1", judged.t1, judged.learned.t1, "T2", judged.learned.t2),
            ("T2", judged.t2, judged.learned.t2, "T1", judged.learned.t1),
        )
    ]  # fmt: skip
    title = f"Keyposes of {len(evaluation.clips)} clips, within {evaluation.tolerance:g} s"
    return curves_picture(panels, form, title=title)


def clips_to_draw(lib: Library, filter: ClipFilter | None) -> tuple[ClipRecord, ...]:
    """The ready clips that pass the filter, with or without annotation."""
    with lib.store.read() as tx:
        ids = sorted(clip_listing.list_ids(tx, ready_only(filter)))
        return tuple(clips.get_many(tx, ids).values())


def clip_figure(lib: Library, clip: ClipRecord, form: Format) -> bytes:
    """`keypose_figure` of a stored clip. Raises ClipNotFound, ClipNotReady."""
    return keypose_figure(view(lib, clip.id), clip.name, form)


def keypose_figure(seen: KeyposesView, name: str, form: Format) -> bytes:
    """A clip's energies over time with its beats and keyposes, and the poses below."""
    found = seen.found
    seconds = len(found.global_energy) / seen.frame_rate
    width = float(np.clip(INCHES_PER_SECOND * seconds, *WIDTH_RANGE))
    max_figures = int(FIGURES_PER_INCH * width)

    def draw(figure: Figure) -> None:
        tempo = "no beat" if found.beats.tempo is None else f"{found.beats.tempo:.0f} bpm"
        figure.suptitle(f"{shown(name)}: {len(found.frames)} keyposes, {tempo}")
        rows = figure.subplots(3, 1, height_ratios=[1, 1, 1.1])
        for axes, scope, values in (
            (rows[0], Scope.GLOBAL, found.global_energy),
            (rows[1], Scope.LOCAL, found.local_energy),
        ):
            _draw_energy(axes, seen, values, scope)
        rows[1].set_xlabel("seconds")
        lines = _legend(seen)
        rows[0].legend(
            lines.values(), lines, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(lines)
        )
        _draw_poses(rows[2], seen, max_figures)

    return rendered(draw, (width, 6.0), form)


def _legend(seen: KeyposesView) -> dict[str, Line2D]:
    from matplotlib.lines import Line2D

    lines = {
        f"keypose by {REASONS[scope]}": Line2D([], [], color=color, linewidth=1.8)
        for scope, color in COLORS.items()
    }
    if seen.named is not None:
        lines["named keypose"] = Line2D([], [], color=ANNOTATED, linestyle=(0, (6, 2)))
    if len(seen.found.beats.times):
        lines["beat"] = Line2D([], [], color=BEAT, linestyle=":")
    return lines


def _draw_energy(axes: Axes, seen: KeyposesView, values: FloatArray, scope: Scope) -> None:
    times = np.arange(len(values)) / seen.frame_rate
    # a jump after a first frame that does not belong to the motion must not set the scale
    high = float(np.quantile(values, 0.995)) * 1.15 or 1.0
    axes.plot(times, values, color="#222222", linewidth=1.1)
    axes.set(xlim=(0.0, times[-1]), ylim=(0.0, high), ylabel=f"{scope.value} energy")
    for beat in seen.found.beats.times:
        axes.axvline(beat, color=BEAT, linestyle=":", linewidth=0.8)
    for time, by in zip(seen.found.times, seen.found.chosen_by, strict=True):
        axes.axvline(time, color=COLORS[by], linewidth=1.8 if by is scope else 0.8)
    for time in seen.named or ():
        axes.axvline(time, color=ANNOTATED, linestyle=(0, (6, 2)), linewidth=1.2)


def _draw_poses(axes: Axes, seen: KeyposesView, max_figures: int) -> None:
    """Stick figures of the keyposes; at most `max_figures`, evenly chosen."""
    axes.set_axis_off()
    axes.set_aspect("equal")
    count = len(seen.found.frames)
    chosen = np.unique(np.linspace(0, max(count - 1, 0), min(max_figures, count)).astype(int))
    for column, index in enumerate(chosen):
        pose = seen.poses[index] - seen.poses[index][SUN_ROLES.index(JointRole.HIPS)]
        pose = turned(pose[None], np.array([VIEW_ANGLE - _heading(pose)]))[0]
        for end, start in _LIMBS:
            role = SUN_ROLES[end].value
            ink = LEFT if role.startswith("left") else RIGHT if role.startswith("right") else TRUNK
            x, y = pose[[end, start], 0] + FIGURE_DISTANCE * column, pose[[end, start], 1]
            axes.plot(x, y, color=ink, linewidth=1.4)
        axes.text(
            FIGURE_DISTANCE * column,
            -1.25,
            f"{seen.found.times[index]:.1f} s",
            ha="center",
            va="top",
        )


def _heading(pose: FloatArray) -> float:
    """Radians about Y from Z to the direction that the shoulders face."""
    names = [role.value for role in SUN_ROLES]
    left = pose[names.index("left_shoulder")] - pose[names.index("right_shoulder")]
    return float(np.arctan2(-left[2], left[0]))
