"""A model as a file: flat arrays and JSON, no pickles. Reading a stranger's file runs no code.

A ZIP archive whose members are stored as they are, under fixed dates: `model.json`, and an array of NumPy's
own format for each name. The same model gives the same bytes.
"""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from models.examples import Choices, Question
from models.performance import ERROR, PERCENTS, WORKS, PerformanceModel
from models.selector_model import METHODS, SelectorModel
from models.trees import ARRAYS, Trees
from scenes.errors import GnomonError

FORMAT = "gnomon-model"
VERSION = 1
LARGEST_BYTES = 64 << 20
MOST_MEMBERS = 2000
MANIFEST = "model.json"
_DATE = (1980, 1, 1, 0, 0, 0)

Json = dict[str, Any]
AnyArray = npt.NDArray[Any]


class ModelError(GnomonError):
    """A file that is no model, or one that this program cannot use."""

    exit_code = 3


@dataclass(frozen=True)
class Artifact:
    """A model with all that its user has to know.

    Attributes:
        model: The model.
        features: Names of its inputs, in order.
        card: JSON values: what the choices are, what it was learnt from, how good it is.
    """

    model: SelectorModel
    features: tuple[str, ...]
    card: Json


def packed(artifact: Artifact) -> bytes:
    """The file's bytes."""
    arrays = _arrays(artifact.model)
    manifest = {
        "format": FORMAT,
        "version": VERSION,
        "features": list(artifact.features),
        "model": _plain(artifact.model),
        "card": artifact.card,
        "checksum": _checksum(arrays),
    }
    text = json.dumps(manifest, indent=1, sort_keys=True, allow_nan=False).encode() + b"\n"
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(zipfile.ZipInfo(MANIFEST, _DATE), text)
        for name, array in sorted(arrays.items()):
            archive.writestr(zipfile.ZipInfo(f"{name}.npy", _DATE), _npy(array))
    return buffer.getvalue()


def unpacked(data: bytes, where: str = "") -> Artifact:
    """The model of a file's bytes.

    Raises:
        ModelError: They are no model, damaged, or of another version.
    """
    try:
        manifest, arrays = _members(data)
        return _artifact(manifest, arrays)
    except ModelError as error:
        raise ModelError(error.what, where=where, known=error.known, remedy=error.remedy) from error
    except (
        zipfile.BadZipFile,
        ValueError,
        KeyError,
        TypeError,
        IndexError,
        OverflowError,
        EOFError,
    ) as error:
        known = f"{type(error).__name__}: {error}"[:200]
        raise ModelError("This is no model, or a damaged one.", where=where, known=known) from error
    except (RecursionError, NotImplementedError, MemoryError, AttributeError, RuntimeError) as error:
        raise ModelError("This is no model.", where=where, known=type(error).__name__) from error


def load(path: Path) -> Artifact:
    """The model in a file.

    Raises:
        ModelError: It cannot be read, or is no model.
    """
    try:
        size = path.stat().st_size
        data = path.read_bytes() if size <= LARGEST_BYTES else b""
    except OSError as error:
        raise ModelError(
            "The model cannot be read.",
            where=str(path),
            known=error.strerror or str(error),
            remedy="`gnomon train -o MODEL` makes one.",
        ) from error
    if size > LARGEST_BYTES:
        raise ModelError(
            "This is no model: it is too large.", where=str(path), known=f"It has {size:,} bytes."
        )
    return unpacked(data, str(path))


def _arrays(model: SelectorModel) -> dict[str, AnyArray]:
    trees = {
        f"performance/{target}/{method}": one
        for target, of_target in model.performance.trees.items()
        for method, one in enumerate(of_target)
    }
    trees["forest"] = model.forest
    arrays: dict[str, AnyArray] = {
        f"{name}/{part}": array for name, one in trees.items() for part, array in one.arrays.items()
    }
    arrays |= {f"missed/{target}": percentiles for target, percentiles in model.missed.items()}
    arrays |= {"choices/method": model.choices.method, "choices/settings": model.choices.settings}
    return arrays | {"single": model.single}


def _plain(model: SelectorModel) -> Json:
    return {
        "questions": [[one.name, one.time, one.limit] for one in model.questions],
        "miss": model.miss,
        "method": model.method,
        "inner_costs": dict(model.inner_costs),
        "error_trend": list(model.choices.error_trend),
    }


def _npy(array: AnyArray) -> bytes:
    buffer = io.BytesIO()
    little = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
    np.lib.format.write_array(buffer, little, version=(1, 0), allow_pickle=False)
    return buffer.getvalue()


def _checksum(arrays: Mapping[str, AnyArray]) -> str:
    sha = hashlib.sha256()
    for name, array in sorted(arrays.items()):
        sha.update(f"{name}\0{array.dtype.str[1:]}\0{array.shape}\0".encode())
        sha.update(np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes())
    return sha.hexdigest()


def _members(data: bytes) -> tuple[Json, dict[str, AnyArray]]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        infos = archive.infolist()
        if len(infos) > MOST_MEMBERS or any(
            one.compress_type != zipfile.ZIP_STORED or one.file_size > len(data) for one in infos
        ):
            raise ModelError("This is no model: its parts are not stored as they are.")
        manifest = json.loads(archive.read(MANIFEST))
        _check_version(manifest)
        arrays = {
            one.filename.removesuffix(".npy"): _array(archive.read(one))
            for one in infos
            if one.filename != MANIFEST
        }
    if manifest["checksum"] != _checksum(arrays):
        raise ModelError("This model is damaged: its checksum is another.", remedy="Train it again.")
    return manifest, arrays


def _check_version(manifest: Any) -> None:
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        raise ModelError("This is no model of Gnomon's.")
    if manifest.get("version") != VERSION:
        raise ModelError(
            "This model is of another version.",
            known=f"It is of version {manifest.get('version')!r:.40}; this program reads {VERSION}.",
            remedy="Train it again.",
        )


def _array(data: bytes) -> AnyArray:
    stream = io.BytesIO(data)
    if np.lib.format.read_magic(stream) != (1, 0):
        raise ModelError("This is no model: an array is of another format.")
    shape, fortran, dtype = np.lib.format.read_array_header_1_0(stream)
    if fortran or dtype.kind not in "fi" or dtype.hasobject:
        raise ModelError("This is no model: an array holds other things than numbers.")
    # The header may claim any shape: only what is there is read.
    values = np.frombuffer(data, dtype, offset=stream.tell())
    array: AnyArray = values.reshape(shape).astype(dtype.newbyteorder("="))
    array.flags.writeable = False
    return array


def _artifact(manifest: Json, arrays: Mapping[str, AnyArray]) -> Artifact:
    plain, features = manifest["model"], tuple(str(name) for name in manifest["features"])
    questions = tuple(
        Question(str(name), str(time), _finite(limit)) for name, time, limit in plain["questions"]
    )
    trend = tuple(int(one) for one in plain["error_trend"])
    choices = Choices(
        _typed(arrays, "choices/method", np.int64, 1),
        _typed(arrays, "choices/settings", np.float64, 2),
        trend,
    )
    _check_choices(choices)
    count, times = len(choices.method), sorted({one.time for one in questions})
    performance = {
        target: tuple(
            _trees(arrays, f"performance/{target}/{method}", len(features) + len(trend), 1)
            for method in range(choices.methods)
        )
        for target in (*times, ERROR, WORKS)
    }
    missed = {target: _missed(arrays, target, choices.methods) for target in (*times, ERROR, WORKS)}
    single = _typed(arrays, "single", np.int64, 1)
    if not questions or len(single) != len(questions) or single.min() < 0 or single.max() >= count:
        raise ModelError("This is no model: its single best choices are none.")
    if plain["method"] not in METHODS:
        raise ModelError("This is no model: it chooses in a way that is not known.")
    model = SelectorModel(
        choices,
        questions,
        _finite(plain["miss"]),
        PerformanceModel(choices, performance),
        missed,
        _trees(arrays, "forest", len(features) + 2, count),
        single,
        str(plain["method"]),
        {str(name): _finite(cost) for name, cost in plain["inner_costs"].items()},
    )
    card = manifest["card"]
    if not isinstance(card, dict):
        raise ModelError("This is no model: it has no card.")
    return Artifact(model, features, card)


def _check_choices(choices: Choices) -> None:
    count = len(choices.method)
    methods = np.unique(choices.method)
    dense = count > 0 and np.array_equal(methods, np.arange(len(methods)))
    if not dense or choices.settings.shape != (count, len(choices.error_trend)):
        raise ModelError("This is no model: its choices contradict each other.")
    if not np.isfinite(choices.settings).all():
        raise ModelError("This is no model: a setting is not finite.")


def _trees(arrays: Mapping[str, AnyArray], name: str, columns: int, outputs: int) -> Trees:
    parts = {
        part: _typed(arrays, f"{name}/{part}", dtype, 2 if part == "value" else 1)
        for part, dtype in ARRAYS.items()
    }
    trees = Trees(**parts)
    problem = trees.problem(columns, outputs)
    if problem:
        raise ModelError(f"This is no model: {problem}.", known=f"In {name}.")
    return trees


def _missed(arrays: Mapping[str, AnyArray], target: str, methods: int) -> npt.NDArray[np.float64]:
    found = _typed(arrays, f"missed/{target}", np.float64, 2)
    if found.shape != (methods, len(PERCENTS)) or not np.isfinite(found).all():
        raise ModelError("This is no model: how far it misses is not known.")
    if (np.diff(found, axis=1) < 0).any():
        raise ModelError("This is no model: its percentiles do not rise.")
    return found


def _typed(arrays: Mapping[str, AnyArray], name: str, dtype: Any, dimensions: int) -> AnyArray:
    if name not in arrays:
        raise ModelError("This model lacks a part.", known=f"There is no {name}.")
    array = arrays[name]
    if array.dtype != dtype or array.ndim != dimensions:
        raise ModelError("This is no model: an array has another type or shape.", known=f"It is {name}.")
    return array


def _finite(value: Any) -> float:
    number = float(value)
    if not np.isfinite(number):
        raise ModelError("This is no model: a number is not finite.")
    return number
