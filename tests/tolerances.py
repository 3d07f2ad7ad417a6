RAY_EDGE = 1e-4
"""Share of its distance by which a probe stands off a shadow's edge: a hundred offsets of the ray caster."""

RAY_DISTANCE = 1e-5
"""Relative: float32 steps of 6e-8 of a scene's extent, seen from a tenth of it, a few times over."""

RAY_HAIR = 3e-6
"""Share of a scene's extent within which float32 rays may decide differently: three caster offsets."""

RAY_MISMATCH_SHARE = 2e-3
"""Share of rays on which Embree and float64 brute force may differ: 3e-6 measured; three of 1500 here."""

QUATERNION = 1e-15
"""Absolute: a rotation matrix from a quaternion whose components are themselves rounded to float64."""

EDGE_ENDS = 0.02
"""Relative: an edge of some 200 pixels gains or loses up to two where the picture or the domain ends."""

DISC_STEPS = 0.02
"""Relative: a disc of 20 pixels and more against the mean over all angles, and its area in whole pixels."""

NEGATIVE_MASK = 1e-7
"""Relative: one minus a float32 fraction is rounded to float32."""

FLOAT32_PICTURE = 1e-5
"""Relative: sRGB decoded in float64 by the test and through a float32 table by the code under test."""

WORLD_POSITION = 1e-14
"""Share of a level's extent: an independent reader adds up its matrices in another order; 4e-17 measured."""

VIEWED = 1e-4
"""Share of a scene's extent: viewpoints stand on a grid of at most 6e-5, seen as flat as 15 degrees."""

UNIT = 1e-14
"""Absolute: lengths and products of unit vectors, a few float64 roundings off."""

VOLUME_ROUNDING = 1e-12
"""Relative: a volume is a sum of at most a few hundred float64 products."""

ROTATION = 1e-14
"""Absolute, per element of a rotation: a handful of float64 products of numbers up to 1."""

PROJECTION = 1e-14
"""Relative: a projection is three float64 operations per coordinate."""

CONVEX_CORNER = 1e-12
"""Relative to the body's size: three planes that meet at wide angles, in float64."""

CONVEX_AGAINST_QHULL = 1e-5
"""Relative to the body's size: random planes may meet at angles of 1e-6, and qhull merges near corners."""

CONE_EDGE = 1e-9
"""Relative: points this near to a cone's edge may count as inside or outside."""

REACH_PLANE = 1e-12
"""Metres, for scenes of 100 m: the rounding of a plane's equation in float64."""

MAP_PLACE = 1e-9
"""Normalised map coordinates: corners of the receivers' body are right to 1e-9 of its size."""

GRAZING = 0.02
"""Cosine of the light's incidence below which float32 positions decide on which side of an edge they lie."""

VOLUME_WRONG_SHARE = 2e-4
"""Wrong pixels of shadow volumes against rays: edges snapped to 1/256 pixel; 1.1e-5 measured on 120 views."""

VOLUME_END_SHARE = 2e-5
"""Pixels that change when volumes run to infinity: 0 of 2 million measured; sides are rounded otherwise."""

ON_EDGE_PX = 1 / 256
"""The grid to which rasterisers snap vertices: nearer than this a pixel's middle lies on an edge; 4 pixels
of 5.2 million do where a volume's side starts from the surface seen, 0.0014 pixel off at most."""

PACKED_NORMAL = 8e-5
"""Distance of unit vectors: two numbers each off by 1.5e-5, stretched by up to 3 amid a face; 6e-5 found."""

VIEW_DEPTH = 2e-7
"""Share of the distance from the eye: three steps of float32; 1.5e-7 measured, on faces of up to 200 m."""

DEPTH_POSITION = 5e-7
"""Share of size and distance: float32 view depth, and float32 vertices of the plane that is seen."""

PIXEL_MIDDLE = 1e-9
"""Pixels: positions are rebuilt along the very ray, in float64."""

OUTLINE_SHARE = 0.005
"""Pixels whose middle lies within 1/256 pixel of an edge: of 6,144 pixels, 2,000 of them on edges, 16."""

DOMAIN_EDGE = 1e-4
"""Relative, of distances and cosines: float32 positions decide on the very edge of cone, range or horizon."""

EXACT_EDGE = 1e-3
"""Metres, for a floor of 12 m seen from 7 m: a pixel's grid of 1/256 is 2e-4 m there, seen at an angle."""

SAMPLED_EDGE_TEXELS = 3.0
"""Sides of a texel that is the whole extent over the map's side: one for sampling, one for the filter and the
bias, and one because six faces spend a third of theirs elsewhere."""

SAMPLED_WRONG = 25.0
"""Wrong share times texels along the map, on random scenes: 5 on average, 13.7 at most over 192 views."""

MOVED_SHARE = 1e-3
"""Pixels of a mask that may change when all moves: float64 positions are rounded otherwise."""

MAP_EXPONENT = 0.15
"""A shadow's edge is off by a share of a texel, so error falls as 1/N. At N = 4096 only some 100 pixels are
left wrong, and their number is as random as that: -0.97, -1.08 and -1.09 measured."""

SEAM_RATIO = 2.0
"""Some 20 wrong pixels lie beside seams, give or take 5; over 12 times as many views the ratio is 0.74."""

FOCUS_RATIO = 1.1
"""A map focused on the view has texels no larger than one for the whole light, but they fall elsewhere."""

GOLDEN_LEVELS = 2
"""Of 255: other versions of Mesa and LLVM, and CPUs with wider vectors, round colours otherwise."""

GOLDEN_SHARE = 2e-3
"""Pixels on edges that another rounding may move; a wrong bias or a lost caster moves whole percents."""
