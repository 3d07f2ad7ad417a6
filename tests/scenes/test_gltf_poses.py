"""Skins in their bind pose, morph targets at their default weights."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenes.errors import LevelError
from tests.scenes.gltf_samples import CORNERS, TETRAHEDRON, Json, document, notes_of, read, tetrahedron

UP = np.array([[0, 1, 0]] * 4, np.float32)
OUT = np.array([[1, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 2]], np.float32)


def morphing(*targets: np.ndarray, node: Json | None = None, **mesh: Any) -> Json:
    source = tetrahedron(nodes=[{"mesh": 0, **(node or {})}])
    source |= document(CORNERS, TETRAHEDRON.ravel(), *targets)
    source["meshes"][0] |= mesh
    named = [{"POSITION": 2 + index} for index in range(len(targets))]
    source["meshes"][0]["primitives"][0]["targets"] = named
    return source


@pytest.mark.parametrize(
    ("mesh", "node", "expected"),
    [
        ({}, {}, CORNERS),
        ({"weights": [0.0, 0.0]}, {}, CORNERS),
        ({"weights": [0.5, 0.0]}, {}, CORNERS + 0.5 * UP),
        ({"weights": [0.5, -2.0]}, {}, CORNERS + 0.5 * UP - 2 * OUT),
        ({"weights": [0.5, 1.0]}, {"weights": [0.0, 1.0]}, CORNERS + OUT),
        ({"weights": [0.5, 1.0]}, {"weights": [0.0, 0.0]}, CORNERS),
        ({}, {"weights": [3.0, 0.0]}, CORNERS + 3 * UP),
    ],
)
def test_the_weights_of_the_node_count_before_those_of_the_mesh(
    tmp_path: Path, mesh: Json, node: Json, expected: np.ndarray
) -> None:
    level = read(tmp_path, morphing(UP, OUT, node=node, **mesh))
    (found,) = level.scene.meshes
    np.testing.assert_array_equal(found.positions, expected)
    base = np.array_equal(expected, CORNERS)
    said = "in the base shape, all default weights are 0" if base else "at their default weights"
    assert f"mesh 0, primitive 0: Morph targets: read {said}" in notes_of(level)


def test_nodes_with_the_same_weights_share_arrays(tmp_path: Path) -> None:
    source = morphing(UP, weights=[1.0])
    source["nodes"] = [{"mesh": 0}, {"mesh": 0, "weights": [2.0]}, {"mesh": 0, "weights": [1.0]}]
    source["scenes"] = [{"nodes": [0, 1, 2]}]
    first, second, third = read(tmp_path, source).scene.meshes
    assert first.positions is third.positions
    assert first.triangles is second.triangles
    np.testing.assert_array_equal(second.positions, CORNERS + 2 * UP)


def test_sparse_quantised_and_empty_targets(tmp_path: Path) -> None:
    source = morphing(
        np.array([[0, 127, 0]] * 4, np.int8), np.array([2], np.uint8), OUT[:1], weights=[1, 1, 1]
    )
    source["accessors"][2]["normalized"] = True
    sparse = {
        "count": 1,
        "indices": {"bufferView": 3, "componentType": 5121},
        "values": {"bufferView": 4},
    }
    source["accessors"][3] = {"componentType": 5126, "type": "VEC3", "count": 4, "sparse": sparse}
    source["accessors"][4] = {"componentType": 5126, "type": "VEC3", "count": 4}
    (mesh,) = read(tmp_path, source).scene.meshes
    expected = CORNERS + UP
    expected[2] += OUT[0]
    np.testing.assert_array_equal(mesh.positions, expected)


def test_targets_that_move_no_positions(tmp_path: Path) -> None:
    source = morphing(UP, weights=[1.0])
    source["meshes"][0]["primitives"][0]["targets"] = [{"NORMAL": 2}]
    (mesh,) = read(tmp_path, source).scene.meshes
    np.testing.assert_array_equal(mesh.positions, CORNERS)


@pytest.mark.parametrize(
    ("targets", "weights", "said"),
    [
        ([UP], [1.0, 2.0], "There are 2 morph weights for 1 targets"),
        ([UP[:3].copy()], [1.0], '"count" must be 4, as many as the primitive has positions'),
        ([UP], ["a"], '"weights" must be a list of 1 finite numbers'),
        ([UP], 5, '"weights" must be a list'),
        ([UP * np.float32(np.nan)], [1.0], "is not finite"),
        ([UP * np.float32(3e38)], [9.0], "is not finite"),
        ([UP[:, :2].copy()], [1.0], '"VEC3" for this use'),
    ],
)
def test_bad_targets_are_refused(tmp_path: Path, targets: list[np.ndarray], weights: Any, said: str) -> None:
    with pytest.raises(LevelError) as error:
        read(tmp_path, morphing(*targets, weights=weights))
    assert said in str(error.value)
    assert error.value.remedy


@pytest.mark.parametrize("targets", [[5], [None], {"POSITION": 2}, [{"POSITION": 99}], [{"POSITION": "2"}]])
def test_malformed_targets_are_refused(tmp_path: Path, targets: Any) -> None:
    source = morphing(UP, weights=[1.0])
    source["meshes"][0]["primitives"][0]["targets"] = targets
    with pytest.raises(LevelError, match="mesh 0, primitive 0"):
        read(tmp_path, source)


def skinned(inverse: np.ndarray | None = None, **skin: Any) -> Json:
    """A tetrahedron hung on two bones, the first three metres up, below a node that must not count."""
    nodes = [
        {"mesh": 0, "skin": 0, "name": "Fox", "translation": [100, 0, 0], "children": [1]},
        {"name": "hip"},
        {"name": "root", "translation": [0, 3, 0], "children": [3]},
        {"name": "neck", "translation": [0, 1, 0]},
    ]
    matrices = np.tile(np.eye(4, dtype=np.float32).ravel(), (2, 1)) if inverse is None else inverse
    source = tetrahedron(nodes=nodes, scenes=[{"nodes": [0, 2]}])
    source |= document(CORNERS, TETRAHEDRON.ravel(), matrices)
    source["accessors"][2]["type"] = "MAT4"
    source["skins"] = [{"joints": [2, 3], "inverseBindMatrices": 2, **skin}]
    return source


def test_a_skin_stands_where_its_first_joint_puts_its_bind_pose(tmp_path: Path) -> None:
    inverse = np.tile(np.diag([2.0, 2, 2, 1]).astype(np.float32).ravel(), (2, 1))
    inverse[0, 12:15] = (1, -1, 0.5)
    level = read(tmp_path, skinned(inverse))
    (mesh,) = level.scene.meshes
    expected = np.diag([2.0, 2, 2, 1])
    expected[:3, 3] = (1, 2, 0.5)
    np.testing.assert_array_equal(mesh.placements, [expected])
    np.testing.assert_array_equal(mesh.positions, CORNERS)
    assert 'warning node 0 "Fox": Skinned: read in its bind pose, where the first joint' in notes_of(level)


def test_a_quantised_skin_has_the_size_that_its_bones_say(tmp_path: Path) -> None:
    """KHR_mesh_quantization: the inverse bind matrices undo the quantisation of a skinned mesh."""
    inverse = np.tile(np.diag([2.0**-10, 2.0**-10, 2.0**-10, 1]).astype(np.float32).ravel(), (2, 1))
    source = skinned(inverse)
    source["buffers"][0] = document((CORNERS * 1024).astype(np.int16))["buffers"][0]
    source["bufferViews"][0]["byteLength"] = 24
    source["accessors"][0]["componentType"] = 5122
    low, high = read(tmp_path, source).scene.bounds
    np.testing.assert_array_equal(high - low, CORNERS.max(axis=0))


def test_a_skin_without_matrices_or_whose_joint_is_elsewhere(tmp_path: Path) -> None:
    plain = read(tmp_path, skinned(inverseBindMatrices=None)).scene.meshes[0]
    np.testing.assert_array_equal(plain.placements[0, :3, 3], (0, 3, 0))
    source = skinned()
    source["scenes"] = [{"nodes": [0]}]
    level = read(tmp_path, source)
    np.testing.assert_array_equal(level.scene.meshes[0].placements[0, :3, 3], (100, 0, 0))
    assert "since its first joint is not in this scene" in notes_of(level)


FLAT = np.tile(np.diag([1.0, 0, 1, 1]).astype(np.float32).ravel(), (2, 1))
SLANTED = np.tile(np.eye(4, dtype=np.float32).ravel(), (2, 1))
SLANTED[0, 3] = 1
ENDLESS = SLANTED.copy()
ENDLESS[0, 3], ENDLESS[0, 12] = 0, np.inf


@pytest.mark.parametrize(
    ("source", "said"),
    [
        (skinned(joints=[]), '"joints" must be a list of 1 to 65536 nodes'),
        (skinned(joints="2"), '"joints" must be a list'),
        (skinned(joints=[2, 3, 1]), '"count" must be from 3'),
        (skinned(inverseBindMatrices=0), '"type" must be "MAT4" for this use'),
        (skinned(inverseBindMatrices=77), "accessor 77 does not exist"),
        (skinned(FLAT), "squashes its mesh into a plane"),
        (skinned(SLANTED), "The first inverse bind matrix is not affine"),
        (skinned(ENDLESS), "is not finite"),
        (skinned() | {"skins": []}, "skin 0 does not exist"),
        (skinned() | {"skins": [5]}, "This entry is not a JSON object"),
    ],
)
def test_bad_skins_are_refused(tmp_path: Path, source: Json, said: str) -> None:
    with pytest.raises(LevelError) as error:
        read(tmp_path, source)
    assert said in str(error.value)
    assert error.value.remedy


def test_a_huge_claim_of_matrices_is_refused(tmp_path: Path) -> None:
    source = skinned()
    source["accessors"][2] |= {"count": 2**50, "sparse": {"count": 1, "indices": {}, "values": {}}}
    del source["accessors"][2]["bufferView"]
    with pytest.raises(LevelError, match='"count" must be from 2, as many as the skin has joints, to 65536'):
        read(tmp_path, source)
