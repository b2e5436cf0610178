#pragma once
/// Every epsilon of the library, with the reason for its value. Lengths are relative: multiply by the size of
/// the part (the diagonal of its bounding box), unless the name ends in a unit. No other file may hold a
/// literal epsilon.

namespace tactum::inline v0_1::tolerances {

/// Points of one facet lie in its plane to this much of the size. Qhull's own coordinates are good to a few
/// 1e-16; merging facets that are less planar than this gives wrong distances, leaving planar ones apart does
/// too.
inline constexpr double kCoplanar = 1e-12;

/// A corner whose two edges are straight to this much (height over the chord, relative to the size) is no
/// corner.
inline constexpr double kCollinear = 1e-12;

/// A closest-feature answer is certified when the support planes' separation agrees with the distance of its
/// witness points to this much of the size of the pair. Raise it and wrong features pass; lower it and
/// rounding of far-away coordinates sends good answers to the fallback.
inline constexpr double kCertificate = 1e-9;

/// Voronoi planes are crossed only when a point is beyond them by this much of the size, so that a point on
/// a plane does not walk to and fro. A few roundings: at 1e-13 the walk stopped short beside gaps of 1e-8,
/// where a point 1e-13 off its region means a normal 1e-5 off.
inline constexpr double kVoronoiTolerance = 1e-15;

/// Below this fraction of the size a vector between witness points no longer has a direction of its own.
inline constexpr double kTouching = 1e-12;

/// Two directions are parallel when the sine of their angle is below this: the cross product of unit vectors
/// keeps about eight digits there.
inline constexpr double kParallelSine = 1e-8;

/// Edges cross at an angle when its sine is above this: all that follows from their cross and dot products is
/// then right to kCrossingRounding of the lengths over the sine squared, a thousandth of the certificate.
/// Lower, and the error bound grows beyond what careful means would leave.
inline constexpr double kCrossingSine = 0.1;
/// ... as a cross product of unit vectors has an error of some 4 roundings (1.1e-16), and the places along
/// the edges one of some 16 of their terms.
inline constexpr double kCrossingRounding = 1e-14;

/// Arcs of two edges on the Gauss map are one arc when their planes differ by less than this angle: the
/// remainder of a crossing is then smaller than the certificate can detect.
inline constexpr double kSameArc = 1e-12;

/// A face (edge) takes part in a contact patch when its plane (line) is within this angle [rad] of square to
/// the normal: 2 degrees. Below half of it the patch is whole, above it is none, between it shrinks to the
/// nearest point, so that the hand feels no step. Smaller, and a nearly flat contact jumps; larger, and a
/// sharp edge feels blunt.
inline constexpr double kPatchAngle = 0.035;

/// Planes are those of one supporting plane of a Minkowski facet when they differ by less than this angle
/// [rad].
inline constexpr double kSamePlane = 1e-8;

/// A patch with less area than this fraction of the squared size is a line.
inline constexpr double kPatchArea = 1e-14;

/// A time of impact is found when the distance is above its target by less than this fraction of the size. A
/// lower value costs steps: each halves the rest, at worst.
inline constexpr double kImpactGap = 1e-7;

/// The search for how far a path is free ends at this fraction of the path before what it meets: the next
/// frame begins there, at a gap that is as small a part of the step.
inline constexpr double kPathEnd = 1e-4;

/// The rounding error of a determinant of three differences of points, as a fraction of the sum of the
/// products' magnitudes [Shewchuk 1997].
inline constexpr double kDeterminantError = 7.8e-16;

/// Vertices nearer than this fraction of the mesh's size are one vertex. STL stores single precision (6e-8).
inline constexpr double kWeld = 1e-9;

/// A triangle thinner than this (height over its longest edge) has no usable normal.
inline constexpr double kDegenerateTriangle = 1e-10;

/// A closed surface encloses nothing when its volume is below this fraction of its diagonal cubed: the
/// rounding of a million tetrahedra that cancel is 1e-13; a sheet of paper, 0.1 mm in a metre square, has
/// 3e-5.
inline constexpr double kNoVolume = 1e-12;

/// The pieces of a part lie on its mesh, and the mesh on the pieces, to this fraction of the size:
/// preparation is checked against it. Above the dropping of zero areas (kDegenerateTriangle) and the
/// planarity of merged faces, and far below a micrometre in a metre.
inline constexpr double kSurfaceDeviation = 1e-9;

/// Edges of a mesh count as convex when the far vertex stays below the neighbour's plane by this fraction of
/// the size.
inline constexpr double kConvexMesh = 1e-9;

/// The contact solver has converged when a sweep changes no normal velocity by more than this fraction of the
/// largest one wanted: a force error far below what a hand or a device resolves (1e-3).
inline constexpr double kContactVelocity = 1e-6;

/// Resting contacts are settled when a sweep changes no velocity by more than this [m/s]. The rest is not
/// lost: the next frame continues from there, so a heap at rest converges to rounding in the end.
inline constexpr double kRestingVelocity = 1e-8;

/// ... plus this fraction of the fastest body's velocity. Where something slides, sweeps may never come
/// nearer: impulses then grow against each other while velocities stay.
inline constexpr double kSlidingVelocity = 3e-5;

/// ... and, where all bodies are solved for at once, plus this fraction of what forces have displaced the
/// bodies at the contact: nothing is missing then beyond the last change. A hundred times as much, and what
/// stands does not come to rest to the last digit.
inline constexpr double kNewtonSettled = 1e-5;

/// The friction of a sliding patch has settled when it changes by less than this fraction of mu N from one
/// answer to the next.
inline constexpr double kSameFriction = 1e-6;

/// Friction at so little less than mu N, as a fraction, slides: sweeps reach the bound only up to rounding.
inline constexpr double kAtFrictionBound = 1e-9;

/// In an impact, velocities of less than this fraction of the approach count as zero, and energies are the
/// same when they differ by less.
inline constexpr double kImpactSettled = 1e-10;

/// A direction in which less than this fraction of a body's mobility is left, once the directions found
/// before are subtracted, has none: a hinge's mobility is of rank one, but for rounding.
inline constexpr double kNoMobility = 1e-12;

/// A row of a quadratic program depends on the active ones when less than this fraction of it is linearly
/// independent of them: the corners of one face have the same row up to rounding, and a row that differed
/// from them by less could only be kept by forces that are as many times too large.
inline constexpr double kDependentRow = 1e-7;

/// A row of the contact problem is kept when it is missed by no more than this [m]: the forces are then right
/// to 1e-9 N, and no gap changes by a measurable amount.
inline constexpr double kRowKept_m = 1e-12;

/// The gap at which the constraint response keeps contacts, as a fraction of the largest moving part's size.
/// Some thousand times the certificate, so that a validated pose is open beyond any error bound; a tenth of
/// the tightest fit of engineering.
inline constexpr double kSkin = 5e-6;

/// A pair overlaps when its depth exceeds this fraction of the sizes of both, of parts in a frame and of
/// pieces in preparation: a smaller depth is within the error of the certificate.
inline constexpr double kPenetrating = 1e-9;

/// The normal cones of features are widened by this angle [rad] in the search for contacts: with the true
/// cones only the lowest corner of a flat contact counts, and sliding over a plane of many pieces sticks. It
/// is the turn of a part of 7.5 mm radius in a step of 0.03 mm. A part may turn farther: then contacts may be
/// missing among the rows, and the tests of the step on trial refuse it.
inline constexpr double kConeInflation = 0.004;

/// Unit normals that differ by less than this are one: a corner's mean normal is then the face's own, to the
/// bit.
inline constexpr double kSameNormal = 1e-9;

/// The area by which a contact point is weighted when it has one facet's stiffness together with patches:
/// small against any patch a hand can feel (a tenth of a millimetre squared is 1e-8), so it counts only where
/// it is alone [m^2].
inline constexpr double kPointArea_m2 = 1e-14;

/// ... and the width of a segment, so that its stretches are weighted by length: a millimetre counts as ten
/// points [m].
inline constexpr double kLineWidth_m = 1e-10;

/// ... and the weight of a segment without length, so that fractions are always defined [m^2].
inline constexpr double kLeastWeight_m2 = 1e-24;

/// A corner of a polygon face turns the wrong way only beyond this (cross product over the square of the
/// polygon's extent): single-precision corners on a straight side turn by 1e-7 either way, and a fan over
/// them is right.
inline constexpr double kPolygonTurn = 1e-6;

/// Neighbouring triangles of a mesh belong to one flat face when the sine between their normals is below
/// this. CAD files hold six to seven digits, so the normals of one wall differ by about 1e-6 over its size
/// and more on slivers; facets of a finely meshed cylinder (a thousand around) differ by 6e-3 and stay apart.
inline constexpr double kCoplanarMeshSine = 1e-5;

/// ... and when the corners lie in the face's plane to this much of the mesh's size. Without it a slowly
/// turning row of triangles would pass for flat, one pair at a time.
inline constexpr double kCoplanarMeshOffset = 1e-6;

/// Noise of coordinates stored in single precision. It turns the normal of a sliver by noise over height, so
/// slivers within a flat face are allowed that much more than kCoplanarMeshSine.
inline constexpr double kStoredNoise = 1.2e-7;

/// Box tests grow the boxes by this fraction of their size, so that rounding of the rotated axes never
/// separates boxes that touch.
inline constexpr double kBoxMargin = 1e-14;

/// The error of bounds that are kept in single precision (6e-8 a number, a few in a row), as a fraction of
/// the size for lengths and in radians for angles: such bounds are grown by this, so that no pair is lost.
inline constexpr double kSingle = 1e-6;

/// Squared angle [rad^2] below which sin(a)/a and its kin are taken from their series: exact to the last bit
/// there.
inline constexpr double kSmallAngleSquared = 1e-3;

/// Squared sine of a half angle below which five terms of a series are the arc of the sine, to rounding: a
/// turn of 3.6 degrees, more than any frame's.
inline constexpr double kSmallHalfAngleSineSquared = 1e-3;

/// A matrix read from a file is a rotation when every entry of R R^T - I is below this: sixteen decimals.
inline constexpr double kRotationExact = 1e-9;

/// ... and is made orthonormal, with a report to the reader, when below this: six decimals, as many programs
/// write.
inline constexpr double kRotationNear = 1e-4;

/// The iteration to the nearest rotation stops when no entry changes by more than this. It converges
/// quadratically, so the next change would be the square of it: below rounding.
inline constexpr double kRotationConverged = 1e-9;

/// A quaternion read from a file is normalised when its length is this near to one: four decimals, as motion
/// capture writes, leave 2e-4. Farther off, the columns are not a quaternion.
inline constexpr double kQuaternionNear = 1e-3;

/// A part is about its centre of mass when its origin is this near to it: a micrometre in a metre, far below
/// the weight difference that a hand can feel, far above the error of a mesh's volume integrals.
inline constexpr double kCentered = 1e-6;

/// A joint between two bodies is closed when its points are apart by no more than this fraction of the body's
/// size, and its axes by no more than this angle [rad]: some roundings, so that no error adds up.
inline constexpr double kJointClosed = 1e-14;

}  // namespace tactum::inline v0_1::tolerances
