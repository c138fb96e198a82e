"""One library for all tests of the command line. The commands create it."""

from __future__ import annotations

import csv
import json
import os
import sqlite3
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from app.cli.main import main
from app.demo import DemoClip, demo_clips

ACTORS, TASKS = ("ada", "bruno"), ("walk", "kick", "wave")
COLUMNS = ("path", "person", "task", "words")
BAD = "broken/half.bvh"
ABSENT = "absent.bvh"


@dataclass(frozen=True)
class Ended:
    """The exit code and the output of a command."""

    code: int
    out: str
    err: str

    def json(self) -> Any:
        assert self.code == 0, self.err
        return json.loads(self.out)


Kinedex = Callable[..., Ended]


def start(*words: str, **settings: object) -> subprocess.Popen[str]:
    """Start the installed program as a user does."""
    program = Path(sys.executable).with_name("kinedex")
    return subprocess.Popen(
        [str(program), *words],
        env=environment(**settings),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def environment(**settings: object) -> dict[str, str]:
    """The environment of the tests with only these KINEDEX_* settings."""
    clean = {name: value for name, value in os.environ.items() if not name.startswith("KINEDEX_")}
    return clean | {f"KINEDEX_{name.upper()}": str(value) for name, value in settings.items()}


def end(process: subprocess.Popen[str], seconds: float = 400.0) -> Ended:
    """Wait for the end of a program."""
    try:
        out, err = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        raise
    return Ended(process.returncode, out, err)


@pytest.fixture(scope="session")
def clips() -> list[DemoClip]:
    return list(demo_clips(ACTORS, TASKS, takes=2))


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory, clips: list[DemoClip]) -> Path:
    """A folder with a manifest of twelve clips, one damaged file and one missing file."""
    root = tmp_path_factory.mktemp("mocap")
    rows = [(c.path, c.person, c.task, " ".join(c.words)) for c in clips]
    for clip in clips:
        (root / clip.path).parent.mkdir(exist_ok=True)
        (root / clip.path).write_bytes(clip.content)
    (root / BAD).parent.mkdir()
    (root / BAD).write_bytes(clips[0].content[: len(clips[0].content) // 2])
    rows += [(BAD, "ada", "walk", ""), (ABSENT, "ada", "walk", "")]
    with (root / "manifest.csv").open("w", newline="") as file:
        csv.writer(file).writerows([COLUMNS, *rows])
    return root


@pytest.fixture(scope="session")
def data_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cli") / "data"


@pytest.fixture(scope="session")
def imported(data_dir: Path, folder: Path) -> Ended:
    """The output of the first import of the folder, which also fits the models."""
    return end(start("import", str(folder), data_dir=data_dir))


@pytest.fixture
def program(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Kinedex:
    """The command line in this process, with only these settings. It needs no start of Python."""

    def run(*words: str, **settings: object) -> Ended:
        with monkeypatch.context() as patched:
            for name in [name for name in os.environ if name.startswith("KINEDEX_")]:
                patched.delenv(name)
            for name, value in settings.items():
                patched.setenv(f"KINEDEX_{name.upper()}", str(value))
            patched.setattr(sys, "argv", ["kinedex", *words])
            with pytest.raises(SystemExit) as ended:
                main()
        printed = capsys.readouterr()
        return Ended(int(ended.value.code or 0), printed.out, printed.err)

    return run


@pytest.fixture
def kinedex(imported: Ended, data_dir: Path, program: Kinedex) -> Iterator[Kinedex]:
    """The command line on the imported library, which a test must leave with the same clips."""
    assert imported.code == 1, imported.err  # one file is damaged
    before = _clip_ids(data_dir)
    yield lambda *words, **settings: program(*words, **{"data_dir": data_dir} | settings)
    assert _clip_ids(data_dir) == before, "the test changed the clips that all tests share"


@pytest.fixture
def kinedex_alone(tmp_path_factory: pytest.TempPathFactory, program: Kinedex) -> Kinedex:
    """The command line on a library of this test alone, which is empty at first."""
    own = tmp_path_factory.mktemp("alone") / "data"
    return lambda *words, **settings: program(*words, **{"data_dir": own} | settings)


def _clip_ids(data_dir: Path) -> list[str]:
    with closing(sqlite3.connect(data_dir / "kinedex.sqlite3")) as database:
        return [clip_id for (clip_id,) in database.execute("SELECT id FROM clips ORDER BY id")]
