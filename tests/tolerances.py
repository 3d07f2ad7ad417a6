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
"""Share of a scene's extent: viewpoints stand and aim on a grid of at most 6e-5, seen as flat as 15 degrees."""

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
