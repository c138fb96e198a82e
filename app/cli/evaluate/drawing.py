"""The picture files of an evaluation.

Their paths are checked before the evaluation, because that may take minutes.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from app.cli.files import write_whole
from app.errors import BadField
from app.evaluate import charts as pictures
from app.evaluate.charts import Format
from app.services import fields


@dataclass(frozen=True, slots=True)
class Drawing:
    """The paths of the pictures.

    file: path of one picture; its suffix is the format. folder: path for several pictures, in
    `folder_format`. None: these pictures are not drawn.
    """

    file: Path | None
    folder: Path | None
    folder_format: Format

    @classmethod
    def prepared(
        cls, file: Path | None = None, folder: Path | None = None, picture_format: str = "svg"
    ) -> Drawing:
        """Check the paths of the options. No file or folder remains.

        Raises BadField for an unknown format or an unwritable path, and ExtraNeeded without
        matplotlib.
        """
        folder_format = pictures.format_of(Path(f"picture.{picture_format}"))
        if file is not None:
            pictures.format_of(file)
            check_file("picture", file)
        if folder is not None:
            _check_folder("pictures", folder)
        if file is not None or folder is not None:
            pictures.need_plots()
        return cls(file, folder, folder_format)

    def draw_one(self, draw: Callable[[Format], bytes]) -> None:
        """Draw the picture into the file; does nothing without a file."""
        if self.file is not None:
            self.file.parent.mkdir(parents=True, exist_ok=True)
            write_whole(self.file, [draw(pictures.format_of(self.file))])

    def draw_all(self, draw: Callable[[Format], Iterable[tuple[str, bytes]]]) -> None:
        """Draw pictures, by file name, into the folder; does nothing without a folder."""
        if self.folder is not None:
            self.folder.mkdir(parents=True, exist_ok=True)
            for name, content in draw(self.folder_format):
                write_whole(self.folder / name, [content])


def check_file(option: str, file: Path) -> None:
    """Check that the file of an option can be written. Raises BadField."""
    _check_folder(option, file.parent)
    try:
        is_folder = file.is_dir()
    except OSError as problem:  # a name that is too long
        raise _unwritable(option, file, problem) from None
    if is_folder:
        raise fields.bad_field(option, f"{file} is a folder, not a file")


def _check_folder(option: str, folder: Path) -> None:
    """Check that files can be created in the folder.

    A file is created for this: permissions alone say nothing about virtual folders and about
    privileged users.
    """
    try:
        created = [path for path in (folder, *folder.parents) if not path.exists()]
    except OSError as problem:
        raise _unwritable(option, folder, problem) from None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as problem:
        raise _unwritable(option, folder, problem) from None
    finally:
        for path in created:
            with suppress(OSError):
                path.rmdir()


def _unwritable(option: str, folder: Path, problem: OSError) -> BadField:
    reasons = {
        FileExistsError: "there is a file of that name",
        NotADirectoryError: "a part of that path is a file",
        FileNotFoundError: "no folder can be made there",
        PermissionError: "that is not permitted",
    }
    why = reasons.get(type(problem), problem.strerror)
    return fields.bad_field(option, f"nothing can be written to {folder}: {why}")
