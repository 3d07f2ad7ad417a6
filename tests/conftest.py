"""Fixtures that tests of several folders share."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from OpenGL import GL

from renderers.context import Gpu

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
    "DRAW_INDIRECT_BUFFER_BINDING",
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


@pytest.fixture(scope="session")
def gpu() -> Iterator[Gpu]:
    """A context on the first device, for the whole run.

    Contract, kept by `_clean_gpu` around every test that asks for it: it is current, OpenGL has recorded no
    error before or after, and the state that passes share is as it was when the context was made.
    """
    with Gpu() as made:
        # Attributes of no object carry the state that moderngl itself sets up on first use.
        made.release()
        yield made


@pytest.fixture(scope="session")
def _fresh_state(gpu: Gpu) -> dict[str, object]:
    with gpu.ctx:
        return gl_state()


@pytest.fixture(autouse=True)
def _clean_gpu(request: pytest.FixtureRequest) -> Iterator[None]:
    if "gpu" not in request.fixturenames:
        yield
        return
    gpu: Gpu = request.getfixturevalue("gpu")
    fresh = request.getfixturevalue("_fresh_state")
    # A test that makes another context takes the current one's place: enter ours, and stay in.
    gpu.ctx.__enter__()
    assert gpu.ctx.error == "GL_NO_ERROR", "an earlier test left an OpenGL error behind"
    yield
    gpu.ctx.__enter__()
    assert gpu.ctx.error == "GL_NO_ERROR", "the test left an OpenGL error behind"
    gpu.release()
    assert gl_state() == fresh, "the test left OpenGL state behind"
