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

from app.api.guard.page_paths import is_page
from app.api.guard.paths import path_of
from app.errors import Forbidden

_HOST = re.compile(
    r"(?:localhost|127\.0\.0\.1|\[::1\])(?::(?P<port>[0-9]{1,5}))?", re.ASCII | re.IGNORECASE
)
MAX_PORT = 65_535
OWN_SITES = frozenset({"same-origin", "none"})
"""The value is `none` if the user typed the address or opened a bookmark."""
CHANGE_NOTHING = frozenset({"GET", "HEAD", "OPTIONS"})
"""Methods that change nothing."""


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


def refuse_other_pages(scope: Scope) -> None:
    """Raises Forbidden unless a page of the address that was called, or the user, calls.

    For calls that a cookie allows. The host may have any name here, and a proxy may have taken
    TLS off, so that `http` and `https` are not told apart.
    """
    headers = Headers(scope=scope)
    sites = headers.getlist("sec-fetch-site")
    hosts = [_host_of(origin.lower()) for origin in headers.getlist("origin")]
    own = headers.get("host", "").lower()
    says = bool(sites or hosts) or scope["method"] in CHANGE_NOTHING
    if not says or not OWN_SITES.issuperset(sites) or (not sites and set(hosts) - {own}):
        raise Forbidden("With a cookie, only the pages of this address may call.")


def _host_of(origin: str) -> str:
    """The host and port of a page; a text that is no host if the origin is not one of a page."""
    scheme, _, host = origin.partition("://")
    return host if scheme in {"http", "https"} else f"not a page: {origin}"


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
        and is_page(path_of(scope))
        and headers.getlist("sec-fetch-mode") == ["navigate"]
        and headers.getlist("sec-fetch-dest") == ["document"]
    )
