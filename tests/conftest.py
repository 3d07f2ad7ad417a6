"""Fixtures that tests of several folders share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import settings

from renderers.context import Gpu
from tests.gl_state import gl_state

# How long an example takes says how busy the machine is.
settings.register_profile("gnomon", deadline=None)
settings.load_profile("gnomon")


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
