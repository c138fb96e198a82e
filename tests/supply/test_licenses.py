"""Everything that runs may be distributed with Apache-2.0 software."""

from __future__ import annotations

from email.message import Message

import pytest

from tests.supply.licenses import Licensed, license_of, page_packages, python_packages


def test_every_package_that_runs_is_permissive() -> None:
    packages = [*python_packages(), *page_packages()]
    assert {"numpy", "fastapi", "three", "svelte"} <= {one.name for one in packages}
    assert [one for one in packages if not one.is_permissive] == []


@pytest.mark.parametrize(
    ("license", "fits"),
    [
        ("MIT", True),
        ("Apache-2.0 OR BSD-2-Clause", True),
        ("(MIT AND GPL-3.0-only)", False),
        ("GPL-3.0-only", False),
        ("", False),
    ],
)
def test_a_license_fits_if_all_its_parts_do(license: str, fits: bool) -> None:
    assert Licensed("a", "1", license).is_permissive is fits


@pytest.mark.parametrize(
    ("member", "value", "found"),
    [
        ("License-Expression", "ISC", "ISC"),
        ("Classifier", "License :: OSI Approved :: BSD License", "BSD"),
        ("License", "BSD 3-Clause License\nCopyright", "BSD-3-Clause"),
        ("License", "GNU General Public License v3", ""),
        ("Classifier", "Topic :: MIT", ""),
    ],
)
def test_old_metadata_is_understood(member: str, value: str, found: str) -> None:
    described = Message()
    described[member] = value.replace("\n", " ")
    assert license_of(described) == found
