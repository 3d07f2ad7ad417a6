"""Features of instances, kept so that nobody needs the scenes again."""

from __future__ import annotations

from collections.abc import Mapping

from sqlalchemy import Connection, select

from selector.evidence.numbering import Vocabularies, inserting, numbers
from selector.evidence.packing import packed_floats, unpacked
from selector.evidence.schema import features, instances

Values = Mapping[str, Mapping[str, float]]
"""Key of an instance -> name -> value."""


def write_features(connection: Connection, extractor: str, values: Values, costs: Values) -> None:
    """Keeps them; those of the same extractor and instance give way.

    Raises:
        StoreError: An instance is not in the store.
    """
    known = numbers(connection, instances, values)
    words = Vocabularies(connection)
    records = []
    for key, of_instance in values.items():
        value_names, packed = packed_floats(of_instance)
        cost_names, packed_costs = packed_floats(costs.get(key, {}))
        records.append(
            {
                "extractor": extractor,
                "instance": known[key],
                "value_names": words.number(value_names),
                "feature_values": packed,
                "cost_names": words.number(cost_names),
                "costs_ms": packed_costs,
            }
        )
    if not records:
        return
    insert = inserting(connection, features)
    key_columns = list(features.primary_key)
    replaced = {column.name: insert.excluded[column.name] for column in features.c if not column.primary_key}
    connection.execute(insert.on_conflict_do_update(index_elements=key_columns, set_=replaced), records)


def read_features(
    connection: Connection, extractor: str
) -> tuple[dict[str, dict[str, float]], dict[str, dict[str, float]]]:
    """Values and costs in milliseconds, each instance key -> name -> number, in the order of keys."""
    words = Vocabularies(connection)
    query = (
        select(instances.c.key, *features.c)
        .join(features, features.c.instance == instances.c.id)
        .where(features.c.extractor == extractor)
        .order_by(instances.c.key)
    )
    values, costs = {}, {}
    for record in connection.execute(query).mappings():
        key = record["key"]
        values[key] = unpacked(words.names(record["value_names"]), record["feature_values"])
        costs[key] = unpacked(words.names(record["cost_names"]), record["costs_ms"])
    return values, costs


def read_extractors(connection: Connection) -> list[str]:
    """Whose features the store holds."""
    return list(connection.scalars(select(features.c.extractor).distinct().order_by(features.c.extractor)))
