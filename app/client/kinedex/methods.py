"""Turns functions that build calls into methods of the two clients."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from functools import wraps
from typing import Any, ClassVar, Generic, ParamSpec, Protocol, Self, TypeVar, overload

from kinedex.call import Call
from kinedex.pages import AsyncPages, Pages
from kinedex.records import Page

P = ParamSpec("P")
Answer = TypeVar("Answer")
Item = TypeVar("Item")
SenderType = TypeVar("SenderType", covariant=True)


class Sender(Protocol):
    """A client that sends calls and waits for their answers."""

    is_blocking: ClassVar[bool]

    def send(self, call: Call[Answer]) -> Answer:
        """Send a call and return its answer. Raises KinedexError."""

    def lines(self, path: str) -> Iterator[str]:
        """The lines of an answer while they arrive. Raises KinedexError."""


class AsyncSender(Protocol):
    """A client that sends calls without blocking."""

    is_blocking: ClassVar[bool]

    async def send(self, call: Call[Answer]) -> Answer:
        """Send a call and return its answer. Raises KinedexError."""

    def lines(self, path: str) -> AsyncIterator[str]:
        """The lines of an answer while they arrive. Raises KinedexError."""


class Group(Generic[SenderType]):
    """The methods of one kind of object, as in `client.clips`."""

    def __init__(self, sender: SenderType) -> None:
        self.sender = sender


class CallMethod(Generic[P, Answer]):
    """A method that sends one call: it returns the answer, or an awaitable of it."""

    def __init__(self, build: Callable[P, Call[Answer]]) -> None:
        self.build = build
        self.__doc__ = build.__doc__

    @overload
    def __get__(self, group: None, owner: Any = None) -> Self: ...
    @overload
    def __get__(self, group: Group[Sender], owner: Any = None) -> Callable[P, Answer]: ...
    @overload
    def __get__(
        self, group: Group[AsyncSender], owner: Any = None
    ) -> Callable[P, Awaitable[Answer]]: ...
    def __get__(self, group: Any, owner: Any = None) -> Any:
        if group is None:
            return self

        @wraps(self.build)
        def method(*args: P.args, **kwargs: P.kwargs) -> Any:
            return group.sender.send(self.build(*args, **kwargs))

        return method


class ListMethod(Generic[P, Item]):
    """A method that lists objects. It returns pages that are fetched during the iteration."""

    def __init__(self, build: Callable[P, Call[Page[Item]]]) -> None:
        self.build = build
        self.__doc__ = build.__doc__

    @overload
    def __get__(self, group: None, owner: Any = None) -> Self: ...
    @overload
    def __get__(self, group: Group[Sender], owner: Any = None) -> Callable[P, Pages[Item]]: ...
    @overload
    def __get__(
        self, group: Group[AsyncSender], owner: Any = None
    ) -> Callable[P, AsyncPages[Item]]: ...
    def __get__(self, group: Any, owner: Any = None) -> Any:
        if group is None:
            return self
        pages: Any = Pages if group.sender.is_blocking else AsyncPages

        @wraps(self.build)
        def method(*args: P.args, **kwargs: P.kwargs) -> Any:
            return pages(self.build(*args, **kwargs), group.sender.send)

        return method
