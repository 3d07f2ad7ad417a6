"""Every family of the corpus, for every seed: sound geometry, its number of triangles, the same bits."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenes.corpus.registry import families, load_families
from scenes.corpus.spec import STEPS, Closure, Spec
from scenes.corpus.staging import built, instance
from scenes.gltf.writer import glb_bytes
from scenes.scene import Scene
from scenes.solids import GRID_M
from tests.scenes.corpus_digests import RECORDED, made, small
from tests.tolerances import CORPUS_BUDGET, CORPUS_LARGEST_M

ROOT = Path(__file__).parents[2]
WANTED = {
    *("box_grid", "stone_circles", "plain_street", "furnished_room", "water_tower"),
    *(
        "city_block",
        "forest",
        "fence_and_wires",
        "rocky_terrain",
        "warehouse",
        "cathedral",
        "lattice_ceiling",
    ),
    *("corridor_maze", "crowd", "debris_field", "single_hero", "spiral_staircase", "stadium", "truss_bridge"),
    *("harbour_cranes", "cave", "furnished_flat", "ruined_walls", "machine_room", "market_awnings"),
}

each_family = pytest.mark.parametrize("name", families())
# A few seeds of every family each time; `make test-slow` takes more.
EXAMPLES = int(os.environ.get("GNOMON_CORPUS_EXAMPLES", "3"))
few = settings(max_examples=EXAMPLES, deadline=None, suppress_health_check=[HealthCheck.too_slow])


def specs(name: str, most: int) -> st.SearchStrategy[Spec]:
    low, high = families()[name].TRIANGLES
    return st.builds(
        Spec,
        family=st.just(name),
        seed=st.integers(0, 2**53 - 1),
        triangles=st.integers(low, min(high, most)),
        crowding=st.integers(0, STEPS - 1),
        grain=st.integers(0, STEPS - 1),
        closure=st.sampled_from(Closure),
        kind=st.just(families()[name].KINDS[0]),
    )


def test_the_families_that_were_asked_for_are_there() -> None:
    assert set(families()) >= WANTED
    assert len(families()) >= 24
    summaries = [family.SUMMARY for family in families().values()]
    assert len(set(summaries)) == len(summaries)
    assert {family.INDOOR for family in families().values()} == {True, False}


@each_family
def test_geometry_is_sound_for_every_seed(name: str) -> None:
    @few
    @given(spec=specs(name, 12_000))
    def check(spec: Spec) -> None:
        stage = built(spec)
        assert stage.triangle_count <= CORPUS_BUDGET * spec.triangles
        if spec.closure is not Closure.BOTTOMLESS:
            assert stage.triangle_count >= spec.triangles / CORPUS_BUDGET
        for mesh in stage.meshes:
            positions = mesh.positions.astype(np.float64)
            assert np.isfinite(positions).all()
            assert (np.round(positions / GRID_M) * GRID_M == positions).all(), mesh.name
            assert mesh.triangles.min() >= 0
            assert mesh.triangles.max() < len(positions)
            corners = positions[mesh.triangles]
            doubled = np.linalg.norm(
                np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
            )
            assert (doubled > 0.0).all(), mesh.name
            assert np.abs(mesh.world_positions()).max() < CORPUS_LARGEST_M

    check()


@each_family
def test_large_budgets_are_met_too(name: str) -> None:
    spec = Spec(name, seed=7, triangles=150_000, kind=families()[name].KINDS[0])
    assert spec.triangles / CORPUS_BUDGET <= built(spec).triangle_count <= CORPUS_BUDGET * spec.triangles


@each_family
def test_seeds_and_axes_make_other_places(name: str) -> None:
    low, _ = families()[name].TRIANGLES
    first = Spec(name, seed=1, triangles=4 * low, kind=families()[name].KINDS[0])
    digests = {
        Scene("", built(spec).meshes).digest
        for spec in (
            first,
            Spec(name, seed=2, triangles=4 * low, kind=first.kind),
            Spec(name, seed=1, triangles=16 * low, kind=first.kind),
            Spec(name, seed=1, triangles=4 * low, kind=first.kind, closure=Closure.FLIPPED),
        )
    }
    assert len(digests) == 4


@each_family
def test_a_spec_has_one_digest(name: str) -> None:
    low, _ = families()[name].TRIANGLES
    spec = Spec(name, seed=3, triangles=low, kind=families()[name].KINDS[-1], lights=2, cameras=2)
    scene = instance(spec)
    assert scene.digest == instance(Spec.from_text(spec.text)).digest
    assert len(scene.lights) == 2
    assert len(scene.cameras) == 2
    assert scene.lights[0].kind is spec.kind
    for place in (*(light.position for light in scene.lights), *(one.position for one in scene.cameras)):
        assert all(number == round(number / GRID_M) * GRID_M for number in place)
    assert glb_bytes(scene) == glb_bytes(instance(spec))


def test_digests_are_those_of_every_machine() -> None:
    """Recorded once; other processors, libraries and Python versions must give the same."""
    assert made() == RECORDED.read_text()


def test_digests_do_not_depend_on_the_processor() -> None:
    """The same in a process in which NumPy may not use the vector instructions of this one."""
    names = ["forest", "cathedral", "rocky_terrain", "cave"]
    code = (
        "from tests.scenes.corpus_digests import instance, small\n"
        f"print([instance(small(name)).digest for name in {names}])"
    )
    environment = {
        "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
        "PYTHONPATH": str(ROOT),
        "PATH": "",
    }
    plain = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert plain.stdout.strip() == str([instance(small(name)).digest for name in names])


def test_indoor_families_have_no_start_in_the_open() -> None:
    for name, family in families().items():
        stage = built(small(name))
        assert (stage.start is not None) == family.INDOOR, name


def test_a_new_family_is_one_new_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "more_families"
    package.mkdir()
    (package / "__init__.py").touch()
    source = ROOT / "scenes/corpus/families/box_grid.py"
    (package / "another.py").write_text(source.read_text())
    monkeypatch.syspath_prepend(tmp_path)
    assert list(load_families([str(package)], "more_families")) == ["another"]
    (package / "broken.py").write_text("SUMMARY = 'nothing else'\n")
    with pytest.raises(TypeError, match="lacks"):
        load_families([str(package)], "more_families")
