// Keys of `box`.
#include "base/errors.h"
#include "base/limits.h"
#include "crowd/crowd_plan.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

/// Edge length of the box in metres; its parts have the size of hands.
constexpr Range kEdgeRange{0.1, kMaxEdge_m};
/// Speed in m/s and spin in rad/s of a flying part.
constexpr Range kFlightRange{0, 100};

void require_parts_of_size(const Fields& fields, const Model& body) {
  for (const Part& part : body.parts)
    for (const Eigen::Vector3f& vertex : part.mesh.vertices)
      if (!(static_cast<double>(vertex.norm()) <= kMaxReach_m))
        throw InputError(
            fields.where(),
            fmt::format("a model with all vertices within {:g} m of their links", kMaxReach_m),
            fmt::format("one at {:g} m in '{}'; is it in other units?", vertex.norm(), part.name));
}

void read_box_model(ReadContext& context, Fields& fields, PartsBox& box) {
  box.model = read_model_file(context, fields);
  std::shared_ptr<const Model>& body = context.bodies[box.model.string()];
  if (body == nullptr) body = load_model(box.model);
  box.body = body;
  require_parts_of_size(fields, *box.body);
}

void complete_box(ReadContext&, const Fields& fields, PartsBox& box) {
  if (box.min_speed_mps > box.max_speed_mps)
    throw InputError(fields.where(), "min_speed_mps of at most max_speed_mps",
                     fmt::format("{} and {}", box.min_speed_mps, box.max_speed_mps));
}

}  // namespace

const KeyTable<PartsBox>& box_keys() {
  static const KeyTable<PartsBox> table = {
      .text = {.name = "box", .meaning = "Loose parts of a model that fly in a closed cube"},
      .title = "a box",
      .keys =
          {whole("count", "number of parts", &PartsBox::count, 1, kMaxBodies).required(),
           number("edge_m",
                  "edge length of the cube, in metres, 0.1 to 1000; it is centred above the origin "
                  "and stands on the ground",
                  &PartsBox::edge_m, kEdgeRange)
               .required(),
           whole("static_every", "every n-th part stands still; 0: none", &PartsBox::static_every,
                 0, kMaxBodies),
           number("max_spin_radps", "upper limit of the uniform distribution of spins, in rad/s",
                  &PartsBox::max_spin_radps, kFlightRange),
           number("min_speed_mps", "lower limit of the uniform distribution of speeds, in m/s",
                  &PartsBox::min_speed_mps, kFlightRange),
           number("max_speed_mps", "upper limit of the uniform distribution of speeds, in m/s",
                  &PartsBox::max_speed_mps, kFlightRange),
           custom_key<PartsBox>(
               "model",
               "body model of the parts: `adult`, or a URDF file relative to the scene file",
               "`adult`", {})
               .with_reader(read_box_model)
               .with_hash([](Hasher& hash, const PartsBox& box) {
                 hash.add(box.body == nullptr ? 0 : box.body->content_hash);
               })},
      .complete = complete_box};
  return table;
}

}  // namespace throng
