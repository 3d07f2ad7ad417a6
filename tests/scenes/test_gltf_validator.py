"""Khronos' validator finds nothing new in annotated levels."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from scenes.gltf.annotation import annotate
from scenes.gltf.annotation_record import EXTENSION
from scenes.light_annotation import LightAnnotation
from tests.scenes.gltf_texts import glb

VALIDATOR = Path(__file__).parents[1] / "validator"
LEVELS = Path(__file__).parents[2] / "../shared/levels"
LEVEL_FILES = sorted([*LEVELS.rglob("*.glb"), *LEVELS.rglob("*.gltf")])
ERROR, WARNING = 0, 1

pytestmark = [
    pytest.mark.skipif(not shutil.which("node"), reason="node is not installed"),
    pytest.mark.skipif(
        not (VALIDATOR / "node_modules" / "gltf-validator").is_dir(),
        reason="the glTF validator is not installed: run `npm ci` in tests/validator",
    ),
]

ADVICE = LightAnnotation(
    {"gnomon_technique": "SM", "gnomon_map_size": 1024, "gnomon_filter": "2x2", "gnomon_shadow_ms": 0.25},
    {"technique": "SM", "alternatives": [{"technique": "SV", "shadow_ms": 1.5}]},
)


def reports(requests: list[tuple[Path, Path]]) -> list[Any]:
    """The validator's report of each file; the second path is the folder of the files that it names."""
    asked = json.dumps([{"file": str(file), "folder": str(folder)} for file, folder in requests])
    done = subprocess.run(
        ["node", "validate.mjs"], cwd=VALIDATOR, input=asked, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert len(found) == len(requests)
    return list(found)


def complaints(report: Any) -> Counter[tuple[str, str, str]]:
    messages = report["issues"]["messages"]
    assert len(messages) == sum(
        report["issues"][f"num{kind}s"] for kind in ("Error", "Warning", "Info", "Hint")
    )
    return Counter(
        (m["code"], m.get("pointer", ""), m["message"]) for m in messages if m["severity"] <= WARNING
    )


def codes(report: Any) -> set[str]:
    return {message["code"] for message in report["issues"]["messages"]}


def level(**root: Any) -> bytes:
    node = {"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}}
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}},
            "scenes": [{"nodes": [0]}],
            "nodes": [node],
            **root,
        }
    ).encode()


@pytest.mark.skipif(not LEVEL_FILES, reason="the shared levels are not beside this repository")
def test_annotated_levels_have_no_new_error_or_warning(tmp_path: Path) -> None:
    requests = []
    for number, path in enumerate(LEVEL_FILES):
        source = path.read_bytes()
        text = source[20 : 20 + int.from_bytes(source[12:16], "little")] if path.suffix == ".glb" else source
        nodes = json.loads(text)["nodes"]
        lights = [i for i, node in enumerate(nodes) if "KHR_lights_punctual" in node.get("extensions", {})]
        annotated = tmp_path / f"{number}{path.suffix}"
        annotated.write_bytes(annotate(source, dict.fromkeys(lights or range(len(nodes)), ADVICE)))
        requests += [(path, path.parent), (annotated, path.parent)]
    found = reports(requests)
    for path, before, after in zip(LEVEL_FILES, found[::2], found[1::2], strict=True):
        assert complaints(after) - complaints(before) == Counter(), path.name
        assert EXTENSION in after["info"]["extensionsUsed"], path.name


def test_small_files_of_every_layout_stay_valid(tmp_path: Path) -> None:
    text = level()
    aligned = text + b" " * (-len(text) % 4)
    lamp = {"extensions": {"KHR_lights_punctual": {"light": 0}}}
    sources = {
        "plain.gltf": text,
        "extras.gltf": level(nodes=[{**lamp, "extras": {"gnomon_mobility": "static"}}]),
        "clash.gltf": level(nodes=[{**lamp, "extras": {"gnomon_technique": 5}}]),
        "plain.glb": glb(aligned),
    }
    for name, source in sources.items():
        (tmp_path / name).write_bytes(source)
        (tmp_path / f"annotated_{name}").write_bytes(annotate(source, {0: ADVICE}))
    found = reports(
        [(tmp_path / f"{prefix}{name}", tmp_path) for name in sources for prefix in ("", "annotated_")]
    )
    for name, before, after in zip(sources, found[::2], found[1::2], strict=True):
        assert complaints(before) == Counter(), name
        assert complaints(after) == Counter(), name
        assert codes(after) - codes(before) == {"UNSUPPORTED_EXTENSION"}, name


def test_an_unaligned_glb_is_mended(tmp_path: Path) -> None:
    text = level()
    unaligned = glb(text + b" " * (-len(text) % 4) + b" ")
    (tmp_path / "before.glb").write_bytes(unaligned)
    (tmp_path / "after.glb").write_bytes(annotate(unaligned, {0: ADVICE}))
    before, after = reports([(tmp_path / "before.glb", tmp_path), (tmp_path / "after.glb", tmp_path)])
    assert complaints(before)
    assert complaints(after) == Counter()


def test_the_validator_would_notice_a_missing_declaration(tmp_path: Path) -> None:
    undeclared = annotate(level(), {0: ADVICE}).replace(b',"' + EXTENSION.encode() + b'"]', b"]")
    (tmp_path / "undeclared.gltf").write_bytes(undeclared)
    (report,) = reports([(tmp_path / "undeclared.gltf", tmp_path)])
    assert "UNDECLARED_EXTENSION" in {code for code, _, _ in complaints(report)}
    assert report["issues"]["numErrors"] > 0
