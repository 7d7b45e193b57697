#include <cstdio>
#include <lcm/lcm-cpp.hpp>

#include "throng/events_t.hpp"

static void on_events(const lcm::ReceiveBuffer*, const std::string&, const throng::events_t* m,
                      void*) {
  for (size_t i = 0; i < m->a.size(); ++i)
    std::printf("%.3f s: part %d of %d %s part %d of %d\n", static_cast<double>(m->utime) * 1e-6,
                m->part_a[i], m->a[i], m->kind[i] == 0 ? "touches" : "leaves", m->part_b[i],
                m->b[i]);
}

int main() {
  lcm::LCM lcm("udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152");
  if (!lcm.good()) return 3;
  lcm.subscribeFunction("THRONG_EVENTS", on_events, static_cast<void*>(nullptr));
  while (lcm.handle() == 0) std::fflush(stdout);
}
