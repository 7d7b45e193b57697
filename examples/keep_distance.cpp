#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <random>
#include <thread>

#include "throng/end_t.hpp"
#include "throng/proximity_t.hpp"
#include "throng/step_reply_t.hpp"
#include "throng/step_request_t.hpp"

// keep_distance [SLEEP_S]: controls the robot of keep_distance.yaml, slower near people. Same
// control law and same hash as keep_distance.py.
struct Controller {
  lcm::LCM lcm{"udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152"};
  double sleep_s = 0;
  bool is_over = false;
  int64_t instance = 0;  // the followed run
  int64_t frame = -1;    // frame of the latest proximity rows
  bool is_complete = false;
  int chunks = 0;
  std::map<int, double> separation_m;  // least distance of each robot

  void on_proximity(const lcm::ReceiveBuffer*, const std::string&,
                    const throng::proximity_t* message) {
    if (message->frame != frame) {
      frame = message->frame;
      chunks = 0;
      separation_m.clear();
    }
    is_complete = ++chunks == message->chunk_count;
    for (size_t i = 0; i < message->a.size(); ++i)
      for (const int body : {message->a[i], message->b[i]}) {
        const double lo_m = message->distance_lo_m[i];
        double& min_distance_m = separation_m.try_emplace(body, lo_m).first->second;
        min_distance_m = std::min(min_distance_m, lo_m);
      }
  }

  // Full speed from 0.6 m on, zero at 0.2 m; brakes at 4 m/s2, accelerates at 1 m/s2.
  void drive(const throng::step_request_t& request, throng::step_reply_t& answer, size_t i) const {
    double ahead = request.qw[i] > request.qz[i] ? 1 : -1;  // along x or against it
    if (ahead * request.x_m[i] > 6) ahead = -ahead;         // turns at the ends
    answer.qw[i] = ahead > 0 ? 1 : 0;
    answer.qz[i] = ahead > 0 ? 0 : 1;
    const auto found = separation_m.find(request.avatar[i]);
    const double min_distance_m = found == separation_m.end() ? 0.6 : found->second;
    const double target_mps = 1.2 * std::min(std::max((min_distance_m - 0.2) / 0.4, 0.0), 1.0);
    const double last_mps = std::abs(static_cast<double>(request.vx_mps[i]));
    double speed_mps =
        std::min({std::max(target_mps, last_mps - 4.0 / 60), last_mps + 1.0 / 60, 1.2});
    speed_mps = std::max(speed_mps, 0.0);
    answer.x_m[i] += ahead * speed_mps / 60;
    answer.vx_mps[i] = static_cast<float>(ahead * speed_mps);
  }

  void on_request(const lcm::ReceiveBuffer*, const std::string&,
                  const throng::step_request_t* request) {
    if (request->is_first == 0 && !(frame == request->frame && is_complete)) {
      std::printf("frame %lld: proximity rows were lost\n", static_cast<long long>(request->frame));
      std::exit(1);
    }
    instance = request->instance;
    throng::step_reply_t answer{};
    answer.run_id = request->run_id;
    answer.instance = request->instance;
    answer.frame = request->frame;
    answer.schema = request->schema;
    answer.count = request->count;
    answer.avatar = request->avatar;
    answer.x_m = request->x_m;
    answer.y_m = request->y_m;
    answer.z_m = request->z_m;
    answer.qw = request->qw;
    answer.qx = request->qx;
    answer.qy = request->qy;
    answer.qz = request->qz;
    answer.vx_mps = request->vx_mps;
    answer.vy_mps = request->vy_mps;
    for (size_t i = 0; request->is_first == 0 && i < request->avatar.size(); ++i)
      drive(*request, answer, i);
    std::uniform_real_distribution<double> pause_s(0, std::max(sleep_s, 1e-9));
    std::random_device dice;
    std::this_thread::sleep_for(std::chrono::duration<double>(pause_s(dice)));
    lcm.publish("PICKER_REPLY", &answer);
  }

  void on_end(const lcm::ReceiveBuffer*, const std::string&, const throng::end_t* end) {
    is_over = end->instance == instance;
  }
};

int main(int argc, char** argv) {
  Controller controller;
  if (!controller.lcm.good()) return 3;
  if (argc > 1) controller.sleep_s = std::atof(argv[1]);
  controller.lcm.subscribe("THRONG_PROXIMITY", &Controller::on_proximity, &controller);
  controller.lcm.subscribe("PICKER_REQUEST", &Controller::on_request, &controller);
  controller.lcm.subscribe("THRONG_END", &Controller::on_end, &controller);
  while (!controller.is_over && controller.lcm.handle() == 0) {
  }
}
