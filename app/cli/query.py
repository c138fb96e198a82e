"""The command that searches by several parts together, and says why a clip is a hit."""

from __future__ import annotations

import inspect
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.hits import print_hits
from app.cli.options import FilterJson, IncludeSelf, filter_of
from app.cli.output import AsCsv, AsJson, print_csv, print_json, print_table
from app.cli.session import open_client
from app.errors import BadField
from app.kinedex_error import Place

if TYPE_CHECKING:
    from kinedex.types.why import HitReason, HitReasons


def query(
    context: typer.Context,
    like: Annotated[
        list[str] | None, typer.Option(help="The id of a clip as an example; may be repeated.")
    ] = None,
    unlike: Annotated[
        list[str] | None, typer.Option(help="The same of a clip that hits must not be like.")
    ] = None,
    words: Annotated[
        list[str] | None,
        typer.Option(help="Words or a sentence; -word leaves out clips with it; may be repeated."),
    ] = None,
    body: Annotated[
        str | None,
        typer.Option(
            help="Any members of POST /v1/search: a JSON object, or the path of a file with one."
        ),
    ] = None,
    why: Annotated[
        str | None, typer.Option(help="The id of a clip: say why it is a hit, instead of hits.")
    ] = None,
    limit: Annotated[int, typer.Option(help="Largest number of hits, 1 to 1000.")] = 10,
    filter_json: FilterJson = None,
    include_self: IncludeSelf = False,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Find motions by several parts together, or say why a clip is a hit of them."""
    asked = _members(body)
    examples: list[dict[str, Any]] = [{"clip_id": clip_id} for clip_id in like or ()]
    examples += [{"clip_id": clip_id, "against": True} for clip_id in unlike or ()]
    if examples:
        asked["examples"] = [*asked.get("examples", ()), *examples]
    if words:
        asked["words"] = [*asked.get("words", ()), *words]
    if filter_json is not None:
        asked["filter"] = filter_of(filter_json)
    asked = {"limit": limit, "include_self": include_self, **asked}
    with open_client(context) as client:
        call: Any = client.search.parts if why is None else client.search.why
        _check_names(call, asked)
        found = call(**asked) if why is None else call(hit=why, **asked)
    if why is None:
        print_hits(found, (), as_json=as_json, as_csv=as_csv)
    else:
        _print_reasons(found, as_json=as_json, as_csv=as_csv)


def _members(text: str | None) -> dict[str, Any]:
    """The members of a body in a JSON text or a file. Raises BadField."""
    if text is None:
        return {}
    try:
        members = json.loads(text if text.lstrip().startswith("{") else Path(text).read_text())
    except (OSError, ValueError) as problem:
        message = f"--body is no JSON object and no file with one: {problem}"
        raise BadField(message, places=[Place("body", str(problem))]) from None
    if not isinstance(members, dict):
        raise BadField("--body must be a JSON object.", places=[Place("body", text)])
    return members


def _check_names(call: Any, members: dict[str, Any]) -> None:
    """Raises BadField for members that the call does not take."""
    unknown = sorted(set(members) - set(inspect.signature(call).parameters))
    if unknown:
        places = [Place(name, "is no member of POST /v1/search") for name in unknown]
        raise BadField(f"--body has unknown members: {', '.join(unknown)}", places=places)


def _print_reasons(found: HitReasons, *, as_json: bool, as_csv: bool) -> None:
    columns = ("part", "against", "weight", "score", "cost", "differs", "moment")
    rows = [_row(one) for one in found.parts]
    if as_json:
        print_json(found.to_json())
    elif as_csv:
        print_csv(columns, [dict(zip(columns, row, strict=True)) for row in rows])
    else:
        rank = "not among the first 300 hits" if found.rank is None else f"hit {found.rank}"
        typer.echo(f"{found.clip_id}: {rank}, score {found.score:.3f}")
        print_table(columns, rows, cut=("differs",))


def _row(one: HitReason) -> tuple[Any, ...]:
    """A part, the joints that differ most, and the time of the hit that speaks most."""
    differs, moment = "", None
    if one.alignment is not None:
        ranked = sorted(
            zip(one.alignment.mean_differences, one.alignment.joints, strict=True), reverse=True
        )
        differs = ", ".join(f"{joint} {100 * meters:.0f} cm" for meters, joint in ranked[:2])
        moment = one.alignment.peaks[0].times[1] if one.alignment.peaks else None
    elif one.curve is not None:
        moment = one.curve.times[
            max(range(len(one.curve.values)), key=one.curve.values.__getitem__)
        ]
    return one.part, one.against, one.weight, one.score, one.cost, differs, moment
