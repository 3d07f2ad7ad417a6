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
"""Wrong share times texels along the map, on random scenes: 2 at the median, 10.1 at most over 159 views,
13.7 over another 192."""

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

PATH_STEP = 1e-12
"""Metres, and elements of a rotation: differences of float64 positions up to 200 m from the origin."""

IMAGE_MOTION = 0.01
"""Relative: a turn of a pixel's angle shifts the picture by its tangent, and the middle leaves the middle."""

FAIR_SHARE = 0.03
"""Of a picture, in light and in shadow each: 0.036 measured at least, 0.018 for a lamp behind the viewer."""

NARROWEST_CONE_RAD = 1 / 1024
"""The narrowest cone is rounded up to this."""

LIGHT_VANISHES = 1e-9
"""Share of the terms of a sum that is zero: x, y and w of a warped map at the light, float64."""

RAY_ON_MAP = 1e-6
"""Normalised map coordinates along a ray, float64: lights 1e9 away after the perspective lose digits."""

FAR_BACK = 1e-4
"""Share of a square's side: perspective left when the virtual camera stands 1e6 depths back."""

CROW_WRONG_ON_OPEN = 0.02
"""Share of wrong pixels of lit faces' volumes, at least: a tree 0.055, a fence 0.054, a strip 0.028."""

CONVERGENCE = 1.5
"""Of C / N: the error of one view is as random as where its edges fall between texels; 1.3 measured."""

CONVERGENCE_FLOOR = 4e-4
"""Wrong share: a dozen pixels of 30,000, twice what a shadow volume may get wrong."""

DEPTH_MODES = 0.1
"""Relative: the two depth rows round differently along the same edges."""

EYE_PLANE = 0.2
"""Relative: property P5; between lights a tenth of a metre off the eye's plane on either side."""

FAR_BACK_ERROR = 0.2
"""Of the mean logarithm of the error over three sizes: property P7."""

FOOTPRINT = 1e-6
"""Relative: derivatives in float64, an epsilon of the size of a texel against a singular matrix."""

FOOTPRINT_DIFFERENCES = 1e-4
"""Relative: the same by differences over a millionth of a metre, in 20,000 directions."""

PROBE_AREA = 2e-5
"""Relative: float32 corners up to 20 m from zero, of triangles a metre wide; 9e-7 measured."""

PROBE_PLACE = 1e-9
"""Metres: a probe is a convex combination of corners up to 20 m from zero, in float64."""

PROBE_SHARE = 0.02
"""Relative: 200 probes of the floor for the solid angle of a view of it; 0.006 measured."""

FILTER_FRACTION = 0.035
"""Of the light: half a pixel beside the middle of a ramp, 19 to a texel, is 0.027; bytes round off 0.002."""

FILTER_ERROR_RATIO = 1.3
"""Errors of 3x3 and 4x4 against 2x2, over their radii: 0.96 to 1.06 over 18 views, 1.18 at most over six: a
wider filter also takes a larger bias."""

BACK_FACE_RIM = 0.01
"""Share of a lit body that lies within a texel of its outline and is shadowed by its back: 0.0026 at most."""

FINER = 1.0
"""Ratio of wrong pixels, a map against one of half its side, over four views: 0.48 to 0.90 measured."""

SILHOUETTE_SHARE = 0.2
"""Of the judged pixels, on maps of 256 texels and more: 0.005 to 0.11 measured over nine views of boxes."""

CORNER_TIPS = 2
"""Wrong pixels of a hybrid in a view of boxes: a corner's tip is thinner than a texel; 0 or 1 measured."""

CELL_SHARE = 0.01
"""Silhouette pixels whose cell or depth float32 puts beside where float64 does."""

HYBRID_OPEN_SHARE = 1e-3
"""Wrong pixels of a hybrid on leaf cards, fences and strips, maps of 1024 texels that casters cover: 3.9e-4
at most, where the gap is less than the bias."""

DEBUG_DISTANCE = 1e-6
"""Relative, and metres: a depth of float32 taken back through a map's matrix; 1e-7 measured."""

DEBUG_FOOTPRINT = 1e-7
"""Relative: derivatives in float64 at positions that are right to 2e-7 of their distance; 1.2e-8 measured."""

DEBUG_TEXEL_PLANE = 0.003
"""Relative: a map covers a little more than its receivers, 0.2 % measured."""

DEBUG_PLATE_EDGE = 0.02
"""Metres from a shadow's edge within which a position that is rounded to float32 may decide either way."""

DEBUG_LINE_PX = 0.75
"""Pixels: a pixel's middle is up to 0.71 off a line through it; lines are half a pixel longer at each end."""

BRUSH_VOLUME = 1e-5
"""Relative: corners of brushes up to 500 units wide are welded within 2.4e-4 units; 4e-8 is typical."""

QUAKE_VOLUME = 1e-12
"""Relative: another program's corners of the same brushes, both rounded to float32; 5e-16 measured."""

INVERSE_BIND = 1e-7
"""Of the extent: inverse bind matrices are stored as float32; 5e-9 measured on a cylinder two metres high."""

USD_BOUNDS = 1e-6
"""Relative: USD bounds a mesh by float32 corners and turns the box, exactly so for boxes; 2e-7 measured."""

USD_ROUND = 0.02
"""Relative: volume of a ball of 32 by 16 sides; 0.0160 less measured."""

CORPUS_BUDGET = 2.1
"""Factor: a place of the corpus has about half to twice the triangles that its spec asks for.

A cathedral of the fewest, 4,000, has 8,232; of 400 drawn, none had more in proportion.
"""

CORPUS_LARGEST_M = 512.0
"""Metres from the origin: float32 holds every multiple of 2^-14 m there; a harbour reaches 110."""

CORPUS_SHOWS = 0.75
"""Share of instances that show 1 % of light and of shadow: 0.79 measured; some lamps show little."""

FEATURE_MOVED = 2e-3
"""Relative and absolute: float32 rays of a moved level decide some of 4,000 places anew; 6e-4 measured."""

FEATURE_GRID = 0.03
"""Absolute: a share that is counted on 48 by 30 cells, one column being 1/48."""

FEATURE_EDGE_DISTANCE = 0.02
"""Relative: at the rim of a view 10 degrees high and 16 wide the floor is 1.4 % farther than at its foot."""

FEATURE_RAYS = 1e-3
"""Relative: places within one degree of the axis, by float32 rays."""

FEATURE_FOOTPRINT = 0.03
"""Relative: guard texels take 0.8 %, the box around the receivers and the 95th percentile the rest."""

TREE_SUM = 1e-12
"""Relative and absolute: the leaves of eighty trees added up in another order; 2e-15 measured."""

LEARNT_GAP = 0.3
"""Share of the gap: over 0.5 closed on the synthetic table, and under 0.1 with shuffled features."""

COVERAGE = 0.15
"""Share: an interval for nine in ten, calibrated on five families and asked about three."""

EYE_HEIGHT = 5e-3
"""Relative: eyes stand on a grid of 2^-14 of their distance, at most 4e-4 of their height; 2e-4 measured."""

BRUSH_SKIN = 0.05
"""Quake's units: eyes and places are rounded to 1.2e-4 of their distance, at most 64 units; 1e-4 measured."""

HALF_PAIR = 0.25
"""Half a step of means of pairs of whole numbers: the normal approximation may take the next pair."""

P_VALUE = 1e-9
"""Relative: two sums of up to 2^25 chances in float64, added up in another order."""
