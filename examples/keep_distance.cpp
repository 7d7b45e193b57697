#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <random>
#include <thread>

#include "throng/answer_t.hpp"
#include "throng/end_t.hpp"
#include "throng/near_t.hpp"
#include "throng/turn_t.hpp"

// keep_distance [SLEEP_S]: drives the robot of keep_distance.yaml, slower the nearer somebody is.
// The same law as keep_distance.py, and the same hash.
struct Controller {
  lcm::LCM lcm{"udpm://239.255.76.67:7684?ttl=0&recv_buf_size=2097152"};
  double sleep_s = 0;
  bool is_over = false;
  int64_t instance = 0;  // of the run
  int64_t frame = -1;    // of the newest near rows
  bool is_whole = false;
  int chunks = 0;
  std::map<int, double> separation_m;  // how near each robot has somebody

  void on_near(const lcm::ReceiveBuffer*, const std::string&, const throng::near_t* near) {
    if (near->frame != frame) {
      frame = near->frame;
      chunks = 0;
      separation_m.clear();
    }
    is_whole = ++chunks == near->chunk_count;
    for (size_t i = 0; i < near->a.size(); ++i)
      for (const int body : {near->a[i], near->b[i]}) {
        const double lo_m = near->lo_m[i];
        double& nearest_m = separation_m.try_emplace(body, lo_m).first->second;
        nearest_m = std::min(nearest_m, lo_m);
      }
  }

  // Full speed from 0.6 m on, none at 0.2 m; brakes with 4 m/s2, gets faster with 1 m/s2.
  void drive(const throng::turn_t& turn, throng::answer_t& answer, size_t i) const {
    double ahead = turn.qw[i] > turn.qz[i] ? 1 : -1;  // along x or against it
    if (ahead * turn.x_m[i] > 6) ahead = -ahead;      // it turns at the ends
    answer.qw[i] = ahead > 0 ? 1 : 0;
    answer.qz[i] = ahead > 0 ? 0 : 1;
    const auto found = separation_m.find(turn.avatar[i]);
    const double nearest_m = found == separation_m.end() ? 0.6 : found->second;
    const double wanted_mps = 1.2 * std::min(std::max((nearest_m - 0.2) / 0.4, 0.0), 1.0);
    const double last_mps = std::abs(static_cast<double>(turn.vx_mps[i]));
    double speed_mps =
        std::min({std::max(wanted_mps, last_mps - 4.0 / 60), last_mps + 1.0 / 60, 1.2});
    speed_mps = std::max(speed_mps, 0.0);
    answer.x_m[i] += ahead * speed_mps / 60;
    answer.vx_mps[i] = static_cast<float>(ahead * speed_mps);
  }

  void on_turn(const lcm::ReceiveBuffer*, const std::string&, const throng::turn_t* turn) {
    if (turn->is_first == 0 && !(frame == turn->frame && is_whole)) {
      std::printf("frame %lld: near rows were lost\n", static_cast<long long>(turn->frame));
      std::exit(1);
    }
    instance = turn->instance;
    throng::answer_t answer{};
    answer.run_id = turn->run_id;
    answer.instance = turn->instance;
    answer.frame = turn->frame;
    answer.schema = turn->schema;
    answer.count = turn->count;
    answer.avatar = turn->avatar;
    answer.x_m = turn->x_m;
    answer.y_m = turn->y_m;
    answer.z_m = turn->z_m;
    answer.qw = turn->qw;
    answer.qx = turn->qx;
    answer.qy = turn->qy;
    answer.qz = turn->qz;
    answer.vx_mps = turn->vx_mps;
    answer.vy_mps = turn->vy_mps;
    for (size_t i = 0; turn->is_first == 0 && i < turn->avatar.size(); ++i) drive(*turn, answer, i);
    std::uniform_real_distribution<double> pause_s(0, std::max(sleep_s, 1e-9));
    std::random_device dice;
    std::this_thread::sleep_for(std::chrono::duration<double>(pause_s(dice)));
    lcm.publish("PICKER_ANSWER", &answer);
  }

  void on_end(const lcm::ReceiveBuffer*, const std::string&, const throng::end_t* end) {
    is_over = end->instance == instance;
  }
};

int main(int argc, char** argv) {
  Controller controller;
  if (!controller.lcm.good()) return 3;
  if (argc > 1) controller.sleep_s = std::atof(argv[1]);
  controller.lcm.subscribe("THRONG_NEAR", &Controller::on_near, &controller);
  controller.lcm.subscribe("PICKER_TURN", &Controller::on_turn, &controller);
  controller.lcm.subscribe("THRONG_END", &Controller::on_end, &controller);
  while (!controller.is_over && controller.lcm.handle() == 0) {
  }
}
