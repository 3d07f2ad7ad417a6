"""A program of its own that decodes Draco data from its standard input, with a limit on its memory.

A block of 24 kB can hold 400 MB of attributes that nobody asked for, and no header tells: only the system can
say when it is enough. For each request, `REQUEST` and so many bytes, it answers `ANSWER` with positions and
triangles behind it, or a negative count with a sentence of so many bytes.
"""

from __future__ import annotations

import contextlib
import struct
import sys
from typing import Any, BinaryIO

# Bytes of the block, unique id of the attribute that holds the positions.
REQUEST = struct.Struct("<QI")
# Vertices, and triangles; or -1, and bytes of a sentence.
ANSWER = struct.Struct("<qq")
REFUSED = -1

# Beside what Python and its libraries take, enough for 24 million vertices with normals and the like.
MOST_BYTES = 4 * 2**30
MOST_SECONDS = 120


def serve(requests: BinaryIO, answers: BinaryIO) -> None:
    """Answers requests until there are no more."""
    while header := requests.read(REQUEST.size):
        length, attribute = REQUEST.unpack(header)
        try:
            positions, triangles = decoded(requests.read(length), attribute)
        except (ArithmeticError, LookupError, MemoryError, TypeError, ValueError, RuntimeError) as error:
            _refuse(answers, str(error) or type(error).__name__)
        else:
            answers.write(ANSWER.pack(len(positions), len(triangles)))
            answers.write(positions.tobytes())
            answers.write(triangles.tobytes())
        answers.flush()


def decoded(block: bytes, attribute: int) -> tuple[Any, Any]:
    """Positions (v, 3) float32 and triangles (t, 3) uint32 of a Draco block.

    Raises:
        ValueError: It holds no triangles, or no such attribute of positions.
    """
    import DracoPy  # noqa: PLC0415  an extra, and only this process needs it
    import numpy as np  # noqa: PLC0415

    try:
        mesh = DracoPy.decode(block)
    except DracoPy.FileTypeException:
        # What it says of a damaged file, too.
        raise ValueError("It is damaged or no Draco data") from None
    if not isinstance(mesh, DracoPy.DracoMesh):
        raise ValueError("It holds points without triangles")  # noqa: TRY004  the data is wrong, not its type
    found = mesh.get_attribute_by_unique_id(attribute)
    values = np.zeros(0) if found is None else np.asarray(found["data"])
    if values.shape[1:] != (3,):
        raise ValueError(f"It has no attribute {attribute} with three numbers for each vertex")
    return values.astype("<f4"), np.asarray(mesh.faces).astype("<u4").reshape(-1, 3)


def _refuse(answers: BinaryIO, sentence: str) -> None:
    text = sentence.encode("utf-8", "replace")
    answers.write(ANSWER.pack(REFUSED, len(text)) + text)


def _limit() -> None:
    # Where the system knows no such limits, there are none.
    with contextlib.suppress(ImportError):
        import resource  # noqa: PLC0415

        resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
        resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    _limit()
    serve(sys.stdin.buffer, sys.stdout.buffer)
