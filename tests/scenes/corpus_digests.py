"""One small spec of each family, and its recorded digest.

`python -m tests.scenes.corpus_digests` records them anew.
"""

from __future__ import annotations

from pathlib import Path

from scenes.corpus.registry import families
from scenes.corpus.spec import Spec, Standpoint
from scenes.corpus.staging import instance
from scenes.scene import LightKind

RECORDED = Path(__file__).with_name("corpus_digests.txt")

_STANDPOINTS = {
    "cathedral": Standpoint.CLOSE,
    "cave": Standpoint.NEAR,
    "city_block": Standpoint.FAR,
    "forest": Standpoint.CLOSE,
    "furnished_flat": Standpoint.CLOSE,
    "harbour_cranes": Standpoint.CLOSE,
    "stadium": Standpoint.REMOTE,
}


def small(name: str) -> Spec:
    """The spec of a family whose digest is recorded."""
    family = families()[name]
    return Spec(
        name,
        seed=11,
        triangles=min(4 * family.TRIANGLES[0], 20_000),
        kind=family.KINDS[0] if family.INDOOR else LightKind.DIRECTIONAL,
        standpoint=_STANDPOINTS.get(name, Standpoint.VISTA),
    )


def made() -> str:
    """One line of each family: its name and the digest of its small spec."""
    return "".join(f"{name} {instance(small(name)).digest}\n" for name in families())


if __name__ == "__main__":
    RECORDED.write_text(made())
