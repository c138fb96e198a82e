"""The figures of Perera 2009, section 4, for a library: variance and error (11), eigen poses
(7, 8), eigen motion (9), motions of few dimensions (10), an impossible pose (13, 14)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.analysis.low_dimensional.eigen_motion import (
    PAPER_DIMENSIONS,
    Basis,
    eigen_model,
    low_dimensional,
)
from app.evaluate.charts import Cloud, Curve, Format, Panel, curves_picture, scatter_picture, shown
from app.evaluate.low_dimensional.evaluation import JudgedClip, LowDimensionalEvaluation, WorstPose
from app.motion.frame.body_frame import BodyTrack
from app.numerics.arrays import FloatArray
from app.numerics.clusteredness import best_clusters
from app.services.figures.animated_figure import animated_svg
from app.services.views.animations import role_figure

AXES = ("first axis", "second axis", "third axis")
PLAYED_DIMENSIONS = (1, 2, 3, 4)
"""Dimensions of the motions in figure 10."""
MAX_PLAYED_FRAMES = 40 * 30
"""Largest number of frames of an animated motion: 40 s."""


def all_figures(found: LowDimensionalEvaluation, form: Format) -> dict[str, bytes]:
    """Pictures by file name. Animations, and pictures of bodies, are always SVG."""
    clips = found.shown_group or (found.shown,)
    pictures = {f"variance-and-error.{form}": variance_figure(found, form)}
    for basis in Basis:
        name = {Basis.KEYPOSE: "eigen-keyposes", Basis.UNIFORM: "eigen-uniform-poses"}[basis]
        pictures[f"{name}.{form}"] = eigen_poses_figure(clips, basis, form)
    pictures[f"eigen-motion.{form}"] = eigen_motion_figure(found.shown, form)
    pictures["dimensions.svg"] = dimensions_figure(found.shown)
    if found.worst is not None:
        pictures["implausible.svg"] = implausible_figure(found.worst)
    return pictures


def variance_figure(found: LowDimensionalEvaluation, form: Format) -> bytes:
    """Figure 11, and beside it the errors of the motions, which the paper does not show."""
    rows = found.dimensions
    at = np.array([row.dimensions for row in rows])
    variances = [
        Curve(at, np.array([row.variance[basis.value] for row in rows]), basis.value)
        for basis in Basis
    ]
    errors = [
        Curve(at, np.array([row.error[basis.value] for row in rows]), basis.value)
        for basis in Basis
    ]
    least = Curve(at, np.array([row.best for row in rows]), "all frames")
    return curves_picture(
        [
            Panel(variances, "of the model's own poses", "dimensions", "variance kept"),
            Panel([*errors, least], "of the whole motion", "dimensions", "error, mm"),
        ],
        form,
        title=f"Means over {found.clips} clips",
    )


def eigen_poses_figure(clips: Sequence[JudgedClip], basis: Basis, form: Format) -> bytes:
    """Figure 7 or 8: the poses of all clips along the first axes; colors show clusters."""
    poses = np.concatenate([one.poses(basis) for one in clips])
    points = eigen_model(poses).coordinates(poses, PAPER_DIMENSIONS)
    found = best_clusters(points)
    name = clips[0].clip.task if len(clips) > 1 else clips[0].clip.name
    kind = "keyposes" if basis is Basis.KEYPOSE else "uniform poses"
    title = f"{len(poses)} {kind} of {shown(name or '')}"
    if found is None:
        return scatter_picture([Cloud(points)], form, title=title, axes=AXES)
    clouds = [
        Cloud(points[found.labels == label], f"cluster {number}")
        for number, label in enumerate(np.unique(found.labels), 1)
    ]
    title += f"; silhouette {found.silhouette:.2f}"
    return scatter_picture(clouds, form, title=title, axes=AXES)


def eigen_motion_figure(one: JudgedClip, form: Format) -> bytes:
    """Figure 9: a motion as a curve through its keyposes."""
    model = one.models[Basis.KEYPOSE]
    clouds = [
        Cloud(model.coordinates(one.track.local, PAPER_DIMENSIONS), "motion", joined=True),
        Cloud(model.coordinates(one.poses(Basis.KEYPOSE), PAPER_DIMENSIONS), "keyposes"),
    ]
    return scatter_picture(clouds, form, title=shown(one.clip.name), axes=AXES)


def dimensions_figure(one: JudgedClip) -> bytes:
    """Figure 10 as an animation: from one dimension to four, and the original."""
    track = one.track.part(0, MAX_PLAYED_FRAMES)
    model = one.models[Basis.KEYPOSE]
    figures = [
        role_figure(low_dimensional(model, track, count).positions, _counted(count))
        for count in PLAYED_DIMENSIONS
        if count <= model.poses
    ]
    figures.append(role_figure(track.positions, "original"))
    return animated_svg(figures, track.rate, one.clip.name).encode()


def implausible_figure(worst: WorstPose) -> bytes:
    """Figures 13 and 14: one moment of both reductions, with the original between them."""
    one, frame = worst.judged, worst.fault.worst
    moment = one.track.part(frame, frame + 1)
    figures = [
        role_figure(_reduced_positions(one, Basis.KEYPOSE, moment), Basis.KEYPOSE.value),
        role_figure(moment.positions, "original"),
        role_figure(_reduced_positions(one, Basis.UNIFORM, moment), Basis.UNIFORM.value),
    ]
    fault = worst.fault
    title = f"{one.clip.name} at {frame / one.track.rate:.2f} s: {worst.basis}, {fault.joint}"
    return animated_svg(figures, one.track.rate, f"{title} {fault.fault}").encode()


def _reduced_positions(one: JudgedClip, basis: Basis, track: BodyTrack) -> FloatArray:
    return low_dimensional(one.models[basis], track, PAPER_DIMENSIONS).positions


def _counted(dimensions: int) -> str:
    return "1 dimension" if dimensions == 1 else f"{dimensions} dimensions"
