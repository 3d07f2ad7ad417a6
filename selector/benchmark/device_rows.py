"""The device of a benchmark as the store keeps it."""

from __future__ import annotations

import os
import platform
from pathlib import Path

from renderers.clock import ClockKind
from renderers.context import Device
from selector.evidence.rows import DeviceRow

THREADS_VARIABLE = "LP_NUM_THREADS"
_CPU_INFO = Path("/proc/cpuinfo")


def device_row(device: Device, clock: ClockKind, threads: int) -> DeviceRow:
    """The record of a device; the CPU and its threads belong to it where rendering is software.

    Args:
        device: Where something is measured.
        clock: How time is read there.
        threads: That a software renderer uses where times are taken. Errors and counters do not depend on
            it, so theirs are filed with the times of the same device.
    """
    return DeviceRow(
        renderer=device.renderer,
        vendor=device.vendor,
        gl_version=device.gl_version,
        clock=str(clock),
        processor=processor() if device.software else "",
        threads=threads if device.software else 0,
    )


def software_threads() -> int:
    """How many threads Mesa's software renderer takes where nobody limits it for our own sake."""
    said = os.environ.get(THREADS_VARIABLE, "")
    return int(said) if said.isdecimal() and int(said) else len(os.sched_getaffinity(0))


def processor() -> str:
    """The CPU's name, as the system tells it; empty where it does not."""
    try:
        lines = _CPU_INFO.read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()
