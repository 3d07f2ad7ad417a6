"""Draws runs of consecutive faces of an index buffer by one indirect call."""

from __future__ import annotations

import moderngl
import numpy as np

from renderers.context import Gpu
from scenes.clusters import Runs

COMMAND_WORDS = 5


class RunDrawer:
    """A vertex array and the command buffer that picks runs of its faces.

    Each command carries its first face as base instance: `gl_PrimitiveID` starts anew at every command.
    """

    def __init__(self, gpu: Gpu, vertex_array: moderngl.VertexArray, clusters: int) -> None:
        self._gpu, self._vertex_array = gpu, vertex_array
        most_runs = max(1, (clusters + 1) // 2)
        self._commands = gpu.ctx.buffer(reserve=4 * COMMAND_WORDS * most_runs, dynamic=True)

    def release(self) -> None:
        """Give the GPU memory back."""
        self._gpu.release(self._vertex_array, self._commands)

    def draw(self, runs: Runs) -> None:
        """Draw the faces of (r, 2) runs: first face and count."""
        if not len(runs):
            return
        commands = np.zeros((len(runs), COMMAND_WORDS), np.uint32)
        commands[:, 0] = 3 * runs[:, 1]
        commands[:, 1] = 1
        commands[:, 2] = 3 * runs[:, 0]
        commands[:, 4] = runs[:, 0]
        self._commands.orphan(max(self._commands.size, commands.nbytes))
        self._commands.write(commands.tobytes())
        self._vertex_array.render_indirect(self._commands, moderngl.TRIANGLES, count=len(runs))
