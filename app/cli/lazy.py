"""Commands that are imported when they are used, so that the program starts at once.

A group knows the name, the module and one line of help of each command. That is enough to list
the commands; the module of a command is imported only when this command is run, or when its own
help is shown.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command, get_group


@dataclass(frozen=True, slots=True)
class CommandPlace:
    """Where a command is defined.

    module: what to import; attribute: the function of the command in it, or the typer of a group
    of commands; help: the line that the list of commands shows.
    """

    module: str
    attribute: str
    help: str

    def load(self, name: str) -> Any:
        """Import the module and return the command, ready to run."""
        found = getattr(import_module(self.module), self.attribute)
        if isinstance(found, typer.Typer):
            group = get_group(found)
            group.name = name
            return group
        alone = typer.Typer(add_completion=False)
        alone.command(name)(found)
        return get_command(alone)


class LazyGroup(TyperGroup):
    """A group that lists its commands from `places`; subclasses made by `lazy_group` set it."""

    places: Mapping[str, CommandPlace] = {}

    def __init__(self, **attrs: Any) -> None:
        super().__init__(**attrs)
        for name, place in self.places.items():
            self.add_command(TyperCommand(name, help=place.help))

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """The command that `args` name, imported now, and the arguments that are left for it."""
        name, command, rest = super().resolve_command(ctx, args)
        if name is not None and name in self.places:
            command = self.places[name].load(name)
        return name, command, rest


def lazy_group(places: Mapping[str, CommandPlace]) -> type[LazyGroup]:
    """The class of a group with these commands, by name: what `typer.Typer(cls=...)` takes."""
    return type("LazyGroup", (LazyGroup,), {"places": places})
