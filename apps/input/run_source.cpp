#include "apps/input/run_source.h"

#include <fmt/format.h>

#include "apps/output/output_plan.h"
#include "base/errors.h"
#include "crowd/steering/steering.h"
#include "culling/culler.h"

namespace throng {
namespace {

void plan_model(const Model* model, OutputPlan& plan) {
  if (model == nullptr) return;
  for (const Link& link : model->robot.links)
    for (const std::vector<Geometry>* shapes : {&link.collision, &link.visual})
      for (const Geometry& shape : *shapes) plan.reads("a mesh of the scene", shape.mesh_file);
}

}  // namespace

void add_run_source_options(CommandOptions& app, RunSourceOptions& options) {
  app.add_option("FILE", options.name,
                 "A scene file, a name from `throng scenes`, a recording, or a log")
      ->required();
  app.add_option("--avatars", options.avatars, "People in all; scales the scene's groups")
      ->check(whole_option(1, PairKey::kMaxId, "a whole number from 1 to 16777215"))
      ->type_name("N");
  app.add_option("--seconds", options.seconds, "Simulated time instead of the scene's")
      ->check(number_option(0, 1e7, true, "a number of seconds above 0"))
      ->type_name("S");
  app.add_option("--seed", options.seed, "Start of all random numbers instead of the scene's")
      ->check(whole_option(0, INT64_MAX, "a whole number from 0"))
      ->type_name("N");
  app.add_option("--part-volume", options.part_volume,
                 "What encloses a body part; or by part, 'hands: sphere, default: ordop26'")
      ->check([](const std::string& text) -> std::string {
        try {
          part_volumes_of(text, "");
          return "";
        } catch (const InputError& error) {
          return std::string(error.what()).substr(std::string(": ").size());
        }
      })
      ->type_name("VOLUME");
  app.add_option("--steering", options.steering,
                 steering_choices() + "; instead of the scene's model")
      ->check(name_option(steering_names()))
      ->type_name("MODEL");
  app.add_flag("--exact", options.exact, "Triangles decide what touches, and how near");
  const auto add_margin = [&app](const char* name, std::optional<double>& margin_m,
                                 const char* what) {
    app.add_option(name, margin_m, what)
        ->check(number_option(0, static_cast<double>(kMostNear_m), false,
                              fmt::format("metres from 0 to {}", kMostNear_m)))
        ->type_name("M");
  };
  add_margin("--near", options.near_m, "Distances of all parts that are nearer than M metres");
  add_margin("--person-near", options.person_near_m,
             "Of each two people nearer than M metres the nearest parts");
  app.add_flag("--contact-points", options.contact_points,
               "Of all parts that touch a point, direction and depth; needs --exact");
  app.add_option("--between", options.between,
                 "Pairs of these groups alone, as in 'robots: people'; a name alone is with all")
      ->type_name("A:B");
  app.add_option("--parts", options.parts,
                 "Pairs of these parts alone, as in 'hands: head'; words alone are with all parts")
      ->type_name("PARTS");
  add_recording_options(app, options.recording);
  app.add_option("--step", options.step,
                 "Of a recording: recorded, its frames alone, or smooth, at most 1/60 s [smooth]")
      ->check(name_option(step_names()))
      ->type_name("STEP");
}

void plan_inputs(const Scene& scene, OutputPlan& plan) {
  plan.reads("the scene", scene.file);
  if (scene.recorded) plan.reads("the recording of the scene", scene.recorded->options.file);
  for (const Group& group : scene.groups) {
    plan.reads("a model of the scene", group.model);
    plan_model(group.body.get(), plan);
  }
  for (const Obstacle& obstacle : scene.obstacles)
    plan.reads("an obstacle of the scene", obstacle.mesh_file);
  if (!scene.box) return;
  plan.reads("the model of the scene", scene.box->model);
  plan_model(scene.box->body.get(), plan);
}

}  // namespace throng
