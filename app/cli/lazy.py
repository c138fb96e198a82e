"""Imports the module of a command only when the command is used, so that the program starts fast.

A group has the name, the module and one line of help of each command. This is enough to list the
commands. The module of a command is imported when the command runs, or when its own help is shown.
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
class CommandEntry:
    """The definition of a command.

    module: the name of its module. attribute: the function of the command in that module, or the
    Typer object of a group of commands. help: the line in the list of commands.
    """

    module: str
    attribute: str
    help: str

    def load(self, name: str) -> Any:
        """Import the module and return the command, ready to run."""
        definition = getattr(import_module(self.module), self.attribute)
        if isinstance(definition, typer.Typer):
            definition.rich_markup_mode = None  # see `app.cli.main.program`
            group = get_group(definition)
            group.name = name
            return group
        # Typer turns functions into commands only inside a Typer object
        single = typer.Typer(add_completion=False, rich_markup_mode=None)
        single.command(name)(definition)
        return get_command(single)


class LazyGroup(TyperGroup):
    """A group that lists its commands from `entries`. `lazy_group` makes subclasses that set it."""

    entries: Mapping[str, CommandEntry] = {}

    def __init__(self, **attrs: Any) -> None:
        super().__init__(**attrs)
        for name, entry in self.entries.items():
            self.add_command(TyperCommand(name, help=entry.help))

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Import the command that `args` name; returns its name, the command and its arguments."""
        name, command, rest = super().resolve_command(ctx, args)
        if name is not None and name in self.entries:
            command = self.entries[name].load(name)
        return name, command, rest


def lazy_group(entries: Mapping[str, CommandEntry]) -> type[LazyGroup]:
    """The class of a group with these commands, by name, for `typer.Typer(cls=...)`."""
    return type("LazyGroup", (LazyGroup,), {"entries": entries})
