"""GLSL from package data: includes, named sections, and errors that name file and line.

A file may hold several shaders. `#section NAME` starts one; what stands before the first section belongs to
all of them. `#include "file.glsl"` takes a neighbour in, once. Every line keeps its own file and number.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import TypeVar

import moderngl

from renderers.context import Gpu
from scenes.errors import DeviceError

Built = TypeVar("Built")

HEADER = "#version 450 core\n"
_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"\s*$')
_SECTION = re.compile(r"^\s*#section\s+(\w+)\s*$")
# Mesa writes "2:14(3): error", NVIDIA "2(14) : error": string number, then line.
_LOCATION = re.compile(r"\b(\d+)(?::(\d+)\(\d+\)|\((\d+)\))(?=\s*:)")


class ShaderError(DeviceError):
    """GLSL that the driver refuses; ours to mend, or the driver's."""


@dataclass(frozen=True)
class Line:
    """One line of GLSL and where it stands."""

    file: int
    number: int
    text: str


@dataclass(frozen=True)
class Source:
    """One shader's full text, and the files whose numbers its `#line` directives carry."""

    text: str
    names: tuple[str, ...]

    def explain(self, log: str) -> str:
        """The driver's log with string numbers replaced by file names."""

        def name(match: re.Match[str]) -> str:
            number = int(match[1])
            file = self.names[number] if number < len(self.names) else f"string {number}"
            return f"{file}:{match[2] or match[3]}"

        return _LOCATION.sub(name, log)


@lru_cache
def source(file: str, section: str) -> Source:
    """The text of `section` in `file` with what it shares, includes resolved.

    Raises:
        ShaderError: The file, an include or the section is missing.
    """
    names: list[str] = []
    shared: list[Line] = []
    own: list[Line] | None = None
    current = ""
    for line in _expand(file, names, where=file):
        if started := _SECTION.match(line.text):
            current = started[1]
            own = [] if current == section else own
        elif not current:
            shared.append(line)
        elif current == section and own is not None:
            own.append(line)
    if own is None:
        raise ShaderError(f'There is no "#section {section}".', where=file)
    return Source(HEADER + _join([*shared, *own]), tuple(names))


def program(gpu: Gpu, vertex: Source, fragment: Source) -> moderngl.Program:
    """A linked program; cached for the life of the context.

    Raises:
        ShaderError: The driver refuses it; the message names file and line.
    """

    def build() -> moderngl.Program:
        return gpu.ctx.program(vertex_shader=vertex.text, fragment_shader=fragment.text)

    return gpu.cached((vertex, fragment), lambda: _explained(build, (vertex, fragment)))


def full_screen(gpu: Gpu, fragment: Source) -> moderngl.VertexArray:
    """A pass that runs `fragment` once for every pixel of the viewport; render 3 vertices."""
    return gpu.ctx.vertex_array(program(gpu, source("full_screen.glsl", "full_screen"), fragment), [])


def compute(gpu: Gpu, stage: Source) -> moderngl.ComputeShader:
    """A compute shader; cached for the life of the context.

    Raises:
        ShaderError: The driver refuses it; the message names file and line.
    """
    return gpu.cached(stage, lambda: _explained(lambda: gpu.ctx.compute_shader(stage.text), (stage,)))


def _expand(file: str, names: list[str], where: str) -> list[Line]:
    if file in names:
        return []
    resource = files("renderers") / file
    if not resource.is_file():
        raise ShaderError(f'There is no shader file "{file}".', where=where)
    names.append(file)
    index = len(names) - 1
    lines: list[Line] = []
    for number, text in enumerate(resource.read_text(encoding="utf-8").splitlines(), start=1):
        if included := _INCLUDE.match(text):
            lines += _expand(included[1], names, where=f"{file}:{number}")
        else:
            lines.append(Line(index, number, text))
    return lines


def _join(lines: list[Line]) -> str:
    parts: list[str] = []
    expected = (-1, -1)
    for line in lines:
        if (line.file, line.number) != expected:
            parts.append(f"#line {line.number} {line.file}")
        parts.append(line.text)
        expected = (line.file, line.number + 1)
    return "\n".join(parts) + "\n"


def _explained(build: Callable[[], Built], stages: tuple[Source, ...]) -> Built:
    try:
        return build()
    except moderngl.Error as error:
        log = str(error)
        stage = stages[1] if len(stages) > 1 and "fragment" in log.lower() else stages[0]
        raise ShaderError(
            "The driver refused a shader.", where=", ".join(stage.names), known=stage.explain(log)
        ) from error
