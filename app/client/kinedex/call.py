"""One call of the HTTP API as a value, from which the synchronous and the asynchronous client send.

So each call is described once. `kinedex.methods` turns a function that builds a call into a method:
it returns the answer in a `Kinedex`, and an awaitable of the answer in an `AsyncKinedex`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Generic, TypeVar
from urllib.parse import quote

from kinedex.records import Record
from kinedex.sent import UNSET, FileInput, Progress

if TYPE_CHECKING:
    import httpx2

Answer = TypeVar("Answer", covariant=True)
Kind = TypeVar("Kind", bound=Record)

JSON = "application/json"
OCTETS = "application/octet-stream"


@dataclass(frozen=True, slots=True)
class Call(Generic[Answer]):
    """A call and how its answer is read.

    operation: the operation's id in the OpenAPI description. json: the body, UNSET without one.
    fields, files: the parts of a form; a call that takes JSON or a form sends a form only if it has
    files. accept: the media type of the answer.
    """

    operation: str
    method: str
    path: str
    read: Callable[[httpx2.Response], Answer]
    query: Mapping[str, Any] = field(default_factory=dict)
    json: Any = UNSET
    fields: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[str, FileInput] = field(default_factory=dict)
    accept: str = JSON
    progress: Progress | None = None


def path_of(template: str, **parts: str | int) -> str:
    """The path of a call: the names in braces are replaced by quoted texts and by numbers."""
    return template.format(**{name: quote(str(part), safe="") for name, part in parts.items()})


def record(kind: type[Kind]) -> Callable[[httpx2.Response], Kind]:
    """A function that reads an answer as `kind`."""
    return lambda response: kind.from_json(response.json())


def record_if_any(kind: type[Kind]) -> Callable[[httpx2.Response], Kind | None]:
    """Like `record`, but None if the answer has no content (204)."""
    return lambda response: kind.from_json(response.json()) if response.content else None


def text(response: httpx2.Response) -> str:
    """Read an answer as text."""
    return response.text


def read_bytes(response: httpx2.Response) -> bytes:
    """Read an answer as bytes."""
    return response.content


def value(response: httpx2.Response) -> Any:
    """Read an answer of JSON without a type."""
    return response.json()


def nothing(response: httpx2.Response) -> None:  # noqa: ARG001 - has the signature of the others
    """Read an answer without content."""
    return
