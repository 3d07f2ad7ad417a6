from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import api.client

FOLDER = Path(api.client.__file__).parent


def test_it_needs_nothing_but_python() -> None:
    found = set()
    for path in FOLDER.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                assert node.module
                found.add(node.module.partition(".")[0])
    assert found <= sys.stdlib_module_names


def test_a_copy_works_under_another_name(tmp_path: Path) -> None:
    copy = tmp_path / "bundled"
    copy.mkdir()
    for path in FOLDER.glob("*.py"):
        (copy / path.name).write_bytes(path.read_bytes())
    code = "from bundled.waiting import wait_for_job; from bundled.service import Service; Service()"
    subprocess.run(
        [sys.executable, "-I", "-c", f"import sys; sys.path.insert(0, '.'); {code}"], cwd=tmp_path, check=True
    )
