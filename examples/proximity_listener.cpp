#include <cstdio>
#include <lcm/lcm-cpp.hpp>

#include "throng/proximity_t.hpp"

static void on_proximity(const lcm::ReceiveBuffer*, const std::string&,
                         const throng::proximity_t* m, void*) {
  for (size_t i = 0; i < m->a.size(); ++i)
    std::printf("%.3f s: part %d of %d and part %d of %d are %.3f to %.3f m apart\n",
                static_cast<double>(m->utime) * 1e-6, m->part_a[i], m->a[i], m->part_b[i], m->b[i],
                static_cast<double>(m->distance_lo_m[i]), static_cast<double>(m->distance_hi_m[i]));
}

int main() {
  lcm::LCM lcm("udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152");
  if (!lcm.good()) return 3;
  lcm.subscribeFunction("THRONG_PROXIMITY", on_proximity, static_cast<void*>(nullptr));
  while (lcm.handle() == 0) std::fflush(stdout);
}
