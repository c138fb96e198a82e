"""Imports without the garbage collector leave it as it was."""

from __future__ import annotations

import gc
from importlib import import_module

import pytest

from app.quick_imports import without_collector


def test_the_collector_is_off_in_the_block_and_on_again_after_it() -> None:
    assert gc.isenabled()
    with without_collector():
        assert not gc.isenabled()
    assert gc.isenabled()


def test_it_is_on_again_after_a_failed_import() -> None:
    with pytest.raises(ModuleNotFoundError), without_collector():
        import_module("nosuch")
    assert gc.isenabled()


def test_a_collector_that_was_off_stays_off() -> None:
    with without_collector():
        with without_collector():
            pass
        assert not gc.isenabled()
    assert gc.isenabled()
