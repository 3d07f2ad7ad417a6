"""Which version of the code drew something: a hash for each technique, and the commit of the whole.

The hash covers what decides a technique's pictures: its module, all that it imports from `renderers` and
`scenes` however indirectly, and the GLSL that these name. So a change elsewhere leaves what was measured
fresh, and a change here makes it stale by itself.
"""

from __future__ import annotations

import ast
import hashlib
import re
import shutil
import subprocess
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from pathlib import Path

import renderers
from renderers.registry import TECHNIQUES

ROOT = Path(renderers.__file__).parents[1]
PACKAGES = ("renderers", "scenes")
_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"', re.MULTILINE)
_SHADER = re.compile(r"\w+\.glsl")
_LONGEST_WAIT_S = 20.0


def code_versions() -> dict[str, str]:
    """Technique's id -> 32 hexadecimal digits, the same on every machine and Python."""
    return {one.name: code_version(type(one).__module__) for one in TECHNIQUES}


@cache
def code_version(module: str, root: Path = ROOT) -> str:
    """32 hexadecimal digits that stand for the text of every file that decides what a module draws."""
    sha = hashlib.sha256()
    for path in source_files(module, root):
        text = path.read_text(encoding="utf-8")
        sha.update(f"{path.relative_to(root).as_posix()}\0{len(text)}\0{text}".encode())
    return sha.hexdigest()[:32]


def source_files(module: str, root: Path = ROOT) -> tuple[Path, ...]:
    """The module's file, those that it imports from the project's packages, and their GLSL, in order.

    Imports are read from the text: nothing is run.
    """
    found: set[Path] = set()
    waiting = [_file(module, root)]
    while waiting:
        path = waiting.pop()
        if path is None or path in found:
            continue
        found.add(path)
        if path.suffix == ".glsl":
            waiting += [path.with_name(name) for name in _INCLUDE.findall(path.read_text(encoding="utf-8"))]
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        waiting += [_file(name, root) for name in _imported(tree)]
        waiting += [_shader(path, name) for name in _shaders(tree)]
    return tuple(sorted(found))


@cache
def commit(root: Path = ROOT) -> str:
    """The commit of the code, with a `+` where files differ; the version where there is no repository.

    A folder that merely lies in another's repository has no commit of its own.
    """
    head, top = _git(root, "rev-parse", "HEAD"), _git(root, "rev-parse", "--show-toplevel")
    if not head or Path(top) != root.resolve():
        return version("gnomon")
    return f"{head}+" if _git(root, "status", "--porcelain", "--", *PACKAGES, "selector") else head


def _git(root: Path, *arguments: str) -> str:
    """What git says; nothing where there is no git, or it refuses."""
    program = shutil.which("git")
    if program is None:
        return ""
    try:
        said = subprocess.run(  # noqa: S603  git itself, with words of ours
            [program, "-C", str(root), *arguments],
            capture_output=True,
            text=True,
            check=False,
            timeout=_LONGEST_WAIT_S,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return said.stdout.strip() if said.returncode == 0 else ""


def _imported(tree: ast.Module) -> Iterator[str]:
    """Modules that a module may import: of `from a import b` both `a` and `a.b`."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module
            yield from (f"{node.module}.{name.name}" for name in node.names)


def _file(module: str, root: Path) -> Path | None:
    if module.partition(".")[0] not in PACKAGES:
        return None
    path = root.joinpath(*module.split(".")).with_suffix(".py")
    return path if path.is_file() else None


def _shaders(tree: ast.Module) -> Iterator[str]:
    """Names of GLSL files among the texts of a module."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield from _SHADER.findall(node.value)


def _shader(path: Path, name: str) -> Path | None:
    beside = path.with_name(name)
    return beside if beside.is_file() else None
