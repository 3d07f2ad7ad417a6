"""The OpenGL state that passes share, and the objects that are alive."""

from __future__ import annotations

import numpy as np
from OpenGL import GL

SWITCHES = (
    "DEPTH_TEST",
    "BLEND",
    "DEPTH_CLAMP",
    "POLYGON_OFFSET_FILL",
    "SCISSOR_TEST",
    "CULL_FACE",
    "STENCIL_TEST",
    "COLOR_LOGIC_OP",
    "RASTERIZER_DISCARD",
    "PRIMITIVE_RESTART",
)
VALUES = (
    "POLYGON_OFFSET_FACTOR",
    "POLYGON_OFFSET_UNITS",
    "COLOR_WRITEMASK",
    "DEPTH_WRITEMASK",
    "CLIP_ORIGIN",
    "CLIP_DEPTH_MODE",
    "FRONT_FACE",
    "POLYGON_MODE",
)
TEXTURE_UNITS = 8


def gl_state() -> dict[str, object]:
    """What a pass has to leave as it found it.

    Depth and blend functions, the program and the framebuffer are not here: whoever draws sets them.
    """
    state: dict[str, object] = {name: bool(GL.glIsEnabled(getattr(GL, f"GL_{name}"))) for name in SWITCHES}
    for name in VALUES:
        state[name] = np.ravel(GL.glGetFloatv(getattr(GL, f"GL_{name}"))).tolist()
    active = GL.glGetIntegerv(GL.GL_ACTIVE_TEXTURE)
    for unit in range(TEXTURE_UNITS):
        GL.glActiveTexture(GL.GL_TEXTURE0 + unit)
        state[f"sampler {unit}"] = int(GL.glGetIntegerv(GL.GL_SAMPLER_BINDING))
    GL.glActiveTexture(active)
    return state


KINDS = {
    "textures": (GL.glGenTextures, GL.glDeleteTextures, GL.glIsTexture),
    "buffers": (GL.glGenBuffers, GL.glDeleteBuffers, GL.glIsBuffer),
    "framebuffers": (GL.glGenFramebuffers, GL.glDeleteFramebuffers, GL.glIsFramebuffer),
    "vertex arrays": (GL.glGenVertexArrays, GL.glDeleteVertexArrays, GL.glIsVertexArray),
    "samplers": (GL.glGenSamplers, GL.glDeleteSamplers, GL.glIsSampler),
}
NAMES_BEYOND = 256
"""A driver may hand out names that were free again: look a little beyond the newest."""


def live_objects() -> dict[str, int]:
    """How many objects of each kind are alive."""
    alive = {}
    for kind, (generate, delete, exists) in KINDS.items():
        newest = int(generate(1))
        delete(1, [newest])
        alive[kind] = sum(bool(exists(name)) for name in range(1, newest + NAMES_BEYOND))
    return alive
