"""The package needs only httpx2, also as a wheel without the server."""

from __future__ import annotations

import subprocess
import sys

WITHOUT_SERVER = """
import sys
class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {"app", "numpy", "pandas", "fastapi", "pydantic", "sqlalchemy"}:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, Blocked())
import httpx2, kinedex
octets = httpx2.Response(200, content=b"", headers={"X-Shape": "0,1,3", "X-Frame-Rate": "30"})
client = kinedex.Kinedex("http://service", transport=httpx2.MockTransport(lambda _: octets))
try:
    client.clips.motion_array("x")
except kinedex.PackageNeeded as needed:
    print(needed)
"""


def test_it_is_imported_without_the_server_and_without_numpy() -> None:
    command = [sys.executable, "-c", WITHOUT_SERVER]
    ended = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    assert ended.stdout == "An array needs numpy: pip install numpy\n"
