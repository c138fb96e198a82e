"""What `kinedex import` prints at its end, and its exit code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from itertools import chain, islice
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import typer

from app.cli.output import print_table, print_text

if TYPE_CHECKING:
    from app.services.library.library import Library
    from app.store.jobs.record import JobRecord
    from kinedex import Kinedex
    from kinedex.types.jobs import Job

FAILED, NOTHING = 1, 2
"""Exit codes: some files failed; no file could be imported."""
MAX_LISTED = 20
"""Rows of a table; --json lists all files."""
MAX_VALUE = 60
"""Characters of a value in a table."""
Files = Callable[[str | None], Iterable[Any]]
"""Gives the recorded files of an import with an outcome, or all files with None.

A file has `path`, and as in the API `error`, `differences` and `warnings`.
"""
COUNTS = ("new", "updated", "unchanged", "conflicting", "failed", "skipped", "absent")


def exit_code(job: JobRecord | Job) -> int:
    """The exit code of an import; 0 while a worker still has to analyze its clips."""
    result = job.result
    if result is None:
        return 0 if job.state in ("queued", "processing") else FAILED
    if result["failed"]:
        return FAILED
    present = sum(result[name] for name in ("new", "updated", "unchanged", "conflicting"))
    return 0 if present else NOTHING


def local_files(lib: Library, job_id: str) -> Files:
    """The files of an import into the library of this machine."""
    from app.api.schemas.jobs import JobFile
    from app.services.clips import jobs
    from app.store.jobs.import_files import FileOutcome

    def files(outcome: str | None) -> Iterable[Any]:
        for file in jobs.all_files(lib, job_id, None if outcome is None else FileOutcome(outcome)):
            yield SimpleNamespace(**JobFile.model_validate(file).model_dump(mode="json"))

    return files


def remote_files(client: Kinedex, job_id: str) -> Files:
    """The files of an import into a service elsewhere."""

    def files(outcome: Any) -> Iterable[Any]:
        for file in client.jobs.files(job_id, outcome=outcome):
            yield SimpleNamespace(**file.to_json())

    return files


def local_document(lib: Library, job: JobRecord) -> dict[str, Any]:
    """The job as in the API, but its result lists all recorded files."""
    from app.api.schemas.jobs import Job

    return document(Job.model_validate(job).model_dump(mode="json"), local_files(lib, job.id))


def document(shown: dict[str, Any], recorded: Files) -> dict[str, Any]:
    """A job as in the API, but its result lists all recorded files."""
    if shown["result"] is not None:
        files = [vars(file) for file in recorded(None)]
        left_out = max(shown["result"]["total"] - len(files), 0)
        shown["result"] |= {"files": files, "files_left_out": left_out}
    return shown


def show(job: JobRecord | Job, files: Files) -> None:
    """Print the numbers of files by result, what failed or differs, and the warnings."""
    result = job.result
    if result is not None:
        counts = ", ".join(f"{result[name]} {name}" for name in COUNTS if _is_shown(name, result))
        noun = "file" if result["total"] == 1 else "files"
        typer.echo(f"{result['total']} {noun}: {counts}.")
        _show_failures(files, result)
        _show_differences(files, result)
        _show_skipped(files, result)
        _show_remarks(files, result)
    if job.error:
        error: Any = job.error
        detail = error["detail"] if isinstance(error, dict) else error.detail
        typer.echo(f"kinedex: {detail}", err=True)


def _is_shown(name: str, result: dict[str, Any]) -> bool:
    return bool(result[name]) or name in ("new", "updated", "unchanged")


def _show_failures(files: Files, result: dict[str, Any]) -> None:
    from app.services.imports.plan import MAX_ABSENT_LISTED

    failed = chain(files("failed"), files("absent"))
    rows = ((file.path, _reason(file.error)) for file in failed if file.error is not None)
    listed = result["failed"] + min(result["absent"], MAX_ABSENT_LISTED)
    _print_some(("failed", "reason"), rows, listed)
    absent = result["absent"]
    if absent > MAX_ABSENT_LISTED:
        typer.echo(f"A manifest names {absent - MAX_ABSENT_LISTED} more files that do not exist.")


def _show_differences(files: Files, result: dict[str, Any]) -> None:
    for outcome, columns, advice in (
        ("updated", ("updated", "field", "before", "now"), ""),
        (
            "conflicting",
            ("conflicting", "field", "in the library", "in the import"),
            "Somebody edited these labels since, or two files with the same content say different"
            " things. The library kept its values; --overwrite replaces edited ones.",
        ),
    ):
        rows = (
            (file.path, one["field"], _value(one["stored"]), _value(one["sent"]))
            for file in files(outcome)
            for one in file.differences
            if outcome == "updated" or not one["applied"]
        )
        count = result[outcome]
        _print_some(columns, rows, count)
        if count and advice:
            print_text(advice)


def _show_skipped(files: Files, result: dict[str, Any]) -> None:
    if result["skipped"]:
        names = [_skipped_name(file) for file in islice(files("skipped"), MAX_LISTED)]
        more = "" if len(names) == result["skipped"] else ", ..."
        print_text(f"Skipped, because they are no motions: {', '.join(names)}{more}")


def _skipped_name(file: Any) -> str:
    from app.services.imports.folders import LEFT_OUT

    is_library = file.error is not None and file.error["detail"] == LEFT_OUT
    return f"{file.path}/ (a library of Kinedex)" if is_library else str(file.path)


def _show_remarks(files: Files, result: dict[str, Any]) -> None:
    if result["unmatched"]:
        print_text(f"The pattern --labels does not match {result['unmatched']} files.")
    warnings: dict[str, int] = result["warnings"]
    if not warnings:
        return
    examples = _examples(files, warnings)
    rows = [(code, count, examples.get(code)) for code, count in warnings.items()]
    print_table(("warning", "clips", "for example"), rows)


def _examples(files: Files, codes: Iterable[str]) -> dict[str, str]:
    """The first file with each warning, and what the warning says about it."""
    missing, found = set(codes), {}
    for file in files(None):
        for warning in file.warnings:
            if warning["code"] in missing:
                missing.remove(warning["code"])
                found[warning["code"]] = f"{file.path}: {warning['detail']}"
        if not missing:
            break
    return found


def _print_some(columns: Sequence[str], rows: Iterable[Sequence[object]], files: int) -> None:
    """Print the first rows; files: the number of files that all rows are about."""
    some = list(islice(rows, MAX_LISTED + 1))
    if some:
        print_table(columns, some[:MAX_LISTED])
    if len(some) > MAX_LISTED:
        shown = Counter(row[0] for row in some[:MAX_LISTED])
        typer.echo(f"... and {max(files - len(shown), 1)} more; --json lists all.")


def _value(value: Any) -> str | None:
    if value is None:
        return None
    text = " ".join(map(str, value)) if isinstance(value, list) else str(value)
    return text if len(text) <= MAX_VALUE else f"{text[: MAX_VALUE - 1]}…"


def _reason(problem: dict[str, Any]) -> str:
    places = [f"{place['location']}: {place['message']}" for place in problem["errors"]]
    # the detail of a file reader is often the same text as its only place
    return " ".join([problem["detail"], *(place for place in places if place != problem["detail"])])
