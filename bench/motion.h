#pragma once
/// The motion of a pair of pieces by a hand at 1 kHz: B moves 0.1-0.5 mm and turns 1-3 mrad a frame beside A,
/// in another direction every 100 frames; each frame is then moved along the normal until the gap is the
/// wanted one, which varies within the regime. Recorded once; every engine gets the same poses.

#include <cstdint>
#include <string>
#include <vector>

#include "bench/shapes.h"
#include "tactum/collision/contact.h"
#include "tactum/math/spatial.h"

namespace tactum::bench {

struct Regime {
  std::string name;
  double least_m, most_m;  ///< the gap; negative: overlap [m]
  bool cold = false;       ///< unrelated poses, no state kept between queries
  bool overlapping() const { return most_m <= 0.0; }
};

/// near 0.1-2 mm, touching 1-10 um, shallow 0.05-0.5 mm deep, far 20-60 mm, cold 0.1-2 mm.
const std::vector<Regime>& regimes();

struct Recording {
  std::vector<Pose> poses;            ///< X_AB
  std::vector<PairDistance> answers;  ///< the distances by which the gap was steered; the referee judges them
  std::vector<Twist> twists;          ///< of B in A, where the bench is about motions
};

/// The same hand with B deep in A, left alone while the overlap is 2 to 40 % of the thickness of the thinner
/// piece and pushed back into that range where it leaves it.
Recording record_deep(const Shape& a, const Shape& b, int frames, std::uint64_t seed);

/// B, on which A rests face on face, with a gap of 5-60 um, shifts by 0.03 mm and turns by 1 mrad a frame:
/// sliding, in the plane of contact; rocking, in any direction, to and fro through flat by up to 10 mrad.
enum class Rest { kSliding, kRocking };
Recording record_rest(const Shape& a, const Shape& b, Rest rest, int frames, std::uint64_t seed);

Recording record(const Shape& a, const Shape& b, const Regime& regime, int frames, std::uint64_t seed);

}  // namespace tactum::bench
