"""Kinds of path parameters that Starlette does not have.

A path like `/v1/models/fit` also fits `/v1/models/{model_id}`. If the parameter took it, then
`PATCH /v1/models/fit` would look for a model called "fit" instead of answering 405.
"""

from __future__ import annotations

import re

from starlette.convertors import PathConvertor, StringConvertor, register_url_convertor


class LabelConvertor(PathConvertor):
    """The rest of a path as one label. A label may hold slashes, also at its end.

    Starlette's `path` refuses line ends and accepts an empty rest. Here, a line end is part of the
    label, so that the check of labels can refuse it. An empty rest is refused, because it is the
    path of the list.
    """

    regex = "(?s:.+)"


def register_label() -> str:
    """Register LabelConvertor; returns its name in paths."""
    register_url_convertor("label", LabelConvertor())
    return "label"


def register_other_than(name: str, *taken: str) -> str:
    """Register a kind of parameter for one part of a path that is none of the texts `taken`.

    Returns its name in paths: `{model_id:model}` for the name "model".
    """
    others = "|".join(re.escape(text) for text in taken)
    regex = f"(?!(?:{others})(?:/|$))[^/]+"
    register_url_convertor(name, type("OtherThan", (StringConvertor,), {"regex": regex})())
    return name
