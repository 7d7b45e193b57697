#include "bench/engines/engine.h"

#include <array>

namespace throng::bench {

#ifdef THRONG_BENCH_FCL
std::unique_ptr<Engine> make_fcl(int threads);
#endif
#ifdef THRONG_BENCH_BULLET
std::unique_ptr<Engine> make_bullet(int threads);
#endif
#ifdef THRONG_BENCH_EMBREE
std::unique_ptr<Engine> make_embree(int threads);
#endif
#ifdef THRONG_BENCH_CGAL
std::unique_ptr<Engine> make_cgal(int threads);
#endif
#ifdef THRONG_BENCH_ODE
std::unique_ptr<Engine> make_ode(int threads);
#endif

namespace {

#ifdef THRONG_BENCH
[[maybe_unused]] constexpr std::string_view kMissing =
    "its package was not found: scripts/setup.sh bench";
#else
constexpr std::string_view kMissing = "not built in: cmake --preset bench";
#endif

constexpr std::array<EngineKind, 5> kKinds{{
#ifdef THRONG_BENCH_FCL
    {"fcl", make_fcl, {}},
#else
    {"fcl", nullptr, kMissing},
#endif
#ifdef THRONG_BENCH_EMBREE
    {"embree", make_embree, {}},
#else
    {"embree", nullptr, kMissing},
#endif
#ifdef THRONG_BENCH_BULLET
    {"bullet", make_bullet, {}},
#else
    {"bullet", nullptr, kMissing},
#endif
#ifdef THRONG_BENCH_CGAL
    {"cgal", make_cgal, {}},
#else
    {"cgal", nullptr, kMissing},
#endif
#ifdef THRONG_BENCH_ODE
    {"ode", make_ode, {}},
#else
    {"ode", nullptr, kMissing},
#endif
}};

}  // namespace

std::span<const EngineKind> engine_kinds() { return kKinds; }

}  // namespace throng::bench
