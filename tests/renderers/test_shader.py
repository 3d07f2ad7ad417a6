from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from importlib.resources import files
from pathlib import Path

import pytest
from OpenGL import GL

from renderers import shader
from renderers.context import Gpu
from renderers.shader import ShaderError

Write = Callable[..., None]

SECTIONS = [
    (resource.name, section)
    for resource in sorted(files("renderers").iterdir(), key=lambda item: item.name)
    if resource.name.endswith(".glsl")
    for section in re.findall(r"^\s*#section\s+(\w+)", resource.read_text(encoding="utf-8"), re.MULTILINE)
]


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Write]:
    """Puts shader files where the loader looks, instead of the package's own."""

    def put(**texts: str) -> None:
        for name, text in texts.items():
            (tmp_path / f"{name}.glsl").write_text(text, encoding="utf-8")

    monkeypatch.setattr(shader, "files", lambda _: tmp_path)
    shader.source.cache_clear()
    yield put
    shader.source.cache_clear()


def stage_of(text: str) -> int:
    """Which stage a whole shader is for."""
    if "local_size_x" in text:
        return int(GL.GL_COMPUTE_SHADER)
    # Mesa's cache says yes to what it has compiled once, whatever the stage: a wrong one fails now and then.
    if "EmitVertex" in text:
        return int(GL.GL_GEOMETRY_SHADER)
    return int(GL.GL_VERTEX_SHADER if "gl_Position" in text else GL.GL_FRAGMENT_SHADER)


@pytest.mark.parametrize(("file", "section"), SECTIONS)
@pytest.mark.usefixtures("gpu")
def test_every_section_of_the_package_compiles(file: str, section: str) -> None:
    source = shader.source(file, section)
    compiled = GL.glCreateShader(stage_of(source.text))
    GL.glShaderSource(compiled, source.text)
    GL.glCompileShader(compiled)
    status = GL.glGetShaderiv(compiled, GL.GL_COMPILE_STATUS)
    log = GL.glGetShaderInfoLog(compiled)
    GL.glDeleteShader(compiled)
    assert status, source.explain(log.decode() if isinstance(log, bytes) else str(log))


def test_the_package_has_sections_to_compile() -> None:
    assert {"surface_vertex", "visibility", "face_signs"} <= {section for _, section in SECTIONS}


def test_a_section_takes_what_stands_before_the_first_and_nothing_of_the_others(write: Write) -> None:
    write(a="shared\n#section one\nfirst\n#section two\nsecond\n")
    text = shader.source("a.glsl", "two").text
    assert "shared" in text
    assert "second" in text
    assert "first" not in text
    assert text.startswith("#version 450 core\n")


def test_a_file_that_is_included_twice_appears_once(write: Write) -> None:
    write(
        a='#include "b.glsl"\n#include "c.glsl"\n#section s\nend\n',
        b='#include "c.glsl"\nfrom_b\n',
        c="from_c\n",
    )
    text = shader.source("a.glsl", "s").text
    assert text.count("from_c") == 1
    assert text.index("from_c") < text.index("from_b") < text.index("end")


def test_includes_that_run_in_a_circle_end(write: Write) -> None:
    write(a='#include "b.glsl"\n#section s\nx\n', b='#include "a.glsl"\ny\n')
    assert shader.source("a.glsl", "s").text.count("y\n") == 1


def test_sections_of_an_included_file_can_be_asked_for(write: Write) -> None:
    write(a='#include "b.glsl"\nshared\n#section s\nx\n', b="before\n")
    assert "before" in shader.source("a.glsl", "s").text


def test_a_missing_file_include_or_section_is_named(write: Write) -> None:
    write(a='\n#include "gone.glsl"\n#section s\n', b="#section s\n")
    with pytest.raises(ShaderError, match=r'a\.glsl:2: .*"gone\.glsl"'):
        shader.source("a.glsl", "s")
    with pytest.raises(ShaderError, match=r"b\.glsl: .*#section other"):
        shader.source("b.glsl", "other")
    with pytest.raises(ShaderError, match=r"none\.glsl"):
        shader.source("none.glsl", "s")


@pytest.mark.parametrize("fault", ["nonsense;", "int a = ;", "int a = 1.0;", "none(1);"])
def test_an_error_in_an_include_names_the_include_and_its_line(gpu: Gpu, write: Write, fault: str) -> None:
    write(
        outer='// one\n#include "inner.glsl"\n#section s\nlayout(local_size_x = 1) in;\n'
        "void main() { f(); }\n",
        inner=f"// one\n// two\nvoid f() {{ {fault} }}\n",
    )
    with pytest.raises(ShaderError) as caught:
        shader.compute(gpu, shader.source("outer.glsl", "s"))
    assert "inner.glsl:3" in str(caught.value)
    assert "outer.glsl:" not in str(caught.value)
    assert caught.value.exit_code == 4


def test_an_error_after_an_include_names_the_including_file_and_its_line(gpu: Gpu, write: Write) -> None:
    write(
        outer='#include "inner.glsl"\n\n#section other\nx\n#section s\nlayout(local_size_x = 1) in;\n'
        "void main() {\n    wrong_here;\n}\n",
        inner="int fine;\n\n\n",
    )
    with pytest.raises(ShaderError) as caught:
        shader.compute(gpu, shader.source("outer.glsl", "s"))
    assert "outer.glsl:8" in str(caught.value)


def test_an_error_in_a_fragment_shader_is_not_put_down_to_the_vertex_shader(gpu: Gpu, write: Write) -> None:
    write(
        v="#section s\nvoid main() { gl_Position = vec4(0.0); }\n",
        f="\n#section s\nout vec4 c;\nvoid main() { c = broken; }\n",
    )
    with pytest.raises(ShaderError, match=r"f\.glsl:4"):
        shader.program(gpu, shader.source("v.glsl", "s"), shader.source("f.glsl", "s"))
    write(w="#section s\n\nvoid main() { gl_Position = lost; }\n")
    with pytest.raises(ShaderError, match=r"w\.glsl:3"):
        shader.program(gpu, shader.source("w.glsl", "s"), shader.source("f.glsl", "s"))


def test_programs_are_made_once_for_a_context(gpu: Gpu) -> None:
    pair = (
        shader.source("geometry_buffer.glsl", "surface_vertex"),
        shader.source("geometry_buffer.glsl", "surface_fragment"),
    )
    assert shader.program(gpu, *pair) is shader.program(gpu, *pair)


def test_other_drivers_ways_to_name_a_place_are_understood() -> None:
    source = shader.Source("", ("a.glsl:0", "a.glsl:1", "b.glsl:8"))
    assert source.explain("0:3(14): error: x") == "b.glsl:8: error: x"
    assert source.explain("0(2) : error C1008: y") == "a.glsl:1 : error C1008: y"
    assert source.explain("0:9(1): error") == "0:9(1): error"
