"""Options that several commands have."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from app.errors import BadField
from app.kinedex_error import Place

FilterJson = Annotated[
    str | None,
    typer.Option(
        "--filter", help='JSON, for example {"task": ["walk", "run"], "not_source": "my studio"}.'
    ),
]
IncludeSelf = Annotated[
    bool, typer.Option("--include-self", help="Let the query itself be a hit, if it is stored.")
]
By = Annotated[
    str | None,
    typer.Option(
        "--by",
        help="Figures for each group of clips too: by person, task, license, source, folder, format"
        " or meta.KEY.",
    ),
]
PictureFormat = Annotated[
    str, typer.Option(help="Format of the pictures in a folder: svg, png or pdf.")
]


def filter_of(text: str | None) -> dict[str, Any]:
    """The fields of a filter in a JSON text; empty without a text. Raises BadField."""
    try:
        fields = json.loads(text) if text else {}
    except ValueError as problem:
        raise BadField("The filter is not JSON.", places=[Place("filter", str(problem))]) from None
    if not isinstance(fields, dict):
        raise BadField("The filter must be a JSON object.", places=[Place("filter", str(text))])
    return fields


def metadata_of(pairs: Sequence[str]) -> dict[str, Any]:
    """The metadata in texts like KEY=VALUE; an empty value is None. Raises BadParameter."""
    from app.store.clips.metadata_values import from_cell

    metadata: dict[str, Any] = {}
    for pair in pairs:
        key, equals, value = pair.partition("=")
        if not equals or not key.strip():
            raise typer.BadParameter(f"{pair!r}: write KEY=VALUE", param_hint="--meta")
        metadata[key.strip()] = from_cell(value.strip()) if value.strip() else None
    return metadata
