"""Times of devices that are not here: exact work counts over a device's rates.

A roofline for each stage (Williams, Waterman and Patterson 2009): a fixed time a pass, and the slowest of
vertices, fragments and memory. docs/virtual-devices.md has the formula, the sources of the coefficients, and
what the model leaves out. Such times are never measured, and the device's record says so.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from renderers.map_settings import TAPS
from renderers.settings import Setting
from scenes.errors import GnomonError
from scenes.scene import Array, Mobility
from selector.evidence.rows import CandidateRow, DeviceRow
from selector.evidence.table import EvidenceTable

PREFIX = "virtual:"
"""Before a virtual device's name where any device may be named."""

_BYTES = 4
"""Of a texel of depth, of a pixel of depth, normal or mask, of a count."""

_TEXELS_READ = 2
"""Depth and normal, by every pixel that compares."""


class UnknownVirtualDeviceError(GnomonError):
    """No virtual device has this name."""

    exit_code = 2


@dataclass(frozen=True)
class VirtualDevice:
    """Rates of a device, all per second.

    Attributes:
        name: How it is called after `virtual:`.
        title: What it stands for.
        pass_s: Fixed time of a pass, seconds: set-up, and the pipeline running dry.
        triangles: Triangles transformed and set up.
        faces: Faces looked at for silhouettes.
        depth_fragments: Fragments that only test or write depth or stencil.
        count_fragments: Fragments that are counted into a volume target.
        pixels: Pixels of a full-screen pass.
        texels: Bilinear texture reads.
        bytes: Of external memory.
        bytes_per_count: Memory traffic of a counted fragment.
        stores_tiles: Whether a target is written to memory once, when its tiles are done, whatever was drawn.
    """

    name: str
    title: str
    pass_s: float
    triangles: float
    faces: float
    depth_fragments: float
    count_fragments: float
    pixels: float
    texels: float
    bytes: float
    bytes_per_count: float
    stores_tiles: bool = False

    @property
    def row(self) -> DeviceRow:
        """As the store keeps it; its times are marked as those of no clock."""
        return DeviceRow(self.title, "", "", clock="none", virtual=f"{PREFIX}{self.name}")

    def stages_ms(
        self, candidate: CandidateRow, counters: Mapping[str, Array], pixels: Array, mobility: Mobility
    ) -> dict[str, Array]:
        """Stage -> (n,) float64 milliseconds of one candidate for n instances.

        Args:
            candidate: A technique with settings.
            counters: Name -> (n,) counts, as the technique's pass gives them; nan where nobody counted.
            pixels: (n,) pixels of each view.
            mobility: A static light keeps what does not depend on the camera.
        """
        work = _Work(self, candidate.settings, counters, pixels)
        return {name: 1e3 * seconds for name, seconds in work.stages(mobility).items()}

    def shadow_ms(self, table: EvidenceTable, mobility: Mobility) -> Array:
        """(n, k) float64 milliseconds of the technique's own stages; nan where nobody counted."""
        pixels = np.array([float(one.width * one.height) for one in table.instances])
        found = np.full(table.status.shape, np.nan)
        for column, candidate in enumerate(table.candidates):
            counters = {name: values[:, column] for name, values in table.counters.items()}
            stages = self.stages_ms(candidate, counters, pixels, mobility)
            if stages:
                found[:, column] = np.sum(list(stages.values()), axis=0)
        return found


@dataclass(frozen=True)
class _Work:
    """What one candidate does in n views, in seconds on a device. Which stages it has, its counts say."""

    device: VirtualDevice
    settings: Mapping[str, Setting]
    counters: Mapping[str, Array]
    pixels: Array

    def stages(self, mobility: Mobility) -> dict[str, Array]:
        """Stage -> (n,) seconds; empty where nothing was counted."""
        has_map, has_volumes = self._has("map_texels_cleared"), self._has("volume_fragments")
        hybrid = self._has("silhouette_pixels")
        moves = mobility is Mobility.DYNAMIC
        found: dict[str, Array] = {}
        # A map that does not follow the view is kept.
        if has_map and (moves or self.settings.get("focus") != "light"):
            found["map"] = self._map()
        if hybrid:
            found["silhouette_pixels"] = self._full_screen(_TEXELS_READ + self._kernel_reads())
            found["computation_mask"] = self._faces(self._count("volume_triangles"))
        if has_volumes:
            if moves:
                found["edges"] = self._faces(self._count("cap_triangles"))
            found["volumes"] = self._volumes()
        if has_map or has_volumes:
            reads = _TEXELS_READ + self._filter_reads() if has_map and not hybrid else 1
            found["visibility"] = self._full_screen(reads)
        return found

    def _map(self) -> Array:
        device, cleared = self.device, self._count("map_texels_cleared")
        written = self._count("map_texels_written")
        side = float(self.settings.get("map_size", 1))
        traffic = cleared if device.stores_tiles else written
        slowest = np.maximum.reduce(
            [
                self._count("map_triangles") / device.triangles,
                written / device.depth_fragments,
                _BYTES * traffic / device.bytes,
            ]
        )
        seconds: Array = np.ceil(cleared / (side * side)) * device.pass_s + slowest
        return seconds

    def _faces(self, faces: Array) -> Array:
        return self.device.pass_s + faces / self.device.faces

    def _volumes(self) -> Array:
        device, counted = self.device, self._count("volume_fragments_counted")
        sides, caps = 2 * self._count("silhouette_edges"), self._count("cap_triangles")
        triangles = self._count("volume_triangles") if self._has("volume_triangles") else caps + sides
        target = _BYTES * self.pixels * (1 if device.stores_tiles else 0)
        slowest = np.maximum.reduce(
            [
                triangles / device.triangles,
                (self._count("volume_fragments") - counted) / device.depth_fragments
                + counted / device.count_fragments,
                (device.bytes_per_count * counted + target) / device.bytes,
            ]
        )
        seconds: Array = device.pass_s + slowest
        return seconds

    def _full_screen(self, reads: float) -> Array:
        """A pass that reads so many texels in each pixel and writes one."""
        device = self.device
        slowest = np.maximum.reduce(
            [
                self.pixels / device.pixels,
                self.pixels * reads / device.texels,
                # Texels of a map beside each other are read from the cache.
                _BYTES * self.pixels * (_TEXELS_READ + 1) / device.bytes,
            ]
        )
        seconds: Array = device.pass_s + slowest
        return seconds

    def _filter_reads(self) -> float:
        """Comparisons that the hardware filters by itself: side by side, one, four or nine."""
        return max(TAPS[str(self.settings.get("filter", "1x1"))], 1) ** 2

    def _kernel_reads(self) -> float:
        """Raw texels that must agree."""
        side = int(str(self.settings.get("kernel", "2x2"))[0])
        return side * side

    def _has(self, name: str) -> bool:
        return name in self.counters and bool(np.isfinite(self.counters[name]).any())

    def _count(self, name: str) -> Array:
        unknown: Array = np.full(self.pixels.shape, np.nan)
        return self.counters.get(name, unknown)


VIRTUAL_DEVICES: tuple[VirtualDevice, ...] = (
    VirtualDevice(
        "fill-bound-2005",
        "A fill-bound card of 2005, after the GeForce 6800 Ultra",
        pass_s=25e-6,
        triangles=200e6,
        faces=50e6,
        depth_fragments=12.8e9,
        count_fragments=12.8e9,
        pixels=6.4e9,
        texels=6.4e9,
        bytes=35.2e9,
        bytes_per_count=8.0,
    ),
    VirtualDevice(
        "desktop",
        "A desktop GPU of 2023, after the GeForce RTX 4070",
        pass_s=5e-6,
        triangles=9.9e9,
        faces=9.9e9,
        depth_fragments=158.4e9,
        count_fragments=158.4e9,
        pixels=158.4e9,
        texels=455.4e9,
        bytes=504e9,
        bytes_per_count=0.0,
    ),
    VirtualDevice(
        "phone",
        "A phone of 2021, after the Mali-G78 MP20",
        pass_s=50e-6,
        triangles=0.848e9,
        faces=0.848e9,
        depth_fragments=33.92e9,
        count_fragments=33.92e9,
        pixels=33.92e9,
        texels=67.84e9,
        bytes=51.2e9,
        bytes_per_count=0.0,
        stores_tiles=True,
    ),
)


def virtual_device(name: str) -> VirtualDevice:
    """The virtual device of this name, with or without `virtual:` before it.

    Raises:
        UnknownVirtualDeviceError: There is none; the message lists those there are.
    """
    for known in VIRTUAL_DEVICES:
        if name.removeprefix(PREFIX) == known.name:
            return known
    names = ", ".join(f"{PREFIX}{one.name}" for one in VIRTUAL_DEVICES)
    raise UnknownVirtualDeviceError(f'There is no virtual device "{name}".', known=f"Known: {names}.")
