"""The base of all failures, and the places that a failure names. Standard library only."""

from __future__ import annotations

import inspect
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

MAX_DETAIL = 2000
MAX_LOCATION = 600
MAX_MESSAGE = 1000
"""Characters. A failure may quote what a client sent, which can have any length."""
MAX_STORED_PLACES = 20
"""Places of a failure that are stored with a clip, a job or a file of an import."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where something is wrong (a line, joint, frame or field), and what was expected there."""

    location: str
    message: str

    def shortened(self) -> Place:
        """A copy whose texts are cut to MAX_LOCATION and MAX_MESSAGE characters."""
        return Place(shortened(self.location, MAX_LOCATION), shortened(self.message, MAX_MESSAGE))


def shortened(text: str, max_length: int) -> str:
    """The text; if it has more than `max_length` characters, its beginning and an ellipsis."""
    return text if len(text) <= max_length else f"{text[: max_length - 1]}…"


class KinedexError(Exception):
    """Something went wrong in Kinedex."""

    code: ClassVar[str] = "internal"

    def __init__(self, detail: str | None = None, *, places: Iterable[Place] = ()) -> None:
        self.detail = shortened(detail or self.title(), MAX_DETAIL)
        self.places = tuple(place.shortened() for place in places)
        super().__init__(self.detail)

    @classmethod
    def title(cls) -> str:
        """The first line of the class's docstring, without its full stop."""
        return (inspect.getdoc(cls) or cls.__name__).splitlines()[0].rstrip(".")

    def as_problem(self) -> dict[str, Any]:
        """The members of an RFC 9457 problem that do not depend on HTTP, as the store keeps it."""
        return {
            "title": self.title(),
            "detail": self.detail,
            "code": self.code,
            "errors": [
                {"location": place.location, "message": place.message}
                for place in self.places[:MAX_STORED_PLACES]
            ],
        }

    def __reduce__(self) -> tuple[Any, ...]:
        # Failures are pickled to cross process boundaries, and pickle does not pass the
        # keyword-only argument `places`.
        return (_rebuild, (type(self), self.detail, self.places))


def _rebuild(kind: type[KinedexError], detail: str, places: tuple[Place, ...]) -> KinedexError:
    return kind(detail, places=places)
