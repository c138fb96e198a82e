"""How well the symbol space of a library preserves the divergences (Takano, fig. 3)."""

from __future__ import annotations

import numpy as np

from app.evaluate.charts import Curve, Format, Panel, curves_picture
from app.models.held_out.symbols import SymbolFigures, symbol_figures
from app.models.words.correlated_words import chosen_dimensions
from app.services.library.library import Library
from app.services.training.training_set import read_training_set, ready_only
from app.store.clips.filter import ClipFilter


def judge_symbols(lib: Library, filter: ClipFilter | None = None) -> SymbolFigures:
    """The figures of the ready clips' symbols. Raises NotEnoughLabels."""
    training = read_training_set(lib.store, ready_only(filter))
    return symbol_figures(training.symbols, training.label_sets, training.groups)


def draw_symbols(found: SymbolFigures, form: Format) -> bytes:
    """The error by the number of dimensions (fig. 3), for each scaling method."""
    dimensions = np.array([errors.dimensions for errors in found.errors], dtype=float)
    curves = [
        Curve(dimensions, np.array([getattr(errors, way) for errors in found.errors]), name)
        for way, name in (
            ("classical", "classical scaling"),
            ("smacof", "SMACOF"),
            ("s_stress", "error of eq. 3 minimized"),
        )
    ]
    panel = Panel(
        curves,
        x_label="dimensions of the motion symbol space",
        y_label="error T a pair (eq. 3)",
        log_y=True,
        marked=(10,),
    )
    return curves_picture([panel], form, title=_title(found), columns=1)


def _title(found: SymbolFigures) -> str:
    if not found.losses:
        return f"{found.symbols} motion symbols"
    chosen = chosen_dimensions(found.losses)
    return f"{found.symbols} motion symbols; the mode cca uses {chosen} dimensions"
