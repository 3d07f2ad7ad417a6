"""How a layer of ours is known, without reading it as USD."""

from __future__ import annotations

NAMESPACE = "gnomon"
MARK = "annotates"
"""Key of a layer's customLayerData, under `gnomon`: the level over which it lies."""

# The mark stands in the head of the layer.
_HEAD = 2**16


def is_layer(source: bytes) -> bool:
    """Whether these bytes are a layer of ours: its head says over which level it lies."""
    head = source[:_HEAD]
    # A level that is flattened together with a layer keeps its mark and loses its sublayers.
    marks = (f"dictionary {NAMESPACE} = {{".encode(), f"string {MARK} = ".encode(), b"subLayers = [")
    return head.startswith(b"#usda") and all(mark in head for mark in marks)
