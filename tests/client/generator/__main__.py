"""Writes the generated files of the Python client into the checkout."""

from tests.client.generator.files import CLIENT, generated

for name, code in generated().items():
    (CLIENT / name).write_text(code)
for path in [*CLIENT.glob("calls/[!_]*.py"), *CLIENT.glob("types/[!_]*.py")]:
    if str(path.relative_to(CLIENT)) not in generated():
        path.unlink()
