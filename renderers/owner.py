"""Things that hold GPU memory, and give it back at the end of a `with` block."""

from __future__ import annotations

from abc import ABC, abstractmethod
from types import TracebackType
from typing import Self


class Owner(ABC):
    """Holds GPU memory until it is released; a context manager that releases it."""

    @abstractmethod
    def release(self) -> None:
        """Give the GPU memory back; nothing may be asked of it afterwards."""

    def __enter__(self) -> Self:
        """The owner itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give the GPU memory back."""
        self.release()
