"""A filter of system calls: this process can open no socket and start no process from now on.

The filter is a program of Berkeley Packet Filter (kernel documentation, *Seccomp BPF*), which this
module writes itself: `pyseccomp` needs libseccomp, which the image does not have. Threads may still
be started, since numerical libraries do. Calls that would lead around the filter (io_uring) or into
other processes are refused too.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct
from dataclasses import dataclass
from pathlib import Path

from app.services.children.landlock import forbid_new_privileges

_SET_SECCOMP, _FILTER_MODE = 22, 2
_LOAD, _JUMP_EQUAL, _JUMP_ANY_BIT, _JUMP_GREATER, _RETURN = 0x20, 0x15, 0x45, 0x25, 0x06
"""Instructions: load a word, compare and jump, return."""
_NUMBER_AT, _PROCESSOR_AT, _FIRST_ARGUMENT_AT = 0, 4, 16
"""Places in `struct seccomp_data`; of the argument, the lower half."""
_ALLOW, _REFUSE = 0x7FFF0000, 0x00050000
_THREAD = 0x00010000
"""The flag of `clone` for a thread."""
_X32 = 0x3FFFFFFF
"""Larger numbers are calls of another kind on x86-64."""


@dataclass(frozen=True, slots=True)
class _Processor:
    """Numbers of a kind of processor. refused: system calls; clone: the one with flags."""

    audit: int
    clone: int
    clone3: int
    refused: tuple[int, ...]


# In the order: socket, fork, vfork, execve, execveat, ptrace, process_vm_readv, process_vm_writev,
# io_uring_setup, bpf, userfaultfd, perf_event_open, pidfd_getfd, keyctl, unshare, setns, mount.
# ARM has no fork and no vfork.
_PROCESSORS = {
    "x86_64": _Processor(
        0xC000003E,
        56,
        435,
        (41, 57, 58, 59, 322, 101, 310, 311, 425, 321, 323, 298, 438, 250, 272, 308, 165),
    ),
    "aarch64": _Processor(
        0xC00000B7,
        220,
        435,
        (198, 221, 281, 117, 270, 271, 425, 280, 282, 241, 438, 219, 97, 268, 40),
    ),
}


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_void_p))


def is_known() -> bool:
    """Whether there is a filter for this processor, and the kernel takes filters."""
    return platform.machine() in _PROCESSORS and Path("/proc/sys/kernel/seccomp").exists()


def restrict() -> None:
    """Refuse sockets and new processes, for this thread and those that it starts.

    Refused calls raise PermissionError. Raises OSError if there is no such filter.
    """
    processor = _PROCESSORS.get(platform.machine())
    if processor is None:
        raise OSError(errno.ENOSYS, f"no filter for {platform.machine()}")
    code = ctypes.create_string_buffer(_filter(processor))
    program = _Program((len(code) - 1) // 8, ctypes.addressof(code))
    forbid_new_privileges()
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(_SET_SECCOMP, _FILTER_MODE, ctypes.byref(program), 0, 0):
        failure = ctypes.get_errno()
        raise OSError(failure, f"seccomp: {os.strerror(failure)}")


def _filter(processor: _Processor) -> bytes:
    """The program. Jumps count the instructions that are skipped if true, and if false."""
    refuse = (_RETURN, 0, 0, _REFUSE | errno.EPERM)
    allow = (_RETURN, 0, 0, _ALLOW)
    lines = [
        (_LOAD, 0, 0, _PROCESSOR_AT),
        (_JUMP_EQUAL, 1, 0, processor.audit),
        refuse,
        (_LOAD, 0, 0, _NUMBER_AT),
        (_JUMP_GREATER, 0, 1, _X32),
        refuse,
    ]
    for number in processor.refused:
        lines += [(_JUMP_EQUAL, 0, 1, number), refuse]
    # The C library starts threads by clone3, whose flags a filter cannot read. If there is no
    # clone3, it takes clone.
    lines += [
        (_JUMP_EQUAL, 0, 1, processor.clone3),
        (_RETURN, 0, 0, _REFUSE | errno.ENOSYS),
        (_JUMP_EQUAL, 0, 3, processor.clone),
        (_LOAD, 0, 0, _FIRST_ARGUMENT_AT),
        (_JUMP_ANY_BIT, 1, 0, _THREAD),
        refuse,
        allow,
    ]
    return b"".join(struct.pack("<HBBI", *line) for line in lines)
