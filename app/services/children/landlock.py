"""Landlock: this process can open only some files from now on, and cannot undo that.

Three system calls of Linux (since 5.13; kernel documentation, *Landlock: unprivileged access
control*), through ctypes: `landlock` on PyPI has had only development releases, and knows neither
the network (ABI 4) nor signals (ABI 6). Every right of the kernel's ABI is taken away; rules give
back reading and writing below some paths. Files that are open already stay usable.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

_CREATE, _ADD_RULE, _RESTRICT = 444, 445, 446
"""Numbers of the system calls, the same on all processors."""
_ASK_VERSION = 1
_PATH_BENEATH = 1
_NO_NEW_PRIVILEGES = 38
"""Option of prctl: without it, only root may restrict itself."""

_WRITE_FILE, _READ_FILE, _READ_DIR, _TRUNCATE = 1 << 1, 1 << 2, 1 << 3, 1 << 14
_REMOVE_FILE, _MAKE_FOLDER, _MAKE_FILE, _REFER = 1 << 5, 1 << 7, 1 << 8, 1 << 13
_READ = _READ_FILE | _READ_DIR
_WRITE = _READ | _WRITE_FILE | _TRUNCATE | _REMOVE_FILE | _MAKE_FOLDER | _MAKE_FILE | _REFER
_OF_A_FILE = _READ_FILE | _WRITE_FILE | _TRUNCATE
_FILE_RIGHTS = {1: 13, 2: 14, 3: 15, 4: 15, 5: 16}
"""The number of rights on files by ABI; later ABIs have as many as 5."""
NETWORK_ABI, SIGNALS_ABI = 4, 6
_NETWORK_RIGHTS = 0b11
"""Bind and connect TCP sockets."""
_SCOPES = 0b11
"""Abstract UNIX sockets of, and signals to, processes outside."""

_libc = ctypes.CDLL(None, use_errno=True)


class _Ruleset(ctypes.Structure):
    _fields_ = (
        ("files", ctypes.c_uint64),
        ("network", ctypes.c_uint64),
        ("scope", ctypes.c_uint64),
    )


class _PathRule(ctypes.Structure):
    _pack_ = 1
    _fields_ = (("rights", ctypes.c_uint64), ("folder", ctypes.c_int32))


def abi() -> int:
    """The version of Landlock of this kernel; 0 if it has none, or does not allow it."""
    try:
        return max(_call(_CREATE, None, 0, _ASK_VERSION), 0)
    except OSError:
        return 0


def restrict(readable: Iterable[Path], writable: Iterable[Path]) -> None:
    """Take all rights on files but those to read and write below some paths.

    Paths that do not exist are left out. Also takes TCP connections and signals to other
    processes, where the kernel can. It holds for this thread and those that it starts. Raises
    OSError.
    """
    version = abi()
    rights = (1 << _FILE_RIGHTS.get(version, 16)) - 1
    network = _NETWORK_RIGHTS if version >= NETWORK_ABI else 0
    scope = _SCOPES if version >= SIGNALS_ABI else 0
    ruleset = _Ruleset(rights, network, scope)
    size = 24 if scope else 16 if network else 8
    number = _call(_CREATE, ctypes.byref(ruleset), size, 0)
    try:
        for path in readable:
            _allow(number, path, _READ & rights)
        for path in writable:
            _allow(number, path, _WRITE & rights)
        forbid_new_privileges()
        _call(_RESTRICT, number, 0)
    finally:
        os.close(number)


def forbid_new_privileges() -> None:
    """No program that this process starts can gain rights, as by setuid. Raises OSError."""
    if _libc.prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0):
        raise _failure("prctl")


def _allow(ruleset: int, path: Path, rights: int) -> None:
    with suppress(FileNotFoundError, NotADirectoryError):
        folder = os.open(path, os.O_PATH | os.O_CLOEXEC)
        try:
            given = rights if path.is_dir() else rights & _OF_A_FILE
            rule = _PathRule(given, folder)
            _call(_ADD_RULE, ruleset, _PATH_BENEATH, ctypes.byref(rule), 0)
        finally:
            os.close(folder)


def _call(number: int, *arguments: object) -> int:
    sent = [ctypes.c_long(one) if isinstance(one, int) else one for one in arguments]
    result = int(_libc.syscall(ctypes.c_long(number), *sent))
    if result < 0:
        raise _failure(f"system call {number}")
    return result


def _failure(what: str) -> OSError:
    code = ctypes.get_errno()
    return OSError(code, f"{what}: {os.strerror(code)}")
