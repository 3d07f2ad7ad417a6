from __future__ import annotations

import json
import re

import moderngl
import pytest
from OpenGL import GL

from renderers.context import DEPTH_CLAMP, Gpu, OutOfVideoMemoryError, devices
from scenes.errors import DeviceError
from tests.gl_state import gl_state


def test_a_device_is_found_by_number_and_by_part_of_its_name(gpu: Gpu) -> None:
    word = max(re.findall(r"\w+", gpu.device.renderer), key=len)
    for wanted in (gpu.device.index, str(gpu.device.index), word, word.upper()):
        with Gpu(wanted) as found:
            assert found.device == gpu.device


@pytest.mark.parametrize("wanted", ["no such device", "99", 99])
def test_an_unknown_device_is_refused_with_those_there_are(gpu: Gpu, wanted: str | int) -> None:
    with pytest.raises(DeviceError) as caught:
        Gpu(wanted)
    assert str(wanted) in str(caught.value)
    assert gpu.device.renderer in str(caught.value)
    assert caught.value.remedy


def test_looking_for_devices_does_not_take_the_context_away(gpu: Gpu) -> None:
    kept = gpu.ctx.buffer(b"still here")
    assert gpu.device in list(devices())
    assert kept.read() == b"still here"
    with pytest.raises(DeviceError):
        Gpu("no such device")
    assert kept.read() == b"still here"
    for device in devices():
        assert kept.read() == b"still here", device
    kept.release()


def test_the_record_is_plain_and_complete(gpu: Gpu) -> None:
    record = gpu.device.as_dict()
    assert json.loads(json.dumps(record)) == record
    assert gpu.device.gl_version.startswith("4.")
    assert gpu.device.software == ("llvmpipe" in gpu.device.renderer)
    # What OpenGL 4.5 itself guarantees.
    assert gpu.device.limits.max_texture_side >= 16384
    assert gpu.device.limits.max_buffer_bytes >= 2**27


def test_a_depth_texture_keeps_small_depths(gpu: Gpu) -> None:
    texture = gpu.depth_texture(8, 4)
    target = gpu.ctx.framebuffer(depth_attachment=texture)
    target.use()
    target.clear(depth=1e-9)
    # Fixed point of 24 bits has steps of 6e-8; floating point keeps small values to seven digits.
    value = float(memoryview(texture.read()).cast("f")[0])
    gpu.release(target, texture)
    assert value == pytest.approx(1e-9, rel=1e-6)


def test_a_gl_error_is_raised_once_with_its_place(gpu: Gpu) -> None:
    def provoke() -> None:
        GL.glEnable(0xFFFF)

    with pytest.raises(DeviceError, match="the test"), gpu.guard("the test"):
        provoke()
    gpu.check("afterwards")


def test_running_out_of_memory_has_its_own_error(gpu: Gpu) -> None:
    message = "out of memory"
    with pytest.raises(OutOfVideoMemoryError), gpu.guard("here"):
        raise moderngl.Error(message)


def test_cached_things_are_made_once(gpu: Gpu) -> None:
    made: list[int] = []
    for _ in range(2):
        gpu.cached("test_cached_things", lambda: made.append(1) or "thing")
    assert made == [1]


def fail_with_everything_on(gpu: Gpu) -> None:
    with gpu.guard("the test"):
        gpu.ctx.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        gpu.ctx.enable_direct(DEPTH_CLAMP)
        gpu.ctx.polygon_offset = (1.1, 4.0)
        raise ZeroDivisionError


def test_a_failed_block_leaves_no_state_behind(gpu: Gpu) -> None:
    before = gl_state()
    with pytest.raises(ZeroDivisionError):
        fail_with_everything_on(gpu)
    assert gl_state() == before
