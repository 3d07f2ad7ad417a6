"""Primitives that are compressed by Draco.

Source: KHR_draco_mesh_compression (Khronos). Decoded by DracoPy, in a process of its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
import weakref
from importlib.util import find_spec
from pathlib import Path
from typing import IO

import numpy as np
import numpy.typing as npt

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf import draco_process
from scenes.gltf.extensions import DRACO
from scenes.gltf.views import ViewReader

PACKAGE = "DracoPy"
EXTRA = "Install the extra: pip install 'gnomon[draco]'."
EXPORTED = "Export the level again, or switch off compression in the exporter's settings."

Decoded = tuple[npt.NDArray[np.float32], npt.NDArray[np.uint32]]


def require_draco(where: str) -> None:
    """Checks that Draco data can be decoded.

    Raises:
        LevelError: The package that does so is not installed.
    """
    if find_spec(PACKAGE) is None:
        raise LevelError(
            "This level is compressed by Draco, and what decodes it is not installed.",
            where=where,
            known=f"It uses {DRACO}, which the Python package {PACKAGE} reads.",
            remedy=f"{EXTRA} Or switch off compression in the exporter's settings.",
        )


class DracoReader:
    """Decodes the Draco data of one asset, by a process that starts with the first block and ends with it."""

    def __init__(self, views: ViewReader) -> None:
        self._views = views
        self._process: subprocess.Popen[bytes] | None = None

    def primitive(self, extension: Entry, vertex_count: int, corner_count: int, *, strip: bool) -> Decoded:
        """(v, 3) float32 positions and (t, 3) uint32 triangles, not yet checked against each other.

        Args:
            extension: The primitive's extension object.
            vertex_count: What the accessor of its positions states.
            corner_count: What the accessor of its indices states.
            strip: Whether these are the corners of a strip, from which Draco makes triangles, too.

        Raises:
            LevelError: DracoPy is not installed, the data is damaged, takes more memory or time than it may,
                or holds another number of vertices or triangles than the accessors state.
        """
        require_draco(extension.where)
        attribute = extension.child("attributes").integer("POSITION")
        if attribute > 0xFFFFFFFF:
            raise extension.child("attributes").wrong("POSITION", "below 4294967296")
        block = bytes(self._views.content(extension))
        try:
            vertices, triangles = self._asked(block, attribute, extension.where)
            fits = triangles + 2 <= corner_count if strip else 3 * triangles == corner_count
            if vertices == vertex_count and fits:
                return self._taken(vertices, triangles)
        except (BrokenPipeError, EOFError):
            self._stop()
            limit = f"{draco_process.MOST_BYTES:,} bytes and {draco_process.MOST_SECONDS} seconds"
            raise _undecodable(
                f"Decoding {len(block):,} bytes ended without a result; it may take {limit}.", extension.where
            ) from None
        # What was not asked for is not taken, however much it is.
        self._stop()
        raise LevelError(
            f"The Draco data holds {vertices:,} vertices and {triangles:,} triangles.",
            where=extension.where,
            known=f"The accessors state {vertex_count:,} vertices and {corner_count:,} indices.",
            remedy=EXPORTED,
        )

    def _asked(self, block: bytes, attribute: int, where: str) -> tuple[int, int]:
        requests, answers = self._pipes()
        requests.write(draco_process.REQUEST.pack(len(block), attribute) + block)
        requests.flush()
        vertices, second = draco_process.ANSWER.unpack(_received(answers, draco_process.ANSWER.size))
        if vertices == draco_process.REFUSED:
            raise _undecodable(f"{_received(answers, second).decode()}.", where)
        return vertices, second

    def _taken(self, vertices: int, triangles: int) -> Decoded:
        _, answers = self._pipes()
        positions = np.frombuffer(_received(answers, 12 * vertices), "<f4").reshape(-1, 3)
        return positions, np.frombuffer(_received(answers, 12 * triangles), "<u4").reshape(-1, 3)

    def _pipes(self) -> tuple[IO[bytes], IO[bytes]]:
        if self._process is None:
            command = [sys.executable, "-P", str(Path(draco_process.__file__))]
            self._process = subprocess.Popen(  # noqa: S603  our own file
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                # Its threads would reserve more memory than the process may have.
                env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
            )
            weakref.finalize(self, _end, self._process)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        return self._process.stdin, self._process.stdout

    def _stop(self) -> None:
        if self._process is not None:
            self._process.kill()
        self._process = None


def _end(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.communicate()


def _received(pipe: IO[bytes], count: int) -> bytes:
    content = pipe.read(count)
    if len(content) < count:
        raise EOFError
    return content


def _undecodable(known: str, where: str) -> LevelError:
    return LevelError("The Draco data cannot be decoded.", where=where, known=known, remedy=EXPORTED)
