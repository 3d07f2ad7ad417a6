"""One Blender for all tests: the extension is installed into it from its zip, as users do."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[3]
# Blender reads it once, when it is loaded.
RESOURCES = tempfile.TemporaryDirectory(prefix="gnomon-blender-")
os.environ["BLENDER_USER_RESOURCES"] = RESOURCES.name

import bpy  # noqa: E402  not before the variable is set

# isort: split
import addon_utils  # noqa: E402  bpy brings it along

NAME = "bl_ext.user_default.gnomon"


@pytest.fixture(scope="session")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("extension")
    command = [sys.executable, ROOT / "plugins/blender/build.py", folder]
    return Path(subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip())


@pytest.fixture(scope="session")
def installed(archive: Path) -> ModuleType:
    done = bpy.ops.extensions.package_install_files(
        filepath=str(archive), repo="user_default", enable_on_install=True
    )
    assert done == {"FINISHED"}
    return sys.modules[NAME]


@pytest.fixture
def gnomon(installed: ModuleType) -> Iterator[ModuleType]:
    """The extension, switched on in an empty file."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    if not addon_utils.check(NAME)[1]:
        addon_utils.enable(NAME, default_set=True)
    preferences = bpy.context.preferences.addons[NAME].preferences
    for name in ("url", "token", "policy", "timeout_s"):
        preferences.property_unset(name)
    yield installed
    session = sys.modules[f"{NAME}.session"]
    session.shut_down()
