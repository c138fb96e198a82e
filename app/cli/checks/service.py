"""Checks a service at another address."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import typer

from app.cli.checks.finding import Finding, fine, problem
from app.cli.checks.queue import check_disk, check_queue
from app.cli.session import open_client

if TYPE_CHECKING:
    from kinedex import Kinedex, KinedexError

ADVICE = {
    401: "Give a key with --api-key or KINEDEX_API_KEY; `kinedex keys create` on the machine of "
    "the service makes one.",
    403: "Use a key with a higher role.",
}


def check_service(context: typer.Context) -> Iterator[Finding]:
    """Whether the service can be reached, is ready, accepts the key, and does its work."""
    from kinedex import KinedexError

    with open_client(context) as client:
        try:
            client.service.alive()
        except KinedexError as failure:
            advice = "Correct --url, or start the service there with `kinedex serve`."
            yield problem("service", failure.detail, advice)
            return
        yield fine("service", f"{client.url} answers")
        yield _readiness(client)
        try:
            status = client.service.status()
        except KinedexError as failure:
            yield _refused(failure)
            return
        yield fine("key", "the service accepts these calls")
        yield check_queue([(one.kind, one.state, one.count, one.oldest_s) for one in status.jobs])
        yield check_disk(status.disk.free)


def _readiness(client: Kinedex) -> Finding:
    from kinedex import KinedexError

    try:
        client.service.ready()
    except KinedexError as failure:
        places = "; ".join(f"{one.location}: {one.message}" for one in failure.errors)
        advice = "Run `kinedex doctor` on the machine of the service."
        return problem("readiness", places or failure.detail, advice)
    return fine("readiness", "the service can answer every call")


def _refused(failure: KinedexError) -> Finding:
    advice = ADVICE.get(failure.status, "Run `kinedex doctor` on the machine of the service.")
    return problem("key", failure.detail, advice)
