"""What can go wrong between a program and the service, each with a sentence for people."""

from __future__ import annotations


class ClientError(Exception):
    """A request that came to nothing; its text is a sentence for people."""


class AddressError(ClientError):
    """The address or the token is none that a request could be sent with."""


class LevelFileError(ClientError):
    """The level cannot be read, or a file that it names."""


class ServiceUnreachableError(ClientError):
    """Nobody answers at the address, or the connection broke before there was an answer."""


class TimedOutError(ServiceUnreachableError):
    """The time that the caller gave is over."""


class CancelledRequestError(ClientError):
    """The caller has cancelled it."""


class BadAnswerError(ClientError):
    """Something answered, but not as the service does: garbage, cut short, too long, or of another kind."""


class ProblemError(ClientError):
    """The service's own no.

    Args:
        status: The HTTP status.
        title: The kind of problem in a few words.
        detail: A sentence that says what is wrong.
        known: What the service found; empty where it says nothing of it.
        remedy: What can be done; empty where it says nothing of it.
        retry_after_s: When to try again; None where it does not say.
    """

    def __init__(
        self,
        status: int,
        title: str,
        detail: str,
        *,
        known: str = "",
        remedy: str = "",
        retry_after_s: float | None = None,
    ) -> None:
        super().__init__(detail)
        self.status = status
        self.title = title
        self.detail = detail
        self.known = known
        self.remedy = remedy
        self.retry_after_s = retry_after_s

    def __str__(self) -> str:
        return " ".join(part for part in (self.detail or self.title, self.known, self.remedy) if part)
