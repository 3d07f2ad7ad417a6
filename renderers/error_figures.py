"""How wrong a shadow is: figures that compare a light's visibility mask with the truth, without a GPU.

All pictures are (h, w); pixels count in the receivers' domain only: surfaces that face the light within its
reach. A mask is 1 where lit, 0 where shadowed, a fraction where filtered.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import OpenImageIO
from scipy import ndimage
from scipy.spatial import KDTree

Bools = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float32] | npt.NDArray[np.float64]
Points = npt.NDArray[np.float64]

SHORTEST_BOUNDARY_PX = 64.0
"""A view that shows less of the shadow's edge says too little about how far the edge is off."""

FARTHEST_PX = 16.0
"""Distances between edges are cut here: a shadow that is missing altogether is infinitely far off."""

ATTACHED_PX = 2.0
"""A wrong patch that begins nearer than this to the true edge is an edge drawn in the wrong place."""

COPLANAR = 0.05
"""Share of the step between two pixels by which either may lie off the other's plane: rounded depth and
normals stay well below, and a ledge is told from its floor unless seen at less than 3 degrees."""

FLIP_PIXELS_PER_DEGREE = 67.02
"""FLIP's standard viewer: 0.7 m before a screen 0.7 m and 3840 pixels wide (Andersson et al. 2020)."""


FLIP_REACH_DEGREES = 3 * math.sqrt(0.04 / (2 * math.pi**2))
"""Three standard deviations of FLIP's widest filter, that of the blue-yellow channel (section 4.1)."""


@dataclass(frozen=True)
class ErrorFigures:
    """How wrong one mask is in one view. Shares are of the domain.

    Attributes:
        pixels: Size of the domain.
        wrong_share: Pixels on the wrong side of 0.5; None, as all shares are, where the domain is empty.
        false_lit: The part of `wrong_share` that should be in shadow.
        false_shadow: The part of `wrong_share` that should be lit.
        boundary_px: Length of the true shadow edge that the view shows.
        edge_error_px: Mean displacement of the edge: the summed difference of the masks, fractions
            included, over the edge's length. None where `boundary_px` is below 64.
        edge_error_p95_px: 95th percentile of the distance between the two edges, from either to the other,
            the larger of the two, at most 16. None where `boundary_px` is below 64.
        acne_share: False shadow that no displaced edge explains.
        leak_share: False light that no displaced edge explains.
    """

    pixels: int
    wrong_share: float | None
    false_lit: float | None
    false_shadow: float | None
    boundary_px: float
    edge_error_px: float | None
    edge_error_p95_px: float | None
    acne_share: float | None
    leak_share: float | None


def error_figures(
    mask: Floats, truth: Bools, domain: Bools, joined_right: Bools, joined_down: Bools
) -> ErrorFigures:
    """Compares a mask with the truth.

    Args:
        mask: (h, w) float in [0, 1]; outside the domain anything but NaN does.
        truth: (h, w) bool, True where lit.
        domain: (h, w) bool, the pixels that count.
        joined_right: (h, w - 1) bool: whether a pixel and its right neighbour show the same surface.
        joined_down: (h - 1, w) bool: the same for the neighbour below. See `continuity`.

    An edge is followed only between joined pixels of the domain, so that the outlines of objects, where a
    shadow ends because something else begins, are not taken for shadow edges.
    """
    assert mask.shape == truth.shape == domain.shape
    assert truth.dtype == domain.dtype == joined_right.dtype == joined_down.dtype == np.bool_
    assert joined_right.shape == (mask.shape[0], mask.shape[1] - 1)
    assert joined_down.shape == (mask.shape[0] - 1, mask.shape[1])
    assert mask.min(initial=0) >= 0, "masks hold shares of light"
    assert mask.max(initial=1) <= 1, "masks hold shares of light"

    seams = _Seams(joined_right & domain[:, :-1] & domain[:, 1:], joined_down & domain[:-1] & domain[1:])
    lit = mask >= 0.5
    true_cracks = seams.cracks(truth)
    boundary_px = seams.length(true_cracks)
    pixels = int(np.count_nonzero(domain))
    if pixels == 0:
        return ErrorFigures(0, None, None, None, 0.0, None, None, None, None)

    wrong = (lit != truth) & domain
    false_lit = int(np.count_nonzero(wrong & lit))
    false_shadow = int(np.count_nonzero(wrong)) - false_lit
    stray = _detached(wrong, true_cracks)
    edge_error_px = edge_error_p95_px = None
    if boundary_px >= SHORTEST_BOUNDARY_PX:
        difference = np.abs(mask - truth, dtype=np.float32)
        edge_error_px = float(difference.sum(dtype=np.float64, where=domain)) / boundary_px
        edge_error_p95_px = _distance_p95(seams.cracks(lit), true_cracks)
    return ErrorFigures(
        pixels=pixels,
        wrong_share=(false_lit + false_shadow) / pixels,
        false_lit=false_lit / pixels,
        false_shadow=false_shadow / pixels,
        boundary_px=boundary_px,
        edge_error_px=edge_error_px,
        edge_error_p95_px=edge_error_p95_px,
        acne_share=int(np.count_nonzero(stray & ~lit)) / pixels,
        leak_share=int(np.count_nonzero(stray & lit)) / pixels,
    )


def continuity(positions: Floats, normals: Floats, valid: Bools) -> tuple[Bools, Bools]:
    """(h, w - 1) and (h - 1, w) bool: whether a pixel and its right, or lower, neighbour show one surface.

    Args:
        positions: (h, w, 3) finite, any unit and origin; near the origin where they are float32.
        normals: (h, w, 3) unit geometric normals, towards the eye.
        valid: (h, w) bool, where there is a surface at all.

    Two pixels are joined where they lie in one plane, or where their planes cross between them: then both
    lie in front of each other's plane (a wall's foot) or both behind it (a table's edge). At a jump in depth
    the farther one lies behind the nearer one's plane and the nearer one in front of the farther one's.
    So creases join: the surfaces touch there, and a shadow's edge runs on across them.
    """
    right = _on_one_surface(positions[:, :-1], positions[:, 1:], normals[:, :-1], normals[:, 1:])
    down = _on_one_surface(positions[:-1], positions[1:], normals[:-1], normals[1:])
    return right & valid[:, :-1] & valid[:, 1:], down & valid[:-1] & valid[1:]


def over_views(values: Sequence[float | None]) -> float | None:
    """A light's figure from those of its views: the 95th percentile, the worst where views are under 20.

    Views that have nothing to say (None) do not count; None if no view has.
    """
    known = [value for value in values if value is not None]
    if not known:
        return None
    return float(np.percentile(known, 95)) if len(known) >= 20 else max(known)


def mean_flip(
    image: npt.NDArray[np.uint8 | np.float32],
    reference: npt.NDArray[np.uint8 | np.float32],
    *,
    pixels_per_degree: float = FLIP_PIXELS_PER_DEGREE,
) -> float:
    """Mean FLIP in [0, 1]: how much a viewer notices who flips between the two pictures.

    Args:
        image: (h, w, 3), uint8 sRGB or float32 linear with Rec. 709 primaries; above 1 counts as 1.
        reference: The same kind and shape.
        pixels_per_degree: How finely the viewer's eye resolves the screen.

    Andersson et al., FLIP: A Difference Evaluator for Alternating Images, 2020. The mean is what its authors
    recommend for a single number. OpenImageIO takes untagged pictures for linear Rec. 709.
    """
    assert image.shape == reference.shape
    assert image.shape[2:] == (3,)
    changed = (image != reference).any(axis=2)
    if not changed.any():
        return 0.0
    # Equal pixels count for nothing unless a filter reaches from them to unequal ones, and once more to the
    # border of the part that is looked at.
    window = _around(changed, 2 * (math.ceil(FLIP_REACH_DEGREES * pixels_per_degree) + 1))
    difference = OpenImageIO.ImageBufAlgo.FLIP_diff(
        _linear_picture(reference[window]), _linear_picture(image[window]), hdr=0, ppd=pixels_per_degree
    )
    assert not difference.has_error, difference.geterror()
    error_map = difference.get_pixels(OpenImageIO.FLOAT)
    assert error_map is not None
    return float(np.sum(error_map, dtype=np.float64) / changed.size)


def _around(changed: Bools, margin: int) -> tuple[slice, slice]:
    """The rows and columns that hold all True pixels, and `margin` more on each side where there are any."""
    rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
    return (
        slice(max(0, rows[0] - margin), rows[-1] + margin + 1),
        slice(max(0, columns[0] - margin), columns[-1] + margin + 1),
    )


@dataclass(frozen=True)
class _Cracks:
    """Where a picture changes: between a pixel and its right neighbour, and between it and the one below."""

    right: Bools
    down: Bools

    def midpoints(self) -> Points:
        """(n, 2) float64 row and column, in pixels from the centre of the top left pixel."""
        right, down = np.argwhere(self.right), np.argwhere(self.down)
        return np.concatenate([right + np.array([0, 0.5]), down + np.array([0.5, 0])])

    def without(self, other: _Cracks) -> _Cracks:
        return _Cracks(self.right & ~other.right, self.down & ~other.down)

    def count(self) -> int:
        return int(np.count_nonzero(self.right)) + int(np.count_nonzero(self.down))


@dataclass(frozen=True)
class _Seams:
    """Neighbours in the domain on one surface: across these a shadow's edge can be followed."""

    right: Bools
    down: Bools

    def cracks(self, lit: Bools) -> _Cracks:
        return _Cracks(
            self.right & (lit[:, :-1] != lit[:, 1:]),
            self.down & (lit[:-1] != lit[1:]),
        )

    def length(self, cracks: _Cracks) -> float:
        """Length in pixels of the marching-squares contour through the pixel centres.

        Each crack is one pixel long where the contour runs straight. In a 2 x 2 cell in which it turns, it
        cuts the corner: two half cracks become sqrt(1/2), twice in a saddle. A cell that is not wholly in
        the domain cannot be seen to turn, so an edge keeps its length up to the border. Exact for edges
        along the axes and the diagonals; in between up to sqrt(4 - 2 sqrt 2) - 1 = 8.2 % too long, at 22.5
        degrees (a staircase of straight and diagonal steps).
        """
        whole = self.right[:-1] & self.right[1:] & self.down[:, :-1] & self.down[:, 1:]
        corners = np.count_nonzero(whole & (cracks.right[:-1] != cracks.right[1:]))
        four = cracks.right[:-1] & cracks.right[1:] & cracks.down[:, :-1] & cracks.down[:, 1:]
        saddles = np.count_nonzero(whole & four)
        return float(cracks.count() - (1 - np.sqrt(0.5)) * (corners + 2 * saddles))


def _on_one_surface(first: Floats, second: Floats, first_normal: Floats, second_normal: Floats) -> Bools:
    step = second - first
    second_height = np.einsum("ijk,ijk->ij", first_normal, step)
    first_height = -np.einsum("ijk,ijk->ij", second_normal, step)
    least = COPLANAR**2 * np.einsum("ijk,ijk->ij", step, step)
    coplanar = (first_height**2 <= least) & (second_height**2 <= least)
    crossing = first_height * second_height >= 0
    joined: Bools = coplanar | crossing
    return joined


def _distance_p95(found: _Cracks, true: _Cracks) -> float:
    """The larger of the two directed 95th percentiles of the distance between edges, in pixels."""
    return max(_directed_p95(found, true), _directed_p95(true, found))


def _directed_p95(start: _Cracks, goal: _Cracks) -> float:
    if start.count() == 0:
        return 0.0
    if goal.count() == 0:
        return FARTHEST_PX
    # What both edges share is at distance 0; a good technique leaves little else to look up.
    distances = np.zeros(start.count())
    apart = start.without(goal).midpoints()
    nearest, _ = KDTree(goal.midpoints()).query(apart, distance_upper_bound=FARTHEST_PX)
    distances[: len(apart)] = np.minimum(nearest, FARTHEST_PX)
    return float(np.percentile(distances, 95))


def _detached(wrong: Bools, true: _Cracks) -> Bools:
    """(h, w) bool: wrong pixels that belong to no displaced edge.

    However coarse a map is, what it gets wrong for want of resolution lies along the true edge: a patch that
    starts at the edge and ends a texel further. So a patch of wrong pixels (8-connected) that does not touch
    the true edge is acne or a leak, and so is what lies farther from it than any edge is let off for. No
    texel size is needed, hence all techniques are judged alike.
    """
    if not wrong.any():
        return wrong
    rows, columns = np.nonzero(wrong)
    if true.count() == 0:
        return wrong
    patch, patches = ndimage.label(wrong, structure=np.ones((3, 3)))
    distance, _ = KDTree(true.midpoints()).query(
        np.stack([rows, columns], axis=1), distance_upper_bound=FARTHEST_PX
    )
    attached = np.zeros(patches + 1, dtype=np.bool_)
    patch_of_pixel = patch[rows, columns]
    attached[patch_of_pixel[distance <= ATTACHED_PX]] = True
    stray = np.zeros_like(wrong)
    stray[rows, columns] = ~attached[patch_of_pixel] | (distance > FARTHEST_PX)
    return stray


def _linear_picture(image: npt.NDArray[np.uint8 | np.float32]) -> OpenImageIO.ImageBuf:
    assert image.dtype in (np.uint8, np.float32)
    linear = _LINEAR_FROM_SRGB[image] if image.dtype == np.uint8 else image
    picture = OpenImageIO.ImageBuf(
        OpenImageIO.ImageSpec(image.shape[1], image.shape[0], 3, OpenImageIO.FLOAT)
    )
    picture.set_pixels(OpenImageIO.ROI(), np.ascontiguousarray(linear))
    return picture


def _srgb_decoded(code: npt.NDArray[np.int_]) -> npt.NDArray[np.float32]:
    """IEC 61966-2-1."""
    value = code / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4).astype(np.float32)


_LINEAR_FROM_SRGB = _srgb_decoded(np.arange(256))
