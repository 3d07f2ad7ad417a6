"""The one place that makes a GL context, and says on which device it runs.

Clip space is z in [0, 1] everywhere (ARB_clip_control). Cameras use reversed depth with the far plane at
infinity, 32-bit float: a point at infinity has depth exactly 0, so volumes extruded to infinity need no
depth clamp, and relative precision is the same near and far (Reed 2015, "Depth precision visualized").
Light maps use reversed depth too, between two planes.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from types import TracebackType
from typing import Any, Protocol, Self, TypeVar

# PyOpenGL picks its platform when it is first imported.
os.environ.setdefault("PYOPENGL_PLATFORM", "egl")

import moderngl
from OpenGL import EGL, GL
from OpenGL.error import GLError

from scenes.errors import DeviceError

REQUIRED_GL = 450
DEPTH_CLAMP = 0x864F

Made = TypeVar("Made")


@dataclass(frozen=True)
class DeviceLimits:
    """What the device has room for."""

    max_texture_side: int
    max_buffer_bytes: int


@dataclass(frozen=True)
class Device:
    """The record of a device that goes with every measurement."""

    index: int
    renderer: str
    vendor: str
    gl_version: str
    glsl_version: str
    software: bool
    limits: DeviceLimits

    def as_dict(self) -> dict[str, object]:
        """The record as plain JSON values."""
        return asdict(self)


class Released(Protocol):
    """A GL object."""

    def release(self) -> None:
        """Delete it."""
        ...


class Gpu:
    """A headless GL context on one device; a context manager that ends it.

    Args:
        device: Index of the EGL device, part of the renderer's name, or None for the first that works.

    Raises:
        DeviceError: No such device, or it lacks OpenGL 4.5.
    """

    def __init__(self, device: str | int | None = None) -> None:
        self.ctx, self.device = _open(device)
        GL.glClipControl(GL.GL_LOWER_LEFT, GL.GL_ZERO_TO_ONE)
        # Objects that Python collects wait until this context is surely current: names of objects are small
        # numbers in every context, and one that is deleted late would take another context's with it.
        self.ctx.gc_mode = "context_gc"
        self._cache: dict[object, Any] = {}
        self._parked = self.ctx.simple_framebuffer((1, 1))

    def __enter__(self) -> Self:
        """The context itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the context, and what it made for itself."""
        for made in (self._parked, *self._cache.values()):
            if hasattr(made, "release"):
                made.release()
        self._cache.clear()
        self.ctx.release()

    def cached(self, key: object, make: Callable[[], Made]) -> Made:
        """What `make` gave for `key` the first time: compiled programs live as long as their context."""
        if key not in self._cache:
            self._cache[key] = make()
        made: Made = self._cache[key]
        return made

    def release(self, *owned: Released) -> None:
        """Give the memory of `owned` back.

        moderngl binds the last used framebuffer again after making an object: it must not be a deleted one.
        """
        self._parked.use()
        for resource in owned:
            resource.release()
        # moderngl's own gc() stumbles over what was released before Python collected it.
        while self.ctx.objects:
            collected = self.ctx.objects.popleft()
            if hasattr(collected, "release"):
                collected.release()

    def check(self, where: str) -> None:
        """Raise a `GlError` if GL has recorded an error since the last check."""
        error = self.ctx.error
        if error != "GL_NO_ERROR":
            raise _failure(f"OpenGL reported {error}.", where, self.device)

    @contextmanager
    def guard(self, where: str) -> Iterator[None]:
        """Turn whatever GL and its wrappers raise in the block, or record, into a `GlError`.

        However the block is left early, the next pass finds the state that it expects: a depth clamp left on
        by a failed shadow map would falsify the shadow volumes that come after it.
        """
        try:
            yield
        except (moderngl.Error, GLError) as error:
            self._reset()
            raise _failure(str(error), where, self.device) from error
        except BaseException:
            self._reset()
            raise
        self.check(where)

    def _reset(self) -> None:
        self.ctx.clear_errors()
        self.ctx.enable_only(moderngl.NOTHING)
        self.ctx.disable_direct(DEPTH_CLAMP)
        self.ctx.polygon_offset = (0.0, 0.0)

    def buffer_texture(self, buffer: moderngl.Buffer) -> int:
        """Name of a texture that reads `buffer` as pairs of 32-bit unsigned integers."""
        name = int(GL.glGenTextures(1))
        GL.glBindTexture(GL.GL_TEXTURE_BUFFER, name)
        GL.glTexBuffer(GL.GL_TEXTURE_BUFFER, GL.GL_RG32UI, buffer.glo)
        return name

    def depth_texture(self, width: int, height: int) -> moderngl.Texture:
        """An uninitialised depth texture of 32-bit floats, compared on request only."""
        texture = self.ctx.depth_texture((width, height))
        texture.compare_func = ""
        # moderngl only knows 24 bits: give the same texture object another storage.
        GL.glBindTexture(GL.GL_TEXTURE_2D, texture.glo)
        size = (width, height, 0)
        GL.glTexImage2D(
            GL.GL_TEXTURE_2D, 0, GL.GL_DEPTH_COMPONENT32F, *size, GL.GL_DEPTH_COMPONENT, GL.GL_FLOAT, None
        )
        return texture


class GlError(DeviceError):
    """OpenGL reported an error."""


class OutOfVideoMemoryError(GlError):
    """The device has no memory left."""


def devices() -> Iterator[Device]:
    """Every EGL device on which a context with OpenGL 4.5 can be made, in EGL's order."""
    index = 0
    while (found := _look(index)) is not None:
        device, supported = found
        if supported:
            yield device
        index += 1


def _look(index: int) -> tuple[Device, bool] | None:
    # A new context takes the current one's place, and keeps it after its end: put the old one back.
    display, before = EGL.eglGetCurrentDisplay(), EGL.eglGetCurrentContext()
    surfaces = [EGL.eglGetCurrentSurface(which) for which in (EGL.EGL_DRAW, EGL.EGL_READ)]
    context = _try_context(index)
    if context is None:
        return None
    found = _record(context, index), context.version_code >= REQUIRED_GL
    context.release()
    # An ended context stays current until another is made: then there is nothing to put back.
    with suppress(GLError):
        EGL.eglMakeCurrent(display, *surfaces, before)
    return found


def _failure(what: str, where: str, device: Device) -> GlError:
    exhausted = "OUT_OF_MEMORY" in what or "out of memory" in what
    return (OutOfVideoMemoryError if exhausted else GlError)(what, where=where, known=device.renderer)


def _open(wanted: str | int | None) -> tuple[moderngl.Context, Device]:
    if isinstance(wanted, str) and not wanted.isdecimal():
        return _open_by_name(wanted)
    index = 0 if wanted is None else int(wanted)
    context = _try_context(index)
    if context is None:
        raise DeviceError(
            "No OpenGL context could be made.",
            where=f"EGL device {index}",
            known=_known(),
            remedy="`gnomon devices` lists what there is; `make setup` installs EGL and a driver.",
        )
    if context.version_code < REQUIRED_GL:
        raise DeviceError(
            f"OpenGL 4.5 is needed; this device has {context.info['GL_VERSION']}.",
            where=f"EGL device {index}",
            remedy="Choose another with --device.",
        )
    return context, _record(context, index)


def _open_by_name(name: str) -> tuple[moderngl.Context, Device]:
    for device in devices():
        if name.lower() in device.renderer.lower():
            return _open(device.index)
    raise DeviceError(
        f'No device has "{name}" in its name.',
        where="--device",
        known=_known(),
        remedy="`gnomon devices` lists them.",
    )


def _known() -> str:
    names = [f"{device.index}: {device.renderer}" for device in devices()]
    return f"Known devices: {'; '.join(names)}." if names else "EGL offers no usable device."


def _try_context(index: int) -> moderngl.Context | None:
    try:
        settings: dict[str, Any] = {"backend": "egl", "device_index": index}
        return moderngl.create_context(standalone=True, **settings)
    except Exception:  # noqa: BLE001  glcontext raises plain Exception for a device that is not there
        return None


def _record(context: moderngl.Context, index: int) -> Device:
    info = context.info
    renderer = str(info["GL_RENDERER"])
    return Device(
        index=index,
        renderer=renderer,
        vendor=str(info["GL_VENDOR"]),
        gl_version=str(info["GL_VERSION"]),
        glsl_version=str(GL.glGetString(GL.GL_SHADING_LANGUAGE_VERSION).decode()),
        software=any(word in renderer.lower() for word in ("llvmpipe", "softpipe", "swiftshader")),
        limits=DeviceLimits(
            max_texture_side=min(int(info["GL_MAX_TEXTURE_SIZE"]), *info["GL_MAX_VIEWPORT_DIMS"]),
            max_buffer_bytes=int(info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"]),
        ),
    )
