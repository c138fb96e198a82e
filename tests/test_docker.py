"""The container files, without a container engine: the names in them exist in the code.

These tests cannot show that the image builds and runs.
"""

from __future__ import annotations

import json
import re
import shlex
import tomllib
from dataclasses import dataclass
from ipaddress import ip_address, ip_network
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
import yaml

from app.config import ENV_PREFIX, LOOPBACK_HOSTS, Settings, load_settings
from tests.commands import code_lines, refusal
from tests.live import Live

ROOT = Path(__file__).resolve().parents[1]
DOCKERFILE = ROOT / "docker" / "Dockerfile"
COMPOSE: dict[str, Any] = yaml.safe_load((ROOT / "docker" / "compose.yaml").read_text())
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
TLS: dict[str, Any] = yaml.safe_load((ROOT / "docker" / "compose.tls.yaml").read_text())
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
TOOLS = {"cli"}
"""Services that run one command and end."""
_VARIABLE = re.compile(r"\$\{(\w+):-([^}]*)\}")
NOBODY_ROOT = {"root", "0", "0:0", "root:root", ""}


@dataclass(frozen=True)
class Step:
    """One instruction of a Dockerfile: its keyword, and the rest of its line."""

    word: str
    rest: str

    def listed(self) -> list[str]:
        """The words of an instruction in exec form."""
        found: list[str] = json.loads(self.rest)
        return found


def _stages() -> list[list[Step]]:
    text = re.sub(r"\\\n", " ", DOCKERFILE.read_text())
    steps = [Step(*line.split(None, 1)) for line in text.splitlines() if line and line[0] != "#"]
    stages: list[list[Step]] = []
    for step in steps:
        if step.word == "FROM":
            stages.append([])
        if stages:  # before the first stage, only the base image is named
            stages[-1].append(step)
    return stages


BUILD, FINAL = _stages()


def _only(stage: list[Step], word: str) -> Step:
    (found,) = [step for step in stage if step.word == word]
    return found


def _environment() -> dict[str, str]:
    return dict(part.split("=", 1) for part in shlex.split(_only(FINAL, "ENV").rest))


def _check_command() -> list[str]:
    health = _only(FINAL, "HEALTHCHECK").rest
    found: list[str] = json.loads(health.partition("CMD")[2])
    return found


def _check_url() -> Any:
    (url,) = re.findall(r"https?://[^'\"]+", " ".join(_check_command()))
    return urlsplit(url)


def _is_ignored(path: str) -> bool:
    """Whether .dockerignore excludes a path: its last line that matches the path decides."""
    ignored = False
    for line in (ROOT / ".dockerignore").read_text().split():
        pattern = re.escape(line.lstrip("!")).replace(r"\*\*/", "(?:.*/)?")
        pattern = pattern.replace(r"\*\*", ".*").replace(r"\*", "[^/]*")
        if re.fullmatch(f"{pattern}(?:/.*)?", path):
            ignored = not line.startswith("!")
    return ignored


def test_what_is_copied_exists_and_reaches_the_build() -> None:
    for step in BUILD:
        if step.word == "COPY":
            for source in step.rest.split()[:-1]:
                path = ROOT / source
                assert path.exists(), source
                files = [path] if path.is_file() else list(path.rglob("*.py"))
                ignored = [f for f in files if _is_ignored(f.relative_to(ROOT).as_posix())]
                assert files
                assert not ignored


def test_what_the_wheel_needs_is_copied() -> None:
    copied = {s for step in BUILD if step.word == "COPY" for s in step.rest.split()[:-1]}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert {"pyproject.toml", project["project"]["readme"], "LICENSE"} <= copied
    data = project["tool"]["setuptools"]["data-files"]
    packaged = {file.split("/")[0] for files in data.values() for file in files}
    found = project["tool"]["setuptools"]["packages"]["find"]
    assert found["where"] == [".", "app/client"]  # `kinedex` lies in a folder of `app`
    assert packaged | {"app"} <= copied


@pytest.mark.parametrize(
    "path", [".git/config", ".venv/bin/python", "data/kinedex.sqlite3", "tests/live.py", ".env"]
)
def test_nothing_else_reaches_the_build(path: str) -> None:
    assert _is_ignored(path)
    assert not _is_ignored("app/cli/main.py")
    assert _is_ignored("app/cli/__pycache__/main.cpython-311.pyc")


def test_what_is_built_is_what_runs() -> None:
    home = _only(FINAL, "COPY").rest.split()[-1]
    assert any(f"{home}/bin/pip install" in step.rest for step in BUILD if step.word == "RUN")
    assert _environment()["PATH"].startswith(f"{home}/bin:")
    scripts = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
    (entry,) = _only(FINAL, "ENTRYPOINT").listed()
    assert entry in scripts


def test_it_does_not_run_as_root() -> None:
    words = [step.word for step in FINAL]
    user = _only(FINAL, "USER").rest
    assert user not in NOBODY_ROOT
    assert words.index("USER") < words.index("ENTRYPOINT")
    made = " ".join(step.rest for step in FINAL if step.word == "RUN")
    assert re.search(rf"useradd\b.*--uid (\d+).*\b{user}\b", made)
    data = _environment()["KINEDEX_DATA_DIR"]
    assert f"-o {user}" in made
    assert data in json.loads(_only(FINAL, "VOLUME").rest)


def test_the_commands_exist() -> None:
    assert refusal(_only(FINAL, "CMD").listed()) is None
    for name, service in SERVICES.items():
        assert refusal(service["command"]) is None, name
    assert SERVICES["api"]["command"] == ["serve", "--no-worker"]
    assert SERVICES["worker"]["command"] == ["worker"]
    for words in _commands_in_containers():
        assert refusal(words) is None, words


def _commands_in_containers() -> list[list[str]]:
    """The words after `cli` or `api` of every `docker compose run` in the documentation."""
    found = []
    for name in ("README.md", "docker/README.md"):
        for line in code_lines((ROOT / name).read_text()):
            if line.startswith("docker compose ") and " run --rm " in line:
                words = shlex.split(line)
                if "--entrypoint" not in words:
                    found.append(words[words.index("--rm") + 2 :])
    assert len(found) > 4
    return found


def test_every_setting_exists_and_its_value_is_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    given = [_environment(), *(service.get("environment", {}) for service in SERVICES.values())]
    for environment in given:
        ours = {name: value for name, value in environment.items() if name.startswith(ENV_PREFIX)}
        fields = {name.removeprefix(ENV_PREFIX).lower() for name in ours}
        assert fields <= Settings.model_fields.keys()
        with monkeypatch.context() as patched:
            for name, value in ours.items():
                patched.setenv(name, value)
            load_settings()


def test_ports_agree() -> None:
    environment = _environment()
    port = environment["KINEDEX_PORT"]
    assert environment["KINEDEX_HOST"] not in LOOPBACK_HOSTS
    assert _only(FINAL, "EXPOSE").rest == port
    assert str(_check_url().port) == port
    api = SERVICES["api"]
    assert api["environment"]["KINEDEX_PORT"] == port
    (published,) = api["ports"]
    assert published.split(":")[-1] == port
    assert published.startswith("127.0.0.1:"), "published beyond this machine by default"
    assert "ports" not in SERVICES["worker"]


def test_the_health_check_asks_a_call_that_exists(idle_service: Live) -> None:
    with idle_service.client() as client:
        described = client.get("/openapi.json").json()["paths"]
        assert "get" in described[_check_url().path]
        assert client.get(_check_url().path).status_code == 200
    assert _check_command()[0] == "python"
    compile(_check_command()[2], "health check", "exec")


def test_services_share_the_data_and_build_one_image() -> None:
    image = {service["image"] for service in SERVICES.values()}
    assert len(image) == 1
    build = SERVICES["api"]["build"]
    context = (ROOT / "docker" / build["context"]).resolve()
    assert context == ROOT
    assert (context / build["dockerfile"]).resolve() == DOCKERFILE
    shared = []
    for service in SERVICES.values():
        mounts = _mounts(service)
        named = {source for source in mounts.values() if not source.startswith("./")}
        assert named <= COMPOSE["volumes"].keys()
        shared.append(mounts[service["environment"]["KINEDEX_DATA_DIR"]])
    assert len(set(shared)) == 1


def _mounts(service: dict[str, Any]) -> dict[str, str]:
    """The source of each mount by its path in the container, with the defaults of variables."""
    filled = [_VARIABLE.sub(r"\2", mount) for mount in service["volumes"]]
    return {mount.split(":")[1]: mount.split(":")[0] for mount in filled}


def test_only_commands_see_the_folders_of_the_machine() -> None:
    mounts = _mounts(SERVICES["cli"])
    assert (mounts["/import"], mounts["/backups"]) == ("./import", "./backups")
    assert any(mount.endswith(":/import:ro") for mount in SERVICES["cli"]["volumes"])
    for name in SERVICES.keys() - TOOLS:
        assert set(_mounts(SERVICES[name])) == {"/data", "/tmp"}
    assert SERVICES["cli"]["profiles"] == ["tools"]
    for path in ("docker/import/a.bvh", "docker/backups/monday"):
        assert _is_ignored(path)


def test_the_worker_waits_for_the_api_and_has_its_own_check() -> None:
    worker = SERVICES["worker"]
    assert worker["depends_on"]["api"]["condition"] == "service_healthy"
    kind, program, *words = worker["healthcheck"]["test"]
    assert (kind, program) == ("CMD", "kinedex")
    assert refusal(words) is None
    assert words == ["worker", "--check"]
    assert "healthcheck" not in SERVICES["api"], "the image's own check applies"


def test_the_image_has_labels_and_the_version_of_the_package() -> None:
    labels = {
        name.removeprefix("org.opencontainers.image."): value
        for name, value in (part.split("=", 1) for part in shlex.split(_only(FINAL, "LABEL").rest))
    }
    assert labels["licenses"] == PROJECT["license"]
    assert {"title", "description", "version", "revision"} <= labels.keys()
    arguments = dict(step.rest.split("=") for step in FINAL if step.word == "ARG")
    assert arguments["VERSION"] == PROJECT["version"]
    given = SERVICES["api"]["build"]["args"]
    assert set(given) == {"PYTHON_IMAGE", *arguments}
    assert SERVICES["api"]["image"] == f"kinedex:${{TAG:-{PROJECT['version']}}}"


def test_the_memory_and_the_logs_of_services_are_limited() -> None:
    for service in [*SERVICES.values(), TLS["services"]["caddy"]]:
        size = _VARIABLE.sub(r"\2", service["mem_limit"])
        assert re.fullmatch(r"\d+[mg]", size)
        assert set(service["logging"]["options"]) == {"max-size", "max-file"}


def test_variables_are_no_settings_and_are_documented() -> None:
    """Kinedex refuses to run with unknown settings, so variables need other names."""
    documented = (ROOT / "docker" / "README.md").read_text()
    for name in ("compose.yaml", "compose.tls.yaml"):
        for variable in re.findall(r"\$\{(\w+)", (ROOT / "docker" / name).read_text()):
            assert not variable.startswith(ENV_PREFIX)
            assert f"`{variable}`" in documented


def test_caddy_sends_requests_to_the_port_of_the_api() -> None:
    caddy = TLS["services"]["caddy"]
    text = (ROOT / "docker" / "Caddyfile").read_text()
    assert re.findall(r"reverse_proxy (\S+)", text) == [f"api:{_environment()['KINEDEX_PORT']}"]
    assert set(re.findall(r"\{\$(\w+)\}", text)) == caddy["environment"].keys()
    assert text.count("{") == text.count("}")
    assert "./Caddyfile:/etc/caddy/Caddyfile:ro" in caddy["volumes"]
    assert {"80:80", "443:443"} <= set(caddy["ports"])
    assert caddy["depends_on"].keys() <= SERVICES.keys()
    assert _mounts(caddy)["/data"] in TLS["volumes"]


def test_the_api_believes_only_caddy(monkeypatch: pytest.MonkeyPatch) -> None:
    (pool,) = TLS["networks"]["default"]["ipam"]["config"]
    caddy = ip_address(TLS["services"]["caddy"]["networks"]["default"]["ipv4_address"])
    assert caddy in ip_network(pool["subnet"])
    assert caddy not in ip_network(pool["ip_range"]), "another container may take the address"
    for name, value in TLS["services"]["api"]["environment"].items():
        monkeypatch.setenv(name, value)
    settings = load_settings()
    assert settings.trusted_proxies == (str(caddy),)
    assert settings.max_connections_per_address == settings.max_connections


def test_keys_of_services_are_those_of_the_compose_specification() -> None:
    known = {
        *("build", "cap_add", "cap_drop", "command", "depends_on", "environment", "healthcheck"),
        *("image", "logging", "mem_limit", "ports", "profiles", "read_only", "restart"),
        *("security_opt", "volumes", "networks"),
    }
    top = {"name", "services", "volumes", "networks"}
    for file in (COMPOSE, TLS):
        assert {key for key in file if not key.startswith("x-")} <= top
        for name, service in file["services"].items():
            assert service.keys() <= known, name


def test_services_have_no_more_rights_than_they_need() -> None:
    for name, service in SERVICES.items():
        assert service["read_only"] is True
        assert service["cap_drop"] == ["ALL"]
        assert "no-new-privileges:true" in service["security_opt"]
        assert "privileged" not in service
        assert service["restart"] == ("no" if name in TOOLS else "unless-stopped")
        # A read-only root needs a place for temporary files.
        assert any(mount.endswith(":/tmp") for mount in service["volumes"])


def test_the_files_and_the_readme_show_the_same_commands() -> None:
    readme = (ROOT / "README.md").read_text()
    commands = re.findall(
        r"^#\s+(docker compose .+)$", (ROOT / "docker" / "compose.yaml").read_text(), re.M
    )
    assert commands
    assert [line for line in commands if line not in readme] == []
    for line in commands:
        words = line.split()
        if "run" in words:
            after = words[words.index("--rm") + 1 :]
            assert after[0] in SERVICES
            assert refusal(after[1:]) is None
