"""The commands for the tree of labels."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.output import AsJson, print_json
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex.types.label_tree import LabelNode, LabelTreeAnswer

program = typer.Typer(help="Show and change the tree of tasks and words.", no_args_is_help=True)
PEOPLE = "people"


@program.command("tree")
def tree(context: typer.Context, as_json: AsJson = False) -> None:
    """Show which task or word is a kind of which, with the number of clips of each task."""
    with open_client(context) as client:
        _print(client.labels.tree(), as_json)


@program.command("kinds")
def kinds(
    context: typer.Context,
    parents: Annotated[
        list[str],
        typer.Argument(
            metavar="LABEL=PARENT...", help="jog=run; box= says that box is a kind of nothing."
        ),
    ],
    as_json: AsJson = False,
) -> None:
    """Say which label is a kind of which. What was said about other labels stays."""
    said: dict[str, str | None] = {}
    for text in parents:
        label, equals, parent = text.partition("=")
        if not equals or not label.strip():
            raise typer.BadParameter(f"{text!r}: write LABEL=PARENT")
        said[label.strip()] = parent.strip() or None
    with open_client(context) as client:
        before = client.labels.tree().items
        kept = {node.name: node.parent for node in before if node.because == PEOPLE}
        _print(client.labels.put_tree({**kept, **said}), as_json)


@program.command("forget-kinds")
def forget_kinds(context: typer.Context, as_json: AsJson = False) -> None:
    """Forget what people said about the tree."""
    with open_client(context) as client:
        _print(client.labels.put_tree({}), as_json)


def _print(found: LabelTreeAnswer, as_json: bool) -> None:
    if as_json:
        print_json(found.to_json())
        return
    below: dict[str | None, list[LabelNode]] = defaultdict(list)
    for node in found.items:
        below[node.parent].append(node)
    waiting = [(node, 0) for node in reversed(below[None])]
    while waiting:
        node, depth = waiting.pop()
        count = f" ({node.tasks_below})" if node.tasks_below else ""
        typer.echo(f"{'  ' * depth}{node.name}{count}")
        waiting += [(child, depth + 1) for child in reversed(below[node.name])]
