"""Whether a new model takes the old one's place, and how, without a moment in which there is none."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from models.contesting import Contest
from scenes.atomic_file import output_error, write_atomically

NEGLIGIBLE = 1e-9
RULE = (
    "The new model is promoted if its mean cost over all policies and both mobilities is not higher, and if "
    "under no single one of them it is surely higher: 95 of 100 draws of families, both drawn together."
)


@dataclass(frozen=True)
class Decision:
    """What became of the new model.

    Attributes:
        promoted: Whether it is in force.
        why: In a sentence.
        kept: Where the old one is now; None where there was none, or it stays in force.
    """

    promoted: bool
    why: str
    kept: Path | None = None


def decide(found: Contest) -> Decision:
    """By the rule."""
    difference, low, high = found.difference()
    cost = float(found.by_family(found.champion).mean())
    words = f"{100 * abs(difference) / cost:.2g} %"
    if difference > NEGLIGIBLE:
        return Decision(
            promoted=False,
            why=f"The new model costs {words} more ({low:+.3f} to {high:+.3f}), so the old one stays.",
        )
    for index, question in enumerate(found.questions):
        worse, least, _ = found.difference(index)
        if least > NEGLIGIBLE:
            why = f"Under the policy {question.name} for {question.time} lights the new model is surely worse"
            return Decision(promoted=False, why=f"{why}, by {worse:.3f}, so the old one stays.")
    if difference < -NEGLIGIBLE:
        return Decision(
            promoted=True,
            why=f"The new model costs {words} less ({low:+.3f} to {high:+.3f}), and nowhere more.",
        )
    return Decision(
        promoted=True, why="The new model costs as much as the old one, and knows the newer evidence."
    )


def put_in_force(target: Path, data: bytes, now: datetime) -> Path | None:
    """Writes a model in place of another; gives where the other is kept, or None where there was none.

    The old one is copied first, so at every moment there is a whole model at `target`.

    Raises:
        OutputError: One cannot be written. The old model is then still in force.
    """
    kept = None
    if target.exists():
        kept = target.with_name(f"{target.stem}.previous-{now:%Y-%m-%dT%H%M%SZ}{target.suffix}")
        try:
            old = target.read_bytes()
        except OSError as error:
            raise output_error(target, error) from error
        write_atomically(kept, old)
    write_atomically(target, data)
    return kept
