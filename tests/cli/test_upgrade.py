"""The commands of the README's section "Upgrade", on a library of an earlier version."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Kinedex
from tests.commands import commands_in
from tests.old_libraries import downgrade, make_library

README = (Path(__file__).resolve().parents[2] / "README.md").read_text()
COMMANDS = commands_in(README.partition("<!-- upgrade -->")[2].partition("<!-- /upgrade -->")[0])


@pytest.mark.parametrize("revision", ["0003", "0008"])
def test_an_upgrade_as_the_readme_says(kinedex: Kinedex, tmp_path: Path, revision: str) -> None:
    data_dir, copy = tmp_path / "data", tmp_path / "backups" / "before-upgrade"
    made = make_library(data_dir)
    downgrade(data_dir, revision)
    too_old = kinedex("verify", data_dir=data_dir)
    assert (too_old.code, "`kinedex backup`" in too_old.err) == (1, True)
    assert [words[0] for words in COMMANDS] == ["backup", "db", "verify", "serve"]
    for words in COMMANDS[:-1]:
        given = [str(copy) if "~" in word else word for word in words]
        ended = kinedex(*given, data_dir=data_dir)
        assert ended.code == 0, ended.err
    # The copy still has the earlier schema, and all files.
    again = kinedex("verify", data_dir=copy)
    assert (again.code, revision in again.err) == (1, True)
    assert kinedex("db", "upgrade", data_dir=copy).code == 0
    checked = kinedex("verify", "--json", data_dir=copy).json()
    assert (checked["is_whole"], checked["files"]) == (True, len(made) + 1)
