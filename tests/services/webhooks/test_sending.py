"""Sending an event: signed as Standard Webhooks says, and led nowhere by the receiver."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime

import pytest

from app.services.webhooks import sending
from app.services.webhooks.sending import send, signed
from app.store.webhooks.deliveries import Delivery
from tests.receivers import receiving

NOW = datetime.fromtimestamp(1674087231, UTC)
SECRET = "whsec_plJ3nmyCDGBKInavdOK15jsl"


def delivery(url: str) -> Delivery:
    return Delivery("msg_1", "webhook_1", url, SECRET, "fit.failed", '{"a": 1}', 1)


def test_the_signature_is_that_of_the_specification() -> None:
    """The example of the specification's own libraries."""
    body = b'{"event_type":"ping","data":{"success":true}}'
    headers = signed("msg_loFOjxBNrRLzqYUf", SECRET, body, datetime.fromtimestamp(1731705121, UTC))
    assert headers["webhook-id"] == "msg_loFOjxBNrRLzqYUf"
    assert headers["webhook-timestamp"] == "1731705121"
    assert headers["webhook-signature"] == "v1,rAvfW3dJ/X/qxhsaXPOyyCGmRKsaKWcsNccKXlIktD0="


def test_an_event_is_posted_with_its_headers() -> None:
    with receiving() as receiver:
        outcome = send(delivery(receiver.url + "hook?a=b"), NOW)
    assert (outcome.is_delivered, outcome.status) == (True, 204)
    ((headers, body),) = receiver.received
    assert body == b'{"a": 1}'
    assert headers["content-type"] == "application/json"
    expected = signed("msg_1", SECRET, body, NOW)
    assert {name: headers[name] for name in expected} == expected


@pytest.mark.parametrize("status", [302, 400, 404, 410, 500])
def test_another_status_is_a_failure_and_redirects_are_not_followed(status: int) -> None:
    with receiving() as receiver:
        receiver.answers.append(status)
        outcome = send(delivery(receiver.url), NOW)
    assert (outcome.is_delivered, outcome.status) == (False, status)
    assert outcome.is_gone == (status == 410)
    assert len(receiver.received) == 1


@contextmanager
def raw_receiver(sent: bytes, *, drips: bool = False) -> Iterator[str]:
    """A server that answers one call with these bytes, or drips them and never ends."""
    stop = threading.Event()

    def answer() -> None:
        line, _ = listener.accept()
        with line:
            line.recv(65536)
            line.sendall(sent)
            while drips and not stop.wait(0.05):
                try:
                    line.sendall(b"0")
                except OSError:
                    return

    with socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=answer)
        thread.start()
        yield f"http://127.0.0.1:{listener.getsockname()[1]}/"
        stop.set()
        thread.join()


@pytest.mark.parametrize("sent", [b"", b"nonsense\r\n\r\n", b"HTTP/1.1 99999 x\r\n\r\n"])
def test_an_answer_that_is_no_http_is_a_failure(sent: bytes) -> None:
    with raw_receiver(sent) as url:
        outcome = send(delivery(url), NOW)
    assert (outcome.is_delivered, outcome.status) == (False, None)
    assert outcome.detail


def test_an_answer_that_never_ends_is_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sending, "TOTAL_SECONDS", 0.5)
    with raw_receiver(b"HTTP/1.1 200", drips=True) as url:
        outcome = send(delivery(url), NOW)
    assert (outcome.is_delivered, outcome.status) == (False, None)


def test_nobody_there_is_a_failure_with_a_reason() -> None:
    with receiving() as receiver:
        pass
    outcome = send(delivery(receiver.url), NOW)
    assert outcome.detail == "The receiver cannot be reached: Connection refused."


def test_a_receiver_without_tls_is_a_failure() -> None:
    with receiving() as receiver:
        outcome = send(delivery(receiver.url.replace("http://", "https://")), NOW)
    assert not outcome.is_delivered
    assert receiver.received == []
