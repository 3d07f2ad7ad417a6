"""Annotations as a layer over a USD level, which itself is never changed.

The layer sublayers the level, repeats what only a root layer can say of a stage (its units, its axes), and
holds an `over` for each light with custom attributes: `gnomon:technique` and so on, and
`gnomon:recommendation` with the whole story as JSON. No layer can speak of a light inside a native
instance: the outermost instance carries its attributes, with the path in between as in
`gnomon:Arm:Bulb:technique`.

What others add to such a layer stays when it is annotated again or cleared; its text is written anew.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pxr import Sdf, Usd

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.light_annotation import OWN_KEYS, Cleared, LightAnnotation, Scalar
from scenes.usd.diagnostics import quiet
from scenes.usd.lamps import Lamp, lamps
from scenes.usd.layer_mark import MARK, NAMESPACE, is_layer
from scenes.usd.stage import (
    Layer,
    Stage,
    judge_composition,
    open_file,
    open_layer,
    require_usd,
    text_layer,
)
from scenes.usd.values import value
from scenes.usd.walk import Kind, walk

STORY = "recommendation"

# Only a root layer's opinion on these counts, so the one on top has to repeat them.
STAGE_FIELDS = (
    "defaultPrim",
    "metersPerUnit",
    "upAxis",
    "kilogramsPerUnit",
    "startTimeCode",
    "endTimeCode",
    "timeCodesPerSecond",
    "framesPerSecond",
    "renderSettingsPrimPath",
)

_TYPES = {
    bool: Sdf.ValueTypeNames.Bool,
    int: Sdf.ValueTypeNames.Int64,
    float: Sdf.ValueTypeNames.Double,
    str: Sdf.ValueTypeNames.String,
}


def _attribute(key: str) -> str:
    """`mapSize` for `gnomon_map_size`."""
    first, *others = key.removeprefix(f"{NAMESPACE}_").split("_")
    return first + "".join(word.capitalize() for word in others)


ATTRIBUTES = {key: _attribute(key) for key in sorted(OWN_KEYS)}
_OURS = {*ATTRIBUTES.values(), STORY}


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation], path: Path) -> bytes:
    """The layer over the level at `path` with these annotations, by number of the light.

    Args:
        source: The level: a layer of ours is written anew, anything else gets one.
        annotations: Number of the light to annotation; the same ones give the same bytes.
        path: The level, whose name the layer holds.

    Raises:
        LevelError: The level cannot be read, or has no such light.
    """
    with quiet():
        layer, stage = _layer_and_stage(source, path)
        lights = list(lamps(walk(stage, NoteBook()), Kind.LIGHT))
        for number, one in sorted(annotations.items()):
            if not 0 <= number < len(lights):
                raise LevelError(
                    f"There is no node {number} to annotate.",
                    where="stage",
                    known=f"The level has {len(lights)} lights, counted from 0.",
                    remedy="Read the level again: has it changed?",
                )
            _write(layer, lights[number], one)
        _block_leftovers(layer, stage, lights, annotations)
        return _text(layer)


def read_annotations(source: bytes, path: Path) -> dict[int, LightAnnotation]:
    """What the level at `path`, or a layer over it, says of its lights, by their number.

    Raises:
        LevelError: The level cannot be read.
    """
    with quiet():
        require_usd(source)
        stage = open_layer(text_layer(source), path.parent) if is_layer(source) else open_file(path)
        judge_composition(stage, NoteBook())
        lights = enumerate(lamps(walk(stage, NoteBook()), Kind.LIGHT))
        return {number: one for number, lamp in lights if (one := _read(stage, lamp)) is not None}


def clear(source: bytes, path: Path) -> Cleared:
    """A layer over the level at `path` that says nothing of ours.

    Raises:
        LevelError: The level cannot be read.
    """
    with quiet():
        layer, stage = _layer_and_stage(source, path)
        lights = list(lamps(walk(stage, NoteBook()), Kind.LIGHT))
        blocked = _block_leftovers(layer, stage, lights, {})
        name = layer.customLayerData[NAMESPACE][MARK]
        note = f"The layer holds no annotation any more; {name} itself was never changed."
        if blocked:
            note = f"The layer blocks the annotations in {name}, which itself is never changed."
        return Cleared(_text(layer), restored=not blocked, note=note)


def _layer_and_stage(source: bytes, path: Path) -> tuple[Layer, Stage]:
    """A layer over the level without anything of ours, and the level composed with that layer."""
    require_usd(source)
    layer = _bare(source) if is_layer(source) else _fresh(path)
    # A copy, since composing it changes the names of files in it.
    stage = open_layer(text_layer(layer.ExportToString().encode()), path.parent)
    judge_composition(stage, NoteBook())
    return layer, stage


def _fresh(path: Path) -> Layer:
    # The stage keeps its layers alive.
    stage = open_file(path)
    root = stage.GetRootLayer()
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.subLayerPaths.append(f"./{path.name}")
    layer.customLayerData = {NAMESPACE: {MARK: path.name}}
    for field in STAGE_FIELDS:
        if root.pseudoRoot.HasInfo(field):
            layer.pseudoRoot.SetInfo(field, root.pseudoRoot.GetInfo(field))
    return layer


def _bare(source: bytes) -> Layer:
    layer = text_layer(source)
    specs: list[Any] = []
    layer.Traverse(Sdf.Path.absoluteRootPath, specs.append)
    for place in specs:
        if place.IsPropertyPath() and _is_ours(place.name):
            prim = layer.GetPrimAtPath(place.GetPrimPath())
            prim.RemoveProperty(prim.properties[place.name])
            layer.ScheduleRemoveIfInert(prim)
    # Those above are inert once those below are gone.
    layer.RemoveInertSceneDescription()
    return layer


def _is_ours(name: str) -> bool:
    first, *_, last = name.split(":") if ":" in name else ("", name)
    return first == NAMESPACE and last in _OURS


def _write(layer: Layer, lamp: Lamp, one: LightAnnotation) -> None:
    prim = Sdf.CreatePrimInLayer(layer, lamp.owner)
    for key, scalar in sorted(one.extras.items()):
        _set(prim, _name(lamp, ATTRIBUTES[key]), scalar)
    story = json.dumps(dict(one.extension), allow_nan=False)
    _set(prim, _name(lamp, STORY), story)


def _name(lamp: Lamp, attribute: str) -> str:
    return ":".join([NAMESPACE, *filter(None, lamp.inside.split("/")), attribute])


def _set(prim: Any, name: str, content: Any, kind: Any = None) -> None:
    kind = kind or _TYPES[type(content)]
    spec = Sdf.AttributeSpec(prim, name, kind, Sdf.VariabilityUniform, declaresCustom=True)
    spec.default = content


def _block_leftovers(
    layer: Layer, stage: Stage, lights: list[Lamp], annotations: Mapping[int, LightAnnotation]
) -> bool:
    """Blocks what the level itself says in our name and the layer does not: where it was flattened once."""
    blocked = False
    for number, lamp in enumerate(lights):
        owner = stage.GetPrimAtPath(lamp.owner)
        one = annotations.get(number)
        written = {STORY, *(ATTRIBUTES[key] for key in one.extras)} if one else set()
        for attribute in sorted(_OURS - written):
            found = owner.GetAttribute(_name(lamp, attribute))
            if found and found.HasAuthoredValue():
                prim = Sdf.CreatePrimInLayer(layer, lamp.owner)
                _set(prim, str(found.GetName()), Sdf.ValueBlock(), found.GetTypeName())
                blocked = True
    return blocked


def _read(stage: Stage, lamp: Lamp) -> LightAnnotation | None:
    owner = stage.GetPrimAtPath(lamp.owner)
    extras = dict(_scalars(owner, lamp))
    story = owner.GetAttribute(_name(lamp, STORY))
    text = value(story)
    if not extras and text is None:
        return None
    return LightAnnotation(extras, _object(text))


def _scalars(owner: Usd.Prim, lamp: Lamp) -> Iterator[tuple[str, Scalar]]:
    for key, attribute in ATTRIBUTES.items():
        found = owner.GetAttribute(_name(lamp, attribute))
        scalar = value(found)
        # Others may have written what we never would, such as a number without end.
        if isinstance(scalar, Scalar) and (isinstance(scalar, str) or math.isfinite(scalar)):
            yield key, scalar


def _object(text: object) -> dict[str, Any]:
    try:
        found = json.loads(text) if isinstance(text, str) else {}
        json.dumps(found, allow_nan=False)
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def _text(layer: Layer) -> bytes:
    return str(layer.ExportToString()).encode()
