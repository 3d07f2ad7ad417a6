"""A folder with a picture of each light under each candidate, and a sheet that shows them side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from api.contact_sheet import SheetTexts, contact_sheet
from api.pictures import Picture, file_word, light_words, write_png
from renderers.error_figures import mean_flip
from scenes.level import Level
from scenes.scene import Camera, Light
from selector.candidate import Candidate
from selector.level_measuring import Answer, SeenLight


@dataclass
class _View:
    """The pictures of one view, and how much the one that is farthest off differs from the truth.

    Attributes:
        camera: The view.
        truth: Its true picture.
        pictures: Those of the candidates.
        flip: The largest mean FLIP among them.
    """

    camera: Camera
    truth: Picture
    pictures: dict[Candidate, Picture] = field(default_factory=dict)
    flip: float = 0.0


class PictureFolder:
    """Keeps pictures of the light being measured, and writes them when it is done.

    Kept are those of one view only, that in which a candidate differs most from the truth, and of the view
    that is being rendered. Where not all candidates fit into the device's memory at once, the views come
    again for the rest of them: then the view stays the one that the first candidates chose.
    """

    def __init__(self, folder: Path, level: Level, seen: Sequence[SeenLight]) -> None:
        self._folder, self._level = folder, level
        self._seen = seen
        self._words = light_words([one.light for one in seen])
        self._light = 0
        self._begin()

    def _begin(self) -> None:
        self._kept: _View | None = None
        self._now: _View | None = None
        self._cameras: list[Camera] = []

    def keep(self, light: Light, camera: Camera, candidate: Candidate | None, picture: Picture) -> None:
        """Keep what was rendered: a truth (no candidate) begins a view, its candidates follow."""
        del light
        if candidate is None:
            self._settle()
            if any(camera is one for one in self._cameras):
                self._now = self._kept if self._kept and self._kept.camera is camera else None
            else:
                self._now = _View(camera, picture)
                self._cameras.append(camera)
        elif self._now is not None:
            self._now.pictures[candidate] = picture
            self._now.flip = max(self._now.flip, mean_flip(picture, self._now.truth))

    def _settle(self) -> None:
        """The view that has just ended is kept where it shows more than the one kept so far."""
        if self._now and (self._kept is None or self._now.flip > self._kept.flip):
            self._kept = self._now
        self._now = None

    def write(self, answer: Answer) -> None:
        """Write the pictures of the light that is done, and begin with the next.

        Raises:
            OutputError: A file cannot be written.
        """
        word = self._words[self._light]
        seen = self._seen[self._light]
        self._settle()
        if (kept := self._kept) is not None:
            write_png(self._folder / f"{word}.truth.png", kept.truth)
            for candidate, picture in kept.pictures.items():
                write_png(self._folder / f"{word}.{file_word(candidate.label)}.png", picture)
            if answer.measurement:
                sheet = contact_sheet(
                    self._texts(seen, kept.camera, answer),
                    kept.truth,
                    kept.pictures,
                    answer.measurement.measurements,
                    answer.recommendation,
                )
                write_png(self._folder / f"{word}.sheet.png", sheet)
        self._light += 1
        self._begin()

    def _texts(self, seen: SeenLight, camera: Camera, answer: Answer) -> SheetTexts:
        measurement = answer.measurement
        assert measurement is not None
        count = len(seen.cameras)
        views = f", the one of {count} in which most differs; figures are over all" if count > 1 else ""
        return SheetTexts(
            f"{seen.light.name} ({seen.light.kind} light)",
            f"{self._level.path.name}, view {camera.name!r} at "
            f"{measurement.width}x{measurement.height}{views}; on {measurement.device.renderer}",
        )
