"""What is imported is this repository, and a wheel holds all of it."""

from __future__ import annotations

import tomllib
import zipfile
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest
from hatchling.builders.wheel import WheelBuilder

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PACKAGES = PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    folder = tmp_path_factory.mktemp("wheel")
    (path,) = WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"])
    return zipfile.ZipFile(path)


@pytest.mark.parametrize("name", PACKAGES)
def test_a_top_level_package_is_ours(name: str) -> None:
    spec = find_spec(name)
    assert spec is not None
    assert spec.origin == str(ROOT / name / "__init__.py")


def test_the_wheel_holds_every_module_shader_and_template(wheel: zipfile.ZipFile) -> None:
    sources = {
        path.relative_to(ROOT).as_posix()
        for package in PACKAGES
        for suffix in ("py", "glsl", "html", "css", "js", "glb", "svg")
        for path in (ROOT / package).rglob(f"*.{suffix}")
    }
    kinds = {Path(source).suffix for source in sources}
    assert kinds == {".py", ".glsl", ".html", ".css", ".js", ".glb", ".svg"}
    assert sources <= set(wheel.namelist())


def test_the_wheel_says_its_version(wheel: zipfile.ZipFile) -> None:
    metadata = f"gnomon-{PROJECT['project']['version']}.dist-info/METADATA"
    assert f"Version: {PROJECT['project']['version']}\n" in wheel.read(metadata).decode()


@pytest.mark.parametrize("target", PROJECT["project"]["scripts"].values())
def test_a_console_script_has_its_function(target: str) -> None:
    module, _, function = target.partition(":")
    assert callable(getattr(import_module(module), function))


def test_the_lock_names_every_dependency_and_no_place() -> None:
    lock = (ROOT / "requirements.lock").read_text()
    locked = {line.partition("==")[0] for line in lock.splitlines() if "==" in line}
    wanted = [
        *PROJECT["project"]["dependencies"],
        *PROJECT["project"]["optional-dependencies"]["dev"],
    ]
    assert {requirement.partition(">=")[0].lower() for requirement in wanted} <= locked, "run `make lock`"
    assert "://" not in lock
