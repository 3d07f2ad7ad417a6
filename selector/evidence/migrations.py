"""How a store of one version of the schema becomes one of the next.

Each function is final once it has been released: it speaks SQL of its own, since `schema.py` changes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from sqlalchemy import Connection

Migration = Callable[[Connection], None]

MIGRATIONS: Mapping[int, Migration] = MappingProxyType({})
"""Version -> what makes the next one of it."""
