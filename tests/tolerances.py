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
"""Share of a scene's extent: viewpoints stand and aim on a grid of 1.5e-5, seen as flat as 15 degrees."""

UNIT = 1e-14
"""Absolute: lengths and products of unit vectors, a few float64 roundings off."""
