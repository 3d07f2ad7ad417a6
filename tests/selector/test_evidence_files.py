"""Evidence leaves a store and comes into another, whole and once."""

from __future__ import annotations

from pathlib import Path

import pytest
from pyarrow import parquet

from scenes.errors import OutputError
from selector.evidence.exporting import FileFormat, export
from selector.evidence.flat_tables import FLAT_TABLES
from selector.evidence.importing import bring_in
from selector.evidence.merging import merge
from selector.evidence.store import Store, StoreError
from selector.measurement import Status
from tests.selector.evidence_rows import SM, SV, asked, everything, filled, instance, judgement, timing


def new(folder: Path, name: str) -> Store:
    return Store.open(str(folder / name))


def various(store: Store, first: int = 0) -> None:
    """Every kind of row, and values that are hard to write down."""
    filled(store, 5, first)
    row = instance(first + 20)
    failed = judgement(asked(row, SM), status=Status.OUT_OF_MEMORY)
    store.add(
        row,
        [SM, SV],
        [failed],
        [timing(asked(row, SV), 1e-300, 1 / 3), timing(asked(row, SM), status=Status.CRASHED)],
    )
    values = {one.key: {"triangles": 0.1, 'odd, "name"': 2.0} for one in store.instances()}
    store.add_features("first 1", values, {row.key: {"polygons": 1.5}})
    store.add_features("second", {row.key: {"other": -1e300}})


def same(one: Store, other: Store) -> bool:
    extractors = one.extractors() == other.extractors() == ["first 1", "second"]
    return (
        extractors
        and everything(one) == everything(other)
        and all(one.features(name) == other.features(name) for name in one.extractors())
        and all(one.feature_costs(name) == other.feature_costs(name) for name in one.extractors())
    )


@pytest.mark.parametrize("form", FileFormat)
def test_what_is_exported_comes_back_whole_and_once(tmp_path: Path, form: FileFormat) -> None:
    with new(tmp_path, "a") as store, new(tmp_path, "b") as other:
        various(store)
        written = export(store, tmp_path / "out" / "files", form)
        assert {path.name for path in written} == {f"{name}.{form}" for name in FLAT_TABLES}
        assert {path.name for path in (tmp_path / "out/files").iterdir()} == {path.name for path in written}
        for _ in range(2):
            bring_in(other, [tmp_path / "out" / "files"])
            assert same(store, other)
        export(other, tmp_path / "again", form)
        for path in written:
            assert (tmp_path / "again" / path.name).read_bytes() == path.read_bytes()


@pytest.mark.parametrize("form", FileFormat)
def test_an_empty_store_makes_empty_tables(tmp_path: Path, form: FileFormat) -> None:
    with new(tmp_path, "a") as store, new(tmp_path, "b") as other:
        export(store, tmp_path / "files", form)
        bring_in(other, [tmp_path / "files"])
        assert everything(other) == everything(store)


def test_stores_merge_in_any_order_without_doubling(tmp_path: Path) -> None:
    with new(tmp_path, "a") as one, new(tmp_path, "b") as two, new(tmp_path, "c") as both:
        various(one)
        various(two, 3)
        for other in (one, two, one):
            merge(both, other)
        merge(one, two)
        merge(two, one)
        assert same(one, two)
        assert same(one, both)
        names = [row.asked for row in both.judgements()]
        assert len(set(names)) == len(names)


def test_files_are_imported_one_by_one(tmp_path: Path) -> None:
    with new(tmp_path, "a") as store, new(tmp_path, "b") as other:
        various(store)
        written = {path.stem: path for path in export(store, tmp_path / "files", FileFormat.PARQUET)}
        with pytest.raises(StoreError, match="among its instances"):
            bring_in(other, [written["judgements"]])
        bring_in(
            other, [written[name] for name in ("judgements", "runs", "instances", "candidates", "devices")]
        )
        assert list(other.judgements()) == list(store.judgements())
        with pytest.raises(StoreError, match="belongs to no timing"):
            bring_in(other, [written["samples"]])
        bring_in(other, [written["samples"], written["timings"]])
        assert list(other.timings()) == list(store.timings())


def test_what_is_no_evidence_is_refused_with_a_sentence(tmp_path: Path) -> None:
    folder = tmp_path / "files"
    with new(tmp_path, "a") as store:
        filled(store, 2)
        export(store, folder, FileFormat.PARQUET)
        before = everything(store)
        for path, words in (
            (tmp_path / "nowhere", "no such file"),
            (tmp_path / "a", "no evidence here"),
            (tmp_path, "no evidence here"),
        ):
            with pytest.raises(StoreError, match=words):
                bring_in(store, [path])
        whole = (folder / "judgements.parquet").read_bytes()
        table = parquet.read_table(folder / "instances.parquet")
        broken = {
            "judgements.parquet": whole[: len(whole) // 2],
            "candidates.csv": b"technique,key\nSM,1\n",
            "runs.csv": b"\xff\xfe\x00",
            "timings.csv": b"instance,candidate,device,code,run,status,reason\na,b,c,d,e,fine,\n",
        }
        for name, data in broken.items():
            path = tmp_path / name
            path.write_bytes(data)
            with pytest.raises(StoreError, match="no table of evidence") as caught:
                bring_in(store, [path])
            assert caught.value.where == str(path)
        forged = table.set_column(table.schema.get_field_index("width"), "width", [[1] * table.num_rows])
        parquet.write_table(forged, tmp_path / "instances.parquet")
        with pytest.raises(StoreError, match="does not match its key"):
            bring_in(store, [tmp_path / "instances.parquet"])
        assert everything(store) == before


def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    with new(tmp_path, "a") as store:
        with pytest.raises(OutputError):
            export(store, tmp_path / "a", FileFormat.CSV)
        (tmp_path / "files" / "runs.csv").mkdir(parents=True)
        with pytest.raises(OutputError):
            export(store, tmp_path / "files", FileFormat.CSV)
    assert [path.name for path in (tmp_path / "files").iterdir() if "partial" in path.name] == []
