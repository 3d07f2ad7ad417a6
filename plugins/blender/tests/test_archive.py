"""The zip that is installed."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import bpy

ROOT = Path(__file__).parents[3]


def test_blender_s_own_check_accepts_it(archive: Path) -> None:
    check = Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core/bl_pkg/cli/blender_ext.py"
    done = subprocess.run(
        [sys.executable, check, "validate", archive], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout
    assert "Success" in done.stdout


def test_the_same_sources_give_the_same_bytes(archive: Path, tmp_path: Path) -> None:
    subprocess.run(
        [sys.executable, ROOT / "plugins/blender/build.py", tmp_path], check=True, stdout=subprocess.PIPE
    )
    assert (tmp_path / archive.name).read_bytes() == archive.read_bytes()


def test_it_holds_the_client_as_it_is(archive: Path) -> None:
    with zipfile.ZipFile(archive) as opened:
        for path in (ROOT / "api/client").glob("*.py"):
            assert opened.read(f"client/{path.name}") == path.read_bytes()
        assert {"__init__.py", "blender_manifest.toml", "LICENSE"} <= set(opened.namelist())
