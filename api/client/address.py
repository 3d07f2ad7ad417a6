"""Where the service is."""

from __future__ import annotations

from dataclasses import dataclass
from ipaddress import ip_address
from urllib.parse import urlsplit

from .errors import AddressError

DEFAULT_URL = "http://127.0.0.1:8420"
PORTS = {"http": 80, "https": 443}


@dataclass(frozen=True)
class Address:
    """A service's address.

    Attributes:
        scheme: `http` or `https`.
        host: Name or number, without brackets.
        port: Port.
        prefix: Path under which the service lies, without a slash at its end.
    """

    scheme: str
    host: str
    port: int
    prefix: str

    @classmethod
    def of(cls, url: str) -> Address:
        """The address that a URL names.

        Raises:
            AddressError: It is no http or https URL, or holds more than a place.
        """
        try:
            parts = urlsplit(url.strip())
            port = parts.port
        except ValueError as error:
            raise AddressError(f"The address {url[:80]} cannot be read: {error}.") from None
        if parts.scheme not in PORTS or not parts.hostname:
            raise AddressError(f"The address {url[:80]} is none like {DEFAULT_URL}.")
        if parts.username is not None or parts.query or parts.fragment:
            raise AddressError("The address may hold a host, a port and a path; the token goes apart.")
        if not (parts.hostname + parts.path).isascii() or " " in parts.hostname + parts.path:
            raise AddressError(f"The address {url[:80]} holds characters that are not allowed there.")
        return cls(parts.scheme, parts.hostname, port or PORTS[parts.scheme], parts.path.rstrip("/"))

    @property
    def is_loopback(self) -> bool:
        """Whether it is this very machine."""
        if self.host == "localhost":
            return True
        try:
            return ip_address(self.host).is_loopback
        except ValueError:
            return False

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.scheme}://{host}:{self.port}{self.prefix}"
