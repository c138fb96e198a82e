"""Clients that others generate from the OpenAPI description: they compile, and they work."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from app.api.app import create_app
from app.config import Settings
from app.demo import DemoClip
from tests.live import Live

TOOLS = Path(__file__).resolve().parents[2] / "app" / "web" / "node_modules" / ".bin"
"""Where `make install` puts the tools of the web pages."""
PIP = [str(Path(sys.base_prefix) / "bin" / "python3"), "-m", "pip"]
UNSUPPORTED = "image/svg+xml"
"""openapi-python-client leaves out answers of this media type, and says so."""

PROGRAM = """
import importlib, pkgutil, sys
import generated
from generated import Client
from generated.api.clips import create_clip, get_clip, get_motion, list_clips
from generated.api.jobs import list_jobs
from generated.api.search import search_motion, search_pose, search_words
from generated.models import CreateClipClipForm, MotionSearch, PoseSearch, WordSearch
from generated.types import File

for module in pkgutil.walk_packages(generated.__path__, "generated."):
    importlib.import_module(module.name)

url, path = sys.argv[1:]
client = Client(url, httpx_args={"trust_env": False})
page = list_clips.sync(client=client, limit=2, task="walk")
assert page.total == 4 and len(page.items) == 2, page
walk = get_clip.sync(page.items[0].id, client=client)
assert walk.task == "walk" and walk.created_at.tzinfo is not None
like_it = search_motion.sync(client=client, body=MotionSearch(clip_id=walk.id, limit=2))
assert like_it.items[0].clip.task == "walk"
assert search_words.sync(client=client, body=WordSearch(words=["kick"])).items
assert search_pose.sync(client=client, body=PoseSearch(clip_id=walk.id, time=0.5)).items
motion = get_motion.sync(walk.id, client=client, fps=5.0)
assert len(motion.positions[0]) == len(motion.joint_names)
assert list_jobs.sync(client=client).total > 0
missing = get_clip.sync("nope", client=client)
assert missing.code == "clip_not_found" and missing.status == 404
with open(path, "rb") as file:
    form = CreateClipClipForm(file=File(payload=file, file_name="walk.bvh"), person="zoe")
    again = create_clip.sync(client=client, body=form, idempotency_key="generated")
assert again.clip.person == "zoe", again
print("ok")
"""


@pytest.fixture
def description(tmp_path: Path) -> Path:
    path = tmp_path / "openapi.json"
    path.write_text(json.dumps(create_app(Settings(data_dir=tmp_path)).openapi()))
    return path


def test_openapi_typescript_makes_types_that_compile(description: Path, tmp_path: Path) -> None:
    if not (TOOLS / "openapi-typescript").exists():
        pytest.skip("THE WEB TOOLS ARE NOT INSTALLED: run `make install`")
    types = tmp_path / "schema.d.ts"
    make = [TOOLS / "openapi-typescript", description, "--output", types]
    subprocess.run(make, check=True, capture_output=True, timeout=300)
    check = [TOOLS / "tsc", "--noEmit", "--strict", types]
    found = subprocess.run(check, capture_output=True, text=True, timeout=300, check=False)
    assert found.returncode == 0, found.stdout
    assert "list_clips" in types.read_text()


@pytest.mark.slow
def test_openapi_python_client_makes_a_client_that_works(
    description: Path, tmp_path: Path, demo_service: Live, take: DemoClip
) -> None:
    """Its tool needs an older Typer than ours, so it gets a virtual environment of its own."""
    python = _environment(tmp_path / "venv", "openapi-python-client")
    make = [python.parent / "openapi-python-client", "generate", "--path", description]
    options = ["--output-path", tmp_path / "generated", "--meta", "none"]
    made = subprocess.run([*make, *options], capture_output=True, text=True, check=True)
    left_out = [line for line in made.stderr.splitlines() if line.startswith("Cannot parse")]
    assert all(UNSUPPORTED in line for line in left_out)
    clip = tmp_path / "walk.bvh"
    clip.write_bytes(take.content)
    run = [python, "-c", PROGRAM, demo_service.url, clip]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    with demo_service.client() as client:  # other tests count on what was there before
        for stored in client.get("/v1/clips", params={"person": "zoe"}).json()["items"]:
            client.delete(f"/v1/clips/{stored['id']}")
    assert done.stdout == "ok\n", done.stderr


def _environment(folder: Path, package: str) -> Path:
    """A virtual environment with a package; its Python."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    python = folder / "bin" / "python"
    install = [*PIP, "--python", python, "install", "--quiet", package, "python-dateutil"]
    installed = subprocess.run(install, capture_output=True, text=True, check=False)
    if installed.returncode:
        pytest.skip(f"{package.upper()} CANNOT BE INSTALLED: {installed.stderr[-300:]}")
    return python
