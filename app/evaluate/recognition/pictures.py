"""Pictures of an evaluation of recognition: confusion matrices, and curves of false rejection
against false acceptance of unknown labels."""

from __future__ import annotations

from app.evaluate.charts import Curve, Format, Panel, confusion_picture, curves_picture
from app.evaluate.recognition.results import HeldOut, Judged, RecognitionEvaluation
from app.evaluate.recognition.rounds import LeftOut

METHODS_WITHOUT_MOTION = ("prior",)
"""Methods that do not look at the motion. They are not drawn."""


def all_figures(found: RecognitionEvaluation, form: Format) -> dict[str, bytes]:
    """Every picture by file name: confusions by factor and method, and the curves."""
    pictures = {}
    for judged in _methods_to_draw(found.held_out.get(LeftOut.TAKE)):
        for factor in judged.confusion:
            content = confusion_figure(judged, factor, form)
            if content is not None:
                pictures[f"confusion-{factor}-{judged.method}.{form}"] = content
    curves = unknown_figure(found, form)
    if curves is not None:
        pictures[f"unknown.{form}"] = curves
    return pictures


def confusion_figure(judged: Judged, factor: str, form: Format) -> bytes | None:
    """The confusion matrix of one factor by one method; None if none of its labels was judged."""
    names, shares = judged.confusion[factor]
    if not names:
        return None
    share = judged.recognized.person if factor == "person" else judged.recognized.task
    title = f"{factor}s by {judged.method}, takes left out: {share.right} of {share.of} right"
    return confusion_picture(shares, names, form, title=title, rows=f"true {factor}")


def unknown_figure(found: RecognitionEvaluation, form: Format) -> bytes | None:
    """False rejection against false acceptance of new persons and of new tasks, all methods.

    None if neither could be judged.
    """
    panels = []
    for way, factor in ((LeftOut.PERSON, "person"), (LeftOut.TASK, "task")):
        curves = [
            Curve(
                judged.unknown[factor].curve[:, 0],
                judged.unknown[factor].curve[:, 1],
                judged.method,
            )
            for judged in _methods_to_draw(found.held_out.get(way))
            if factor in judged.unknown
        ]
        if curves:
            panels.append(
                Panel(
                    curves,
                    title=f"new {factor}s",
                    x_label=f"new {factor}s called known",
                    y_label=f"known {factor}s called new",
                    y_range=(-0.02, 1.02),
                )
            )
    if not panels:
        return None
    return curves_picture(panels, form, title="Detection of new labels at every threshold")


def _methods_to_draw(held: HeldOut | None) -> list[Judged]:
    return [one for one in held.methods if one.method not in METHODS_WITHOUT_MOTION] if held else []
