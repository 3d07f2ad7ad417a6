"""The brushes of a map as meshes: one for each entity and kind of brush, closed brush by brush."""

from __future__ import annotations

from collections import Counter

import numpy as np

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.magnitudes import MOST_TRIANGLES
from scenes.quake.brushes import MOST_SIDES, Polygons, polygons
from scenes.quake.map_text import Entity, Indices, MapText
from scenes.quake.textures import COLORS, CUT_OUT_SIGN, BrushKind, brush_kind, short_name
from scenes.quake.units import metres
from scenes.quake.welding import fans
from scenes.scene import Mesh

_INVISIBLE = "trigger_"
_SHOWN_LINES = 5
# Cubes of the brushes' numbers of faces: each face is cut by all others, and has as many corners at most.
# At 2 ns each it is half a minute. Four million faces of boxes, as many as are read, are 1.4e8.
MOST_WORK = 1.5e10


def read_meshes(text: MapText, notes: NoteBook) -> tuple[Mesh, ...]:
    """All that is drawn, in metres with Y up; what is left out is noted.

    Raises:
        LevelError: A brush has too many sides, the level too many triangles, or no brush has a volume.
    """
    _refuse_too_much(text)
    shapes = polygons(text)
    _note_faults(text, shapes, notes)
    kinds = _kinds(text)
    hidden = {entity.index for entity in text.entities if entity.kind.startswith(_INVISIBLE)}
    owners = _owners(text)
    _note_kinds(text, kinds, owners, hidden, notes)

    places, polygon = fans(shapes.offsets)
    brush_of = np.searchsorted(text.face_offsets, shapes.faces, side="right")[polygon] - 1
    triangles = shapes.loops[places]
    if len(triangles) > MOST_TRIANGLES:
        raise LevelError(
            f"This level has {len(triangles):,} triangles.",
            known=f"At most {MOST_TRIANGLES:,} are drawn.",
            remedy="Split it into several maps.",
        )
    positions = metres(shapes.corners)
    if len(text.brush_lines) and not len(triangles):
        raise LevelError(
            "No brush of this level has a volume.",
            where=f"line {text.brush_lines[0]}",
            known=f"It has {len(text.brush_lines)} brushes.",
            remedy="Check in the map's editor that its brushes are closed.",
        )
    meshes = []
    for entity in text.entities:
        if entity.index in hidden:
            continue
        first, last = np.searchsorted(brush_of, entity.brushes)
        for kind in (BrushKind.SOLID, BrushKind.SKY, BrushKind.LIQUID):
            chosen = triangles[first:last][kinds[brush_of[first:last]] == list(BrushKind).index(kind)]
            if len(chosen):
                corners, indices = np.unique(chosen, return_inverse=True)
                meshes.append(_mesh(entity, kind, positions[corners], indices.reshape(-1, 3)))
    return tuple(meshes)


def _mesh(entity: Entity, kind: BrushKind, positions: np.ndarray, triangles: Indices) -> Mesh:
    name = "worldspawn" if entity.kind == "worldspawn" else f"{entity.kind or 'brushes'} {entity.index}"
    return Mesh(
        name=name if kind is BrushKind.SOLID else f"{name} {kind}",
        positions=positions.astype(np.float32),
        triangles=triangles.astype(np.int32),
        casts=kind is BrushKind.SOLID,
        base_color=COLORS[kind],
        node=entity.index,
    )


def _refuse_too_much(text: MapText) -> None:
    sizes = np.diff(text.face_offsets)
    if sizes.max(initial=0) > MOST_SIDES:
        worst = int(np.argmax(sizes))
        raise LevelError(
            f"This brush has {sizes[worst]:,} faces.",
            where=f"line {text.brush_lines[worst]}",
            known=f"At most {MOST_SIDES} are read.",
            remedy="Split the brush.",
        )
    work = np.cumsum(sizes.astype(np.float64) ** 3)
    if len(work) and work[-1] > MOST_WORK:
        raise LevelError(
            "The brushes of this level have too many faces each: to cut them to shape takes too long.",
            where=f"line {text.brush_lines[int(np.argmax(work > MOST_WORK))]}",
            known=f"{len(sizes):,} brushes have {int(sizes.sum()):,} faces, one of them {sizes.max():,}.",
            remedy="Make round brushes of fewer sides, or split the level into several maps.",
        )


def _owners(text: MapText) -> Indices:
    """(b,) int64: the entity of each brush."""
    counts = [entity.brushes[1] - entity.brushes[0] for entity in text.entities]
    return np.repeat(np.arange(len(counts)), counts).astype(np.int64)


def _kinds(text: MapText) -> Indices:
    """(b,) int64: index in `BrushKind` of each brush."""
    order = list(BrushKind)
    # Few combinations of textures, many brushes.
    known: dict[frozenset[str], int] = {}
    kinds = []
    for start, end in zip(text.face_offsets[:-1], text.face_offsets[1:], strict=True):
        textures = frozenset(text.textures[start:end])
        if textures not in known:
            known[textures] = order.index(brush_kind(textures))
        kinds.append(known[textures])
    return np.array(kinds, np.int64)


def _note_kinds(text: MapText, kinds: Indices, owners: Indices, hidden: set[int], notes: NoteBook) -> None:
    drawn = np.array([owner not in hidden for owner in owners], bool)
    counts = Counter(list(BrushKind)[kind] for kind in kinds[drawn])
    if counts[BrushKind.SKY]:
        notes.info(
            "sky",
            f"{_brushes(counts[BrushKind.SKY])} of sky: drawn without casting, so that a sun shines through.",
        )
    if counts[BrushKind.LIQUID]:
        notes.info(
            "liquids",
            f"{_brushes(counts[BrushKind.LIQUID])} of water, slime, lava or portals: drawn without casting.",
        )
    if counts[BrushKind.TOOL]:
        names = sorted(
            {
                short_name(text.textures[text.face_offsets[brush]])
                for brush in np.flatnonzero(drawn & (kinds == list(BrushKind).index(BrushKind.TOOL)))
            }
        )
        notes.info(
            "tool brushes",
            f"{_brushes(counts[BrushKind.TOOL])} that nobody sees left out: {', '.join(names)}.",
        )
    if unseen := int((~drawn).sum()):
        owners_unseen = Counter(text.entities[owner].kind for owner in owners[~drawn])
        notes.info(
            "triggers",
            f"{_brushes(unseen)} of invisible entities left out: {', '.join(sorted(owners_unseen))}.",
        )
    cut_out = {short_name(name) for name in text.textures if short_name(name).startswith(CUT_OUT_SIGN)}
    if cut_out:
        notes.warning(
            "textures", f"Cut-out textures cast as if they had no holes: {_first(sorted(cut_out))}."
        )
    for word, count in sorted(text.skipped.items()):
        notes.warning("brushes", f"{count} x {word} left out: only brushes of flat faces are read.")


def _note_faults(text: MapText, shapes: Polygons, notes: NoteBook) -> None:
    sizes = np.diff(text.face_offsets)
    flat = np.searchsorted(text.face_offsets, np.flatnonzero(shapes.flat_faces), side="right") - 1
    empty = (shapes.volumes == 0.0) & ~shapes.endless & (sizes > 0)
    for faulty, what in (
        (np.unique(flat), "with a face whose three points lie in a line: that face is ignored"),
        (np.flatnonzero(shapes.endless), "whose faces leave a side open: left out"),
        (np.flatnonzero(empty), "without volume: left out"),
    ):
        if len(faulty):
            lines = _first([str(text.brush_lines[brush]) for brush in faulty])
            notes.warning("brushes", f"{_brushes(len(faulty))} {what} (at line {lines}).")


def _first(names: list[str]) -> str:
    more = f" and {len(names) - _SHOWN_LINES} more" if len(names) > _SHOWN_LINES else ""
    return ", ".join(names[:_SHOWN_LINES]) + more


def _brushes(count: int) -> str:
    return "1 brush" if count == 1 else f"{count:,} brushes"
