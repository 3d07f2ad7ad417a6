"""GLSL from package data: includes, named sections, and errors that name file and line.

A file may hold several shaders. `#section NAME` starts one; what stands before the first section belongs to
all of them. `#include "file.glsl"` takes a neighbour in, once.

A table of lines says where an error stands; `#line` directives would not do, for Mesa 22 puts whatever it
finds after parsing down to string 0.
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

VERSION = "#version 450 core"
_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"\s*$')
_SECTION = re.compile(r"^\s*#section\s+(\w+)\s*$")
# Mesa writes "2:14(3): error", NVIDIA "2(14) : error": string number, then line.
_LOCATION = re.compile(r"\b\d+(?::(\d+)\(\d+\)|\((\d+)\))(?=\s*:)")


class ShaderError(DeviceError):
    """GLSL that the driver refuses; ours to mend, or the driver's."""


@dataclass(frozen=True)
class Line:
    """One line of GLSL and where it stands, as `file:number`."""

    place: str
    text: str


@dataclass(frozen=True)
class Source:
    """One shader's full text, and the place that each of its lines comes from."""

    text: str
    places: tuple[str, ...]

    @property
    def files(self) -> str:
        """The files that it was put together from."""
        return ", ".join(dict.fromkeys(place.split(":")[0] for place in self.places))

    def explain(self, log: str) -> str:
        """The driver's log with line numbers replaced by places."""

        def place(match: re.Match[str]) -> str:
            line = int(match[1] or match[2])
            return self.places[line - 1] if 0 < line <= len(self.places) else match[0]

        return _LOCATION.sub(place, log)


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
    lines = [Line(f"{file}:0", VERSION), *shared, *own]
    return Source("".join(f"{line.text}\n" for line in lines), tuple(line.place for line in lines))


def program(gpu: Gpu, vertex: Source, fragment: Source, geometry: Source | None = None) -> moderngl.Program:
    """A linked program; cached for the life of the context.

    Raises:
        ShaderError: The driver refuses it; the message names file and line.
    """

    def build() -> moderngl.Program:
        between = None if geometry is None else geometry.text
        return gpu.ctx.program(
            vertex_shader=vertex.text, fragment_shader=fragment.text, geometry_shader=between
        )

    stages = (vertex, fragment) if geometry is None else (vertex, fragment, geometry)
    return gpu.cached(stages, lambda: _explained(build, stages))


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
    lines: list[Line] = []
    for number, text in enumerate(resource.read_text(encoding="utf-8").splitlines(), start=1):
        if included := _INCLUDE.match(text):
            lines += _expand(included[1], names, where=f"{file}:{number}")
        else:
            lines.append(Line(f"{file}:{number}", text))
    return lines


def _explained(build: Callable[[], Built], stages: tuple[Source, ...]) -> Built:
    try:
        return build()
    except moderngl.Error as error:
        log = str(error)
        named = zip(("fragment", "geometry"), stages[1:], strict=False)
        stage = next((one for word, one in named if word in log.lower()), stages[0])
        raise ShaderError(
            "The driver refused a shader.", where=stage.files, known=stage.explain(log)
        ) from error
