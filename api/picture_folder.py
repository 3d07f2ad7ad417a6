"""A folder with a picture of each light under each candidate, and a sheet that shows them side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from api.contact_sheet import SheetTexts, contact_sheet
from api.pictures import Picture, file_word, light_words, write_png
from scenes.level import Level
from scenes.scene import Camera, Light
from selector.candidate import Candidate
from selector.level_measuring import Answer, SeenLight


class PictureFolder:
    """Keeps the pictures of the light being measured, in its first view, and writes them when it is done."""

    def __init__(self, folder: Path, level: Level, seen: Sequence[SeenLight]) -> None:
        self._folder, self._level = folder, level
        self._seen = seen
        self._words = light_words([one.light for one in seen])
        self._light = 0
        self._truth: Picture | None = None
        self._pictures: dict[Candidate, Picture] = {}

    def keep(self, light: Light, camera: Camera, candidate: Candidate | None, picture: Picture) -> None:
        """Keep what was rendered, if it is the first view of its light."""
        del light
        if camera is not self._seen[self._light].cameras[0]:
            return
        if candidate is None:
            self._truth = picture
        else:
            self._pictures[candidate] = picture

    def write(self, answer: Answer) -> None:
        """Write the pictures of the light that is done, and begin with the next.

        Raises:
            OutputError: A file cannot be written.
        """
        word = self._words[self._light]
        seen = self._seen[self._light]
        if self._truth is not None:
            write_png(self._folder / f"{word}.truth.png", self._truth)
            for candidate, picture in self._pictures.items():
                write_png(self._folder / f"{word}.{file_word(candidate.label)}.png", picture)
            if answer.measurement:
                sheet = contact_sheet(
                    self._texts(seen, answer),
                    self._truth,
                    self._pictures,
                    answer.measurement.measurements,
                    answer.recommendation,
                )
                write_png(self._folder / f"{word}.sheet.png", sheet)
        self._light += 1
        self._truth, self._pictures = None, {}

    def _texts(self, seen: SeenLight, answer: Answer) -> SheetTexts:
        measurement = answer.measurement
        assert measurement is not None
        views = f"times and errors over {len(seen.cameras)} views" if len(seen.cameras) > 1 else "one view"
        return SheetTexts(
            f"{seen.light.name} ({seen.light.kind} light)",
            f"{self._level.path.name}, view {seen.cameras[0].name!r} at "
            f"{measurement.width}x{measurement.height}; {views} on {measurement.device.renderer}",
        )
