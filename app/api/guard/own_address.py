"""Without API keys, only this machine's own pages and programs may call.

A page of another site, opened in the user's browser, can send requests to 127.0.0.1 too. Three
headers show this:

- `Host`: another site can make its name point at this machine (DNS rebinding). Then the browser
  treats our answers as answers of that site. So we accept only the exact names of loopback, with
  any port, because a port may be forwarded.
- `Origin`: if the browser sends it, it must be the called address.
- `Sec-Fetch-Site`: the browser says whether the request comes from another site. From another
  site, a user may only open a page by a link.
"""

from __future__ import annotations

import re
from collections.abc import Collection

from starlette.datastructures import Headers
from starlette.types import Scope

from app.api.guard.paths import path_of
from app.errors import Forbidden

_HOST = re.compile(
    r"(?:localhost|127\.0\.0\.1|\[::1\])(?::(?P<port>[0-9]{1,5}))?", re.ASCII | re.IGNORECASE
)
MAX_PORT = 65_535
OWN_SITES = frozenset({"same-origin", "none"})
"""The value is `none` if the user typed the address or opened a bookmark."""
PAGES = frozenset({"", "/docs"})
"""Paths that a link on another site may open."""


def refuse_other_sites(scope: Scope, allowed: Collection[str] = ()) -> None:
    """Raises Forbidden if a request may come from a page of another site.

    allowed: origins whose pages may call (`KINEDEX_CORS_ORIGINS`).
    """
    headers = Headers(scope=scope)
    host = _own_host(headers)
    own = f"{scope['scheme']}://{host}"
    origins = [origin.lower() for origin in headers.getlist("origin")]
    if len(origins) == 1 and origins[0] in allowed:
        return
    if any(origin != own for origin in origins):
        raise Forbidden("Without API keys, calls from another site are not answered.")
    sites = headers.getlist("sec-fetch-site")
    if not OWN_SITES.issuperset(sites) and not _opens_a_page(scope, headers):
        raise Forbidden("Without API keys, calls from another site are not answered.")


def _own_host(headers: Headers) -> str:
    hosts = headers.getlist("host")
    match = _HOST.fullmatch(hosts[0]) if len(hosts) == 1 else None
    if match is None or not 1 <= int(match["port"] or 1) <= MAX_PORT:
        raise Forbidden(
            "Without API keys, only this machine's own addresses are answered:"
            " localhost, 127.0.0.1 and [::1]."
        )
    return match[0].lower()


def _opens_a_page(scope: Scope, headers: Headers) -> bool:
    return (
        scope["method"] in {"GET", "HEAD"}
        and path_of(scope) in PAGES
        and headers.getlist("sec-fetch-mode") == ["navigate"]
        and headers.getlist("sec-fetch-dest") == ["document"]
    )
