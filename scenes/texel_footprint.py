"""How large a texel of a light's map looks on the screen: the figure that predicts a map's aliasing.

Stamminger and Drettakis 2002, section 3, write it with angles and distances for one setting; the Jacobian
holds for every map that is a projection.
"""

from __future__ import annotations

import numpy as np

from scenes.scene import Array

# A surface seen edge-on by the light has texels without end.
LARGEST_PX = 1e6


def screen_footprints(
    points: Array, normals: Array, maps: Array, side: int, clip_from_scene: Array, size: tuple[int, int]
) -> Array:
    """(k, n) float64: the longest extent in pixels of a texel at each point, for each of k maps.

    Above 1 the map undersamples the screen there.

    Args:
        points: (n, 3) float64 places on surfaces, scene space, in front of the camera and in the maps.
        normals: (n, 3) float64 unit.
        maps: (k, 3, 4) float64 rows x, y and w of clip from scene, w positive at the points.
        side: Texels along a map.
        clip_from_scene: (4, 4) float64 of the camera.
        size: Width and height of the screen in pixels.

    With J the derivatives of screen and map coordinates along the surface, J_screen J_map^-1 takes a texel
    to pixels; its larger singular value is the extent.
    """
    tangents = _tangents(normals)
    x, y = _derivatives(points, tangents, maps)
    screen_x, screen_y = _derivatives(points, tangents, clip_from_scene[None, [0, 1, 3]])
    determinant = x[0] * y[1] - x[1] * y[0]
    # Pixels per texel, times the determinant: the adjugate stands for the inverse.
    half_texels, (half_width, half_height) = side / 2, (size[0] / 2, size[1] / 2)
    across = half_width * (screen_x[0] * y[1] - screen_x[1] * y[0])
    across_too = half_width * (screen_x[1] * x[0] - screen_x[0] * x[1])
    down = half_height * (screen_y[0] * y[1] - screen_y[1] * y[0])
    down_too = half_height * (screen_y[1] * x[0] - screen_y[0] * x[1])
    squares = across**2 + across_too**2 + down**2 + down_too**2
    area = across * down_too - across_too * down
    longest = np.sqrt((squares + np.sqrt(np.maximum(squares**2 - 4 * area**2, 0))) / 2) / half_texels
    least = longest / LARGEST_PX
    extent: Array = longest / np.maximum(np.abs(determinant), np.where(least > 0, least, 1))
    return extent


def _tangents(normals: Array) -> tuple[Array, Array]:
    """Two (n, 3) unit tangents for each normal.

    Duff et al. 2017, "Building an orthonormal basis, revisited".
    """
    x, y, z = normals.T
    sign = np.where(z >= 0, 1.0, -1.0)
    a = -1 / (sign + z)
    b = x * y * a
    return (
        np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=1),
        np.stack([b, sign + y * y * a, -y], axis=1),
    )


def _derivatives(points: Array, tangents: tuple[Array, Array], maps: Array) -> tuple[Array, Array]:
    """(2, k, n) each: derivative of x and of y, normalised coordinates, along the two tangents."""
    count = len(maps)
    rows = maps.reshape(3 * count, 4)
    x, y, w = np.moveaxis((rows[:, :3] @ points.T + rows[:, 3:]).reshape(count, 3, -1), 1, 0)
    inverse = 1 / w
    x, y = x * inverse, y * inverse
    along_x, along_y = [], []
    for tangent in tangents:
        change_x, change_y, change_w = np.moveaxis((rows[:, :3] @ tangent.T).reshape(count, 3, -1), 1, 0)
        along_x.append((change_x - x * change_w) * inverse)
        along_y.append((change_y - y * change_w) * inverse)
    return np.stack(along_x), np.stack(along_y)


def weighted_percentile(values: Array, weights: Array, percent: float) -> Array:
    """(k,) float64: the value below which `percent` of the weight of each row of (k, n) values lies."""
    order = np.argsort(values, axis=1)
    totals = np.cumsum(weights[order], axis=1)
    place = (totals < percent / 100 * totals[:, -1:]).sum(axis=1)
    picked = np.take_along_axis(order, np.minimum(place, values.shape[1] - 1)[:, None], axis=1)
    found: Array = np.take_along_axis(values, picked, axis=1)[:, 0]
    return found
