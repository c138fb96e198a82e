"""A pool of child processes that may be killed at any moment.

Each child has its own pipe and does one task at a time. If a child dies, only its own task fails.
The time of a task is measured by the kernel's monotonic clock, in the wait for the pipe: a change
of the wall clock does not end a task.

This pool is ours, because the pools of libraries have one of three faults. They share one pipe and
one lock among all children (a child that is killed while it sends its result stops all others);
they end for good when the server that forks the children dies; or they measure time by the wall
clock.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future, InvalidStateError
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, TypeVar

from app.services.children.child import Answer, Child, ChildEnded, Task

_Result = TypeVar("_Result")

TASKS_PER_CHILD = 500
"""A child is replaced after this number of tasks, in case a library leaks memory."""

BEGIN_TRIES = 3
"""How often a task is sent to a child, if the child dies before it takes the task."""


class TaskTimedOut(Exception):
    """A task took longer than its time limit, and its child was killed."""


@dataclass(eq=False, slots=True)
class _Submitted:
    """A task for a child; is_alone: do it while no other task of the pool runs."""

    task: Task
    is_alone: bool
    future: Future[Any] = field(default_factory=Future)
    child: Child | None = None


class ChildPool:
    """At most `size` child processes. They start when there is work. Threads may share the pool.

    prepare, arguments: each child calls `prepare(*arguments)` before its first task.
    """

    def __init__(self, size: int, prepare: Callable[..., None], *arguments: Any) -> None:
        self._size = size
        self._prepare, self._arguments = prepare, arguments
        self._changed = threading.Condition()
        self._waiting: deque[_Submitted] = deque()
        self._busy = 0
        self._is_one_alone = False
        self._is_closed = False
        self._threads: list[threading.Thread] = []
        self._children: set[Child] = set()

    def submit(
        self,
        work: Callable[..., _Result],
        *arguments: Any,
        seconds: float | None = None,
        is_alone: bool = False,
        files: Sequence[str] = (),
    ) -> Future[_Result]:
        """Begin a task. Its future gets the result of `work`, or the error that it raised.

        seconds: time limit; after it the child is killed and the future gets TaskTimedOut; None:
        no limit. files: paths of files that the task can open by `given_files.open_given`; the
        future gets the OSError if one cannot be opened. If the child dies, the future gets
        ChildEnded. Canceling the future kills the child, even while it works. Raises RuntimeError
        if the pool is closed.
        """
        task = _Submitted(Task(work, arguments, seconds, tuple(files)), is_alone)
        with self._changed:
            if self._is_closed:
                raise RuntimeError("The pool is closed.")
            self._waiting.append(task)
            if len(self._threads) < min(self._size, self._busy + len(self._waiting)):
                self._start_thread()
            self._changed.notify_all()
        return task.future

    def close(self) -> None:
        """Kill the children, cancel the waiting tasks, and return when all children have ended."""
        with self._changed:
            self._is_closed = True
            for task in self._waiting:
                task.future.cancel()
            for child in self._children:
                child.kill()
            self._changed.notify_all()
        for thread in self._threads:
            thread.join()

    def _start_thread(self) -> None:
        thread = threading.Thread(target=self._work, name="children", daemon=True)
        self._threads.append(thread)
        thread.start()

    def _work(self) -> None:
        """One thread for each child: it waits for a task and then for the child."""
        child: Child | None = None
        while (task := self._next()) is not None:
            try:
                child = self._do(task, child)
            except Exception as failure:  # noqa: BLE001 - the task must end after any error
                child = None
                _end(task.future, failure)
            finally:
                with self._changed:
                    self._busy -= 1
                    self._is_one_alone = False
                    self._changed.notify_all()
        if child is not None:
            self._drop(child)

    def _next(self) -> _Submitted | None:
        """Wait for the next task that may begin. Returns None if the pool is closed."""
        with self._changed:
            while not self._is_closed:
                if self._waiting and self._may_begin(self._waiting[0]):
                    self._busy += 1
                    self._is_one_alone = self._waiting[0].is_alone
                    return self._waiting.popleft()
                self._changed.wait()
        return None

    def _may_begin(self, task: _Submitted) -> bool:
        return self._busy == 0 if task.is_alone else not self._is_one_alone

    def _do(self, task: _Submitted, child: Child | None) -> Child | None:
        """Do a task in a child; returns the child if it is still alive."""
        # The future stays pending while the child works: a running future cannot be canceled.
        task.future.add_done_callback(lambda _: self._kill_if_cancelled(task))
        for is_last_try in (*(False,) * (BEGIN_TRIES - 1), True):
            if task.future.cancelled():
                break
            child = self._usable(child)
            try:
                answer = self._run(task, child)
            except (ChildEnded, TaskTimedOut) as failure:
                self._drop(child)
                child = None
                if not is_last_try and isinstance(failure, ChildEnded) and not failure.had_begun:
                    continue  # the child died before it took the task: another child takes it
                _end(task.future, failure)
            except OSError as failure:  # a file of the task cannot be opened
                _end(task.future, failure)
            else:
                _end(task.future, answer.failure, answer.value)
            break
        if task.future.cancelled():
            _end(task.future, None)
            if child is not None:
                self._drop(child)  # the cancellation may have killed it after its last answer
            return None
        return child

    def _usable(self, child: Child | None) -> Child:
        """The child, or a new one if the child has ended or has done TASKS_PER_CHILD tasks."""
        if child is not None and (child.tasks >= TASKS_PER_CHILD or child.has_ended()):
            self._drop(child)
            child = None
        return child or self._new_child()

    def _run(self, task: _Submitted, child: Child) -> Answer:
        with self._changed:
            task.child = child
        try:
            return child.do(task.task)
        except TimeoutError:
            raise TaskTimedOut from None
        finally:
            with self._changed:
                task.child = None  # a late cancellation must not kill the child's next task

    def _kill_if_cancelled(self, task: _Submitted) -> None:
        with self._changed:
            if task.future.cancelled() and task.child is not None:
                task.child.kill()

    def _new_child(self) -> Child:
        child = Child.start(self._prepare, self._arguments)
        with self._changed:
            self._children.add(child)
            if self._is_closed:
                child.kill()  # `close` ran before this child was in `_children`
        return child

    def _drop(self, child: Child) -> None:
        with self._changed:
            self._children.discard(child)
        child.end()


def _end(future: Future[Any], failure: BaseException | None, value: Any = None) -> None:
    """Set the result or the failure of a future, unless it was canceled meanwhile."""
    with suppress(InvalidStateError):
        if failure is None:
            future.set_result(value)
        else:
            future.set_exception(failure)
    if future.cancelled():
        # This wakes callers of `concurrent.futures.wait`, which `cancel` alone does not.
        with suppress(RuntimeError):
            future.set_running_or_notify_cancel()
