"""A program that writes to standard error in all possible ways, for `test_logs`."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import threading
import warnings

import numpy as np

from app.json_stderr import json_stderr
from app.kinedex_error import KinedexError
from app.services.library.analysis_pool import AnalysisPool, AnalysisRequest, Limits

KEY = "kx_0123456789ab_" + "s" * 43


def in_a_child(request: AnalysisRequest, limits: Limits) -> None:
    np.array([1e30], dtype=np.float32) * np.float32(1e30)
    os.write(2, b"a child, past Python\n")
    ctypes.CDLL(None).abort()


def in_this_process() -> None:
    os.write(2, f"past Python\n{KEY}\n".encode())
    libc = ctypes.CDLL(None)
    libc.perror(b"of libc")
    np.array([1e300]) * 1e300
    warnings.warn("a warning of ours", UserWarning, stacklevel=1)
    print("printed", file=sys.stderr)
    program = [sys.executable, "-c", "raise RuntimeError('another program')"]
    subprocess.run(program, check=False)
    thread = threading.Thread(target=lambda: 1 / 0)
    thread.start()
    thread.join()


def main() -> None:
    with json_stderr():
        in_this_process()
        pool = AnalysisPool(Limits(60, 2048, 100, 100))
        try:
            pool.outcome(pool._begin(in_a_child, AnalysisRequest()))
        except KinedexError as death:
            print(type(death).__name__, file=sys.stderr)
        finally:
            pool.close()
        raise LookupError("the last one")
