"""The generated files: a file of calls for each module of routes, and of types for each of schemas.

The modules of the server are only used to group the client's code. Names, types and descriptions
come from the OpenAPI description.
"""

from __future__ import annotations

import importlib
import pkgutil
import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from fastapi.routing import APIRoute
from pydantic import BaseModel

import app.api.schemas
from app.api.app import ROUTES, create_app
from app.config import Settings
from tests.client.generator.functions import Functions
from tests.client.generator.models import Models
from tests.client.generator.names import GROUPS, ROOT, group_doc
from tests.client.generator.operations import Operation, operations
from tests.client.generator.schemas import closure, references

ROOT_FOLDER = Path(__file__).resolve().parents[3]
CLIENT = ROOT_FOLDER / "app" / "client" / "kinedex"
TYPES = "kinedex.types."
NOTE = "Generated from the OpenAPI description by `make client`."
IMPORTS = {
    "dataclass": "dataclasses",
    "datetime": "datetime",
    "Mapping": "collections.abc",
    "Sequence": "collections.abc",
    "Any": "typing",
    "Literal": "typing",
    "NotRequired": "typing",
    "TypeAlias": "typing",
    "TypedDict": "typing",
    "Array": "kinedex.records",
    "Page": "kinedex.records",
    "Record": "kinedex.records",
    "Call": "kinedex.call",
    "OCTETS": "kinedex.call",
    "read_bytes": "kinedex.call",
    "nothing": "kinedex.call",
    "path_of": "kinedex.call",
    "record": "kinedex.call",
    "record_if_any": "kinedex.call",
    "text": "kinedex.call",
    "value": "kinedex.call",
    "Positions": "kinedex.positions",
    "positions": "kinedex.positions",
    "FileInput": "kinedex.sent",
    "Progress": "kinedex.sent",
    "UNSET": "kinedex.sent",
    "Unset": "kinedex.sent",
    "corrections": "kinedex.sent",
    "given": "kinedex.sent",
    "Group": "kinedex.methods",
    "ListMethod": "kinedex.methods",
    "CallMethod": "kinedex.methods",
    "SenderType": "kinedex.methods",
}
_DOCSTRING = re.compile(r'""".*?"""', re.DOTALL)
_WORD = re.compile(r"\b[A-Za-z_]\w*\b")


@cache
def service() -> Any:
    """The application, which is never started."""
    return create_app(Settings())


@cache
def description() -> dict[str, Any]:
    """The OpenAPI description of this version."""
    found: dict[str, Any] = service().openapi()
    return found


@cache
def generated() -> dict[str, str]:
    """The generated files: their code by path in the package."""
    writer = _Writer(description())
    files = writer.types() | writer.calls() | {"groups.py": writer.groups()}
    return _tidied(files)


class _Writer:
    def __init__(self, document: dict[str, Any]) -> None:
        self.schemas = document["components"]["schemas"]
        self.operations = list(operations(document))
        self.models = Models(self.schemas)
        self.functions = Functions(self.schemas)
        self.homes = dict(IMPORTS)
        self.route_modules = _route_modules()

    def types(self) -> dict[str, str]:
        """The types of answers by module of schemas, of choices and of bodies."""
        answers = {
            name
            for one in self.operations
            for name in references([*map(dict, one.answers.values())])
        }
        bodies = {name for one in self.operations for name in references(_sent_schemas(one))}
        received, sent = closure(answers, self.schemas), closure(bodies, self.schemas)
        choices = {name for name in received | sent if "enum" in self.schemas[name]}
        files = {"types/choices.py": choices, "types/bodies.py": sent - choices}
        for name in received - choices:
            files.setdefault(f"types/{_schema_modules().get(name, 'values')}.py", set()).add(name)
        for path, names in files.items():
            self.homes |= dict.fromkeys(names, f"kinedex.{path[:-3].replace('/', '.')}")
        return {path: self._types_file(path, names) for path, names in files.items() if names}

    def _types_file(self, path: str, names: set[str]) -> str:
        kind = Path(path).stem
        write = {"choices": self.models.choice, "bodies": self.models.sent}.get(
            kind, self.models.record
        )
        doc = {"choices": "Texts that values may be", "bodies": "Objects that calls send"}.get(
            kind, f"Answers: {kind.replace('_', ' ')}"
        )
        return self._file(doc, [write(name) for name in self.models.in_order(names)], path)

    def calls(self) -> dict[str, str]:
        """The functions of the operations by module of routes."""
        by_module: dict[str, list[str]] = defaultdict(list)
        for one in self.operations:
            by_module[self.route_modules[one.id]] += self.functions.of(one)
        files = {}
        for module, functions in by_module.items():
            path = f"calls/{module}.py"
            files[path] = self._file(f"Calls: {module.replace('_', ' ')}", functions, path)
        return files

    def groups(self) -> str:
        """The groups of methods."""
        methods: dict[str, list[str]] = {name: [] for name in GROUPS}
        for one in self.operations:
            methods.setdefault(one.name.group, []).extend(self._methods(one))
        root = methods.pop(ROOT)
        classes = [_group_class(name, lines) for name, lines in methods.items()]
        attributes = [
            f"        self.{name} = {_class_name(name)}(sender)"
            for name in methods
            if name != "jobs"
        ]
        classes.append(
            "class RootBase(Group[SenderType]):\n"
            '    """All groups except jobs, and the methods of the client itself."""\n\n'
            + "\n".join(root)
            + "\n\n    def __init__(self, sender: SenderType) -> None:\n"
            + "        super().__init__(sender)\n"
            + "\n".join(attributes)
            + "\n"
        )
        return self._file("Groups of methods", classes, "groups.py")

    def _methods(self, one: Operation) -> list[str]:
        module, item = self.route_modules[one.id], self.functions.item_of(one)
        lines = []
        for function in self.functions.of(one):
            name = re.match(r"def (\w+)", function)
            assert name is not None
            suffix = name[1].removeprefix(one.id)
            kind = "CallMethod" if item is None else "ListMethod"
            made = f"{kind}(calls_{module}.{name[1]})"
            lines.append(f"    {one.name.name}{suffix} = {made}")
        return lines

    def _file(self, doc: str, parts: list[str], path: str) -> str:
        is_calls = path.startswith("calls/")
        code = "\n\n".join(map(self._with_late_import, parts) if is_calls else parts)
        words = set(_WORD.findall(_DOCSTRING.sub("", code)))
        home = f"kinedex.{path[:-3].replace('/', '.')}"
        homes = {
            name: module
            for name, module in self.homes.items()
            if name in words and module != home and not _is_argument(name, code)
        }
        late = {name for name, module in homes.items() if is_calls and module.startswith(TYPES)}
        lines = [f"from {homes[name]} import {name}" for name in homes.keys() - late]
        if late:
            lines.append("from typing import TYPE_CHECKING")
        lines += [
            f"from kinedex.calls import {module} as calls_{module}"
            for module in sorted(set(self.route_modules.values()))
            if f"calls_{module}" in words
        ]
        head = f'"""{doc}. {NOTE}"""\n\nfrom __future__ import annotations\n'
        checked = [f"    from {homes[name]} import {name}" for name in sorted(late)]
        imports = [*sorted(lines), *(["if TYPE_CHECKING:"] if late else []), *checked]
        return f"{head}\n" + "\n".join(imports) + f"\n\n{code}"

    def _with_late_import(self, function: str) -> str:
        """The function with an import of the type of its answer, where it is used.

        So a program loads only the types of the calls that it sends: all of them together are
        hundreds of classes, which take longer to make than a call takes.
        """
        found = re.search(r"\brecord(?:_if_any)?\((\w+)\)", function)
        if found is None:
            return function
        late = f"    from {self.homes[found[1]]} import {found[1]}\n\n"
        return function.replace("    return Call(", f"{late}    return Call(")


def _is_argument(name: str, code: str) -> bool:
    """Whether a helper's name is only the name of an argument, as in `text=text`."""
    bare = re.sub(rf"\b{name}\b(=|: )\s*({name}\b)?", "", _DOCSTRING.sub("", code))
    return name.islower() and re.search(rf"\b{name}\b", bare) is None


def _sent_schemas(one: Operation) -> list[Any]:
    return [dict(parameter.schema) for parameter in one.parameters]


def _group_class(name: str, lines: list[str]) -> str:
    head = f"class {_class_name(name)}(Group[SenderType]):\n"
    return f'{head}    """{group_doc(name)}"""\n\n' + "\n".join(lines) + "\n"


def _class_name(group: str) -> str:
    return "JobsBase" if group == "jobs" else "".join(part.title() for part in group.split("_"))


def _route_modules() -> dict[str, str]:
    """The module of routes of each operation, by its id."""
    modules = {
        route.name: module.__name__.rpartition(".")[2]
        for module in ROUTES
        for route in module.router.routes
        if isinstance(route, APIRoute)
    }
    return defaultdict(lambda: "service", modules)


@cache
def _schema_modules() -> dict[str, str]:
    """The module of schemas that defines each model, by its name."""
    found = {}
    for one in pkgutil.iter_modules(app.api.schemas.__path__):
        module = importlib.import_module(f"app.api.schemas.{one.name}")
        for name, kind in vars(module).items():
            is_model = isinstance(kind, type) and issubclass(kind, BaseModel)
            if is_model and kind.__module__ == module.__name__:
                found[name] = one.name
    return found


def _tidied(files: Mapping[str, str]) -> dict[str, str]:
    """The files without unused imports, and formatted as all code of the repository."""
    ruff = str(Path(sys.executable).with_name("ruff"))
    options = ["--quiet", "--no-cache", "--config", str(ROOT_FOLDER / "pyproject.toml")]
    with tempfile.TemporaryDirectory() as folder:
        for name, code in files.items():
            path = Path(folder, name)
            path.parent.mkdir(exist_ok=True)
            path.write_text(code)
        for command in (["check", "--select", "I,F401", "--fix", "--exit-zero"], ["format"]):
            subprocess.run([ruff, *command, *options, folder], check=True)
        return {name: Path(folder, name).read_text() for name in files}
