#include <chrono>
#include <cmath>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <thread>

#include "throng/pose_command_t.hpp"

// lcm_control_example CHANNEL AVATAR SECONDS: moves an avatar in a circle of 3 m, at 1 m/s.
int main(int argc, char** argv) {
  lcm::LCM lcm("udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152");
  if (argc != 4 || !lcm.good()) return 3;
  throng::pose_command_t m{};
  m.schema = 1;
  m.count = 1;
  m.avatar = {std::atoi(argv[2])};
  for (; m.seq < int64_t{50} * std::atoi(argv[3]); ++m.seq) {
    const double angle = static_cast<double>(m.seq) / 50 / 3;
    m.x_m = {3 * std::cos(angle)};
    m.y_m = {3 * std::sin(angle)};
    m.z_m = {0};
    m.qw = {static_cast<float>(std::cos(angle / 2 + M_PI / 4))};  // along the circle
    m.qz = {static_cast<float>(std::sin(angle / 2 + M_PI / 4))};
    m.qx = m.qy = {0};
    m.vx_mps = {static_cast<float>(-std::sin(angle))};
    m.vy_mps = {static_cast<float>(std::cos(angle))};
    lcm.publish(argv[1], &m);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}
