"""The tables of a store.

Keys of `rows.py` are long, and each fact names four of them; inside one store short numbers stand for them. A
number means nothing outside its store: merging goes by the keys, which are unique.

Measurements by name (figures, counters, stages, features) are a number of a list of names, and the values as
packed float64 or int64: a quarter of the room that JSON takes, and read a hundred thousand at a time.
"""

from __future__ import annotations

from sqlalchemy import (
    BigInteger,
    Column,
    Double,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    SmallInteger,
    String,
    Table,
    UniqueConstraint,
)

SCHEMA_VERSION = 1
"""Whoever changes a table raises this, and writes a function for `migrations.py`."""

_KEY_DIGITS = 32
metadata = MetaData()


def _text(name: str) -> Column[str]:
    return Column(name, String, nullable=False)


def _whole(name: str) -> Column[int]:
    return Column(name, Integer, nullable=False)


def _of(name: str, table: str) -> Column[int]:
    return Column(name, ForeignKey(f"{table}.id"), nullable=False)


def _packed(name: str) -> Column[bytes]:
    return Column(name, LargeBinary, nullable=False)


def _keyed(table: str, *columns: Column[str] | Column[int], digits: int = _KEY_DIGITS) -> Table:
    return Table(
        table,
        metadata,
        Column("id", Integer, primary_key=True),
        Column("key", String(digits), unique=True, nullable=False),
        *columns,
    )


meta = Table("gnomon_meta", metadata, Column("name", String, primary_key=True), _text("value"))

instances = _keyed(
    "instances",
    *map(_text, ("scene_digest", "scene", "family", "origin", "role", "light", "camera")),
    *map(_whole, ("width", "height")),
)
candidates = _keyed("candidates", *map(_text, ("technique", "settings")))
devices = _keyed(
    "devices",
    *map(_text, ("renderer", "vendor", "gl_version", "clock", "processor", "virtual")),
    _whole("threads"),
)
runs = _keyed(
    "runs",
    *map(_text, ("started", "commit", "purpose", "remarks")),
    Column("seed", BigInteger, nullable=False),
    digits=64,
)
codes = _keyed("codes", digits=128)
vocabularies = Table(
    "vocabularies",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("names", String, unique=True, nullable=False),
)

judgements = Table(
    "judgements",
    metadata,
    Column("device", ForeignKey("devices.id"), primary_key=True),
    Column("code", ForeignKey("codes.id"), primary_key=True),
    Column("instance", ForeignKey("instances.id"), primary_key=True),
    Column("candidate", ForeignKey("candidates.id"), primary_key=True),
    _of("run", "runs"),
    *map(_text, ("status", "reason", "truth", "fallback")),
    Column("memory_bytes", BigInteger, nullable=False),
    _of("figure_names", "vocabularies"),
    _packed("figures"),
    _of("counter_names", "vocabularies"),
    _packed("counters"),
    Index("judgements_of_instance", "instance"),
    sqlite_with_rowid=False,
)

timings = Table(
    "timings",
    metadata,
    Column("id", Integer, primary_key=True),
    _of("device", "devices"),
    _of("code", "codes"),
    _of("instance", "instances"),
    _of("candidate", "candidates"),
    _of("run", "runs"),
    *map(_text, ("status", "reason")),
    UniqueConstraint("device", "code", "instance", "candidate", "run"),
    Index("timings_of_instance", "instance"),
)

samples = Table(
    "samples",
    metadata,
    Column("timing", ForeignKey("timings.id"), primary_key=True),
    Column("round", Integer, primary_key=True, autoincrement=False),
    Column("mobility", SmallInteger, primary_key=True, autoincrement=False),
    Column("shadow_ms", Double, nullable=False),
    Column("frame_ms", Double, nullable=False),
    Column("canary_ms", Double, nullable=False),
    _of("stage_names", "vocabularies"),
    _packed("stages_ms"),
    sqlite_with_rowid=False,
)

features = Table(
    "features",
    metadata,
    Column("extractor", String, primary_key=True),
    Column("instance", ForeignKey("instances.id"), primary_key=True),
    _of("value_names", "vocabularies"),
    _packed("feature_values"),
    _of("cost_names", "vocabularies"),
    _packed("costs_ms"),
)
