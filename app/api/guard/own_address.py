"""Without API keys, only this machine's own pages and programs may call.

A page of another site, opened in the user's browser, can send requests to 127.0.0.1 too. What
tells it apart:

- `Host`: a name of the other site can be made to point at this machine (DNS rebinding), and then
  the browser believes that the answers are that site's. So only loopback's names are taken, each
  exactly as it is written, with any port, since ports are forwarded.
- `Origin`: where a browser sends it, it must be the address that was called.
- `Sec-Fetch-Site`: a browser says whether the request comes from another site. Then only a page
  may be opened, as one follows a link.
"""

from __future__ import annotations

import re

from starlette.datastructures import Headers
from starlette.types import Scope

from app.api.guard.page_paths import is_page
from app.api.guard.paths import path_of
from app.errors import Forbidden

_HOST = re.compile(
    r"(?:localhost|127\.0\.0\.1|\[::1\])(?::(?P<port>[0-9]{1,5}))?", re.ASCII | re.IGNORECASE
)
LARGEST_PORT = 65_535
OWN_SITES = frozenset({"same-origin", "none"})
"""`none` is the user's own doing: an address that was typed, a bookmark."""
CHANGE_NOTHING = frozenset({"GET", "HEAD", "OPTIONS"})


def refuse_other_sites(scope: Scope) -> None:
    """Raises Forbidden where a request may come from a page of another site."""
    headers = Headers(scope=scope)
    host = _own_host(headers)
    own = f"{scope['scheme']}://{host}"
    if any(origin.lower() != own for origin in headers.getlist("origin")):
        raise Forbidden("Without API keys, calls from another site are not answered.")
    sites = headers.getlist("sec-fetch-site")
    if not OWN_SITES.issuperset(sites) and not _opens_a_page(scope, headers):
        raise Forbidden("Without API keys, calls from another site are not answered.")


def refuse_other_pages(scope: Scope) -> None:
    """Raises Forbidden unless a page of the address that was called, or the user, calls.

    For calls that a cookie allows. The host may have any name here, and a proxy may have taken
    TLS off, so that schemes are not compared.
    """
    headers = Headers(scope=scope)
    sites = headers.getlist("sec-fetch-site")
    hosts = [origin.partition("://")[2].lower() for origin in headers.getlist("origin")]
    own = headers.get("host", "").lower()
    says = bool(sites or hosts) or scope["method"] in CHANGE_NOTHING
    if not says or not OWN_SITES.issuperset(sites) or (not sites and set(hosts) - {own}):
        raise Forbidden("Who is signed in can only be called for by the pages of this address.")


def _own_host(headers: Headers) -> str:
    hosts = headers.getlist("host")
    found = _HOST.fullmatch(hosts[0]) if len(hosts) == 1 else None
    if found is None or not 1 <= int(found["port"] or 1) <= LARGEST_PORT:
        raise Forbidden(
            "Without API keys, only this machine's own addresses are answered:"
            " localhost, 127.0.0.1 and [::1]."
        )
    return found[0].lower()


def _opens_a_page(scope: Scope, headers: Headers) -> bool:
    return (
        scope["method"] in {"GET", "HEAD"}
        and is_page(path_of(scope))
        and headers.getlist("sec-fetch-mode") == ["navigate"]
        and headers.getlist("sec-fetch-dest") == ["document"]
    )
