"""Draws figures and curves as SVG, PNG or PDF. The same input gives the same bytes.

Pictures need matplotlib, the extra `plots`; no other part of Kinedex needs it.
"""

from app.evaluate.charts.confusion import confusion_picture, confusions_picture
from app.evaluate.charts.curves import Curve, Panel, curves_picture
from app.evaluate.charts.drawing import Format, format_of, need_plots, shown
from app.evaluate.charts.matrices import Slices, matrices_picture, volumes_picture
from app.evaluate.charts.scatter import Cloud, scatter_picture

__all__ = [
    "Cloud",
    "Curve",
    "Format",
    "Panel",
    "Slices",
    "confusion_picture",
    "confusions_picture",
    "curves_picture",
    "format_of",
    "matrices_picture",
    "need_plots",
    "scatter_picture",
    "shown",
    "volumes_picture",
]
