#include "bench/free_motion.h"

#ifndef TACTUM_PEER_ODE
#include <stdexcept>
#endif

namespace tactum::bench {

#ifdef TACTUM_PEER_ODE
bool has_ode() noexcept { return true; }
#else
bool has_ode() noexcept { return false; }
WorldState moved_by_ode(const FreeMotion&, double, int) { throw std::logic_error("built without ODE"); }
#endif

}  // namespace tactum::bench
