"""The devices that can be rendered on, each with the clock that tells the truth on it."""

from __future__ import annotations

from dataclasses import dataclass

from renderers.clock import ClockKind, truthful_clock
from renderers.context import Device, Gpu, devices
from scenes.errors import DeviceError


@dataclass(frozen=True)
class ListedDevice:
    """A device, and how its time is told."""

    device: Device
    clock: ClockKind

    def record(self) -> dict[str, object]:
        """As JSON values."""
        return {**self.device.as_dict(), "clock": str(self.clock)}


def listed_devices() -> list[ListedDevice]:
    """Every device with OpenGL 4.5.

    Raises:
        DeviceError: There is none.
    """
    found = []
    for device in devices():
        with Gpu(device.index) as gpu:
            found.append(ListedDevice(device, truthful_clock(gpu)))
    if not found:
        raise DeviceError(
            "No device with OpenGL 4.5 was found.",
            where="EGL",
            remedy="Install EGL and a driver: `make setup` installs Mesa's software driver.",
        )
    return found
