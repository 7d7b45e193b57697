// The box of parts.
#include "base/errors.h"
#include "base/limits.h"
#include "crowd/crowd_plan.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

/// Of a box: its parts are as large as hands.
constexpr Range kEdgeRange{0.1, kMaxEdge_m};
/// Of what flies in a box: speed in m/s, spin in rad/s.
constexpr Range kFlightRange{0, 100};

/// Each part flies by itself, about its middle.
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
          {whole("count", "how many parts", &PartsBox::count, 1, kMaxBodies).required(),
           number(
               "edge_m",
               "the cube spans half of it to all sides of the origin, and from the floor up; 0.1 "
               "to 1000",
               &PartsBox::edge_m, kEdgeRange)
               .required(),
           whole("static_every", "every n-th part stands still; 0: none", &PartsBox::static_every,
                 0, kMaxBodies),
           number("max_spin_radps", "spins are uniform up to it", &PartsBox::max_spin_radps,
                  kFlightRange),
           number("min_speed_mps", "speeds are uniform from it up", &PartsBox::min_speed_mps,
                  kFlightRange),
           number("max_speed_mps", "speeds are uniform up to it", &PartsBox::max_speed_mps,
                  kFlightRange),
           custom_key<PartsBox>("model",
                                "whose parts: `adult`, or a URDF file relative to the scene file",
                                "`adult`", {})
               .with_reader(read_box_model)
               .with_hash([](Hasher& hash, const PartsBox& box) {
                 hash.add(box.body == nullptr ? 0 : box.body->content_hash);
               })},
      .complete = complete_box};
  return table;
}

}  // namespace throng
