"""Pictures for a page: each view's truth once, and of every candidate only the pixels that differ from it."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from api.error_map import error_map
from api.pictures import Picture, webp_bytes
from scenes.scene import Camera, Light
from selector.candidate import Candidate
from selector.truth import Shown


@dataclass(frozen=True)
class Layers:
    """What a candidate lays over the pictures of its view, as data URIs.

    Attributes:
        picture: The pixels of its picture that differ from the truth's.
        error_map: The pixels of its error map that differ from that of the truth.
    """

    picture: str
    error_map: str


@dataclass
class ViewPictures:
    """The pictures of one view of one light.

    Attributes:
        camera: The view.
        truth: Its true picture as a data URI.
        faultless: An error map without errors as a data URI.
        layers: Those of the candidates.
    """

    camera: Camera
    truth: str
    faultless: str
    layers: dict[Candidate, Layers] = field(default_factory=dict)


class PictureBook:
    """Keeps the pictures of the light that is being measured, encoded, until they are taken."""

    def __init__(self) -> None:
        self._views: list[ViewPictures] = []
        self._now: ViewPictures | None = None
        self._truth: Picture | None = None
        self._faultless: Picture | None = None

    def keep(self, light: Light, camera: Camera, candidate: Candidate | None, shown: Shown) -> None:
        """Keep what was seen: a truth (no candidate) begins a view, its candidates follow."""
        del light
        if candidate is None:
            self._begin(camera, shown)
            return
        assert self._now is not None
        assert self._truth is not None
        assert self._faultless is not None
        self._now.layers[candidate] = Layers(
            data_uri(layer(shown.picture, self._truth)), data_uri(layer(_map_of(shown), self._faultless))
        )

    def _begin(self, camera: Camera, truth: Shown) -> None:
        """Where not all candidates fit into memory together, a view comes again for the rest of them."""
        self._truth, self._faultless = truth.picture, _map_of(truth)
        self._now = next((view for view in self._views if view.camera is camera), None)
        if self._now is None:
            self._now = ViewPictures(camera, data_uri(self._truth), data_uri(self._faultless))
            self._views.append(self._now)

    def taken(self) -> Sequence[ViewPictures]:
        """The views of the light that is done, in the order in which they came; the next light begins."""
        views, self._views = self._views, []
        return views


def layer(picture: Picture, below: Picture) -> Picture:
    """(h, w, 4) uint8 sRGB that shows `picture` where it lies on `below`: transparent where both agree."""
    changed = (picture != below).any(axis=2)
    over = np.zeros((*changed.shape, 4), np.uint8)
    over[changed, :3] = picture[changed]
    over[changed, 3] = 255
    return over


def data_uri(picture: Picture) -> str:
    """(h, w, 3 or 4) uint8 sRGB, exact to the last bit, as text that a page can hold."""
    return "data:image/webp;base64," + base64.b64encode(webp_bytes(picture)).decode()


def _map_of(shown: Shown) -> Picture:
    truth = shown.truth
    return error_map(shown.mask, truth.lit, truth.domain, truth.picture)
