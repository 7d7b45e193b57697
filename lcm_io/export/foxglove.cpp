#include "lcm_io/export/foxglove.h"

#include <fmt/format.h>

#include "base/text.h"

namespace throng::foxglove {

#define THRONG_TIME \
  R"({"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}})"
#define THRONG_VECTOR \
  R"({"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}})"
#define THRONG_QUATERNION \
  R"({"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}}})"
#define THRONG_COLOUR \
  R"({"type":"object","properties":{"r":{"type":"number"},"g":{"type":"number"},"b":{"type":"number"},"a":{"type":"number"}}})"
#define THRONG_POSE                                             \
  R"({"type":"object","properties":{"position":)" THRONG_VECTOR \
  R"(,"orientation":)" THRONG_QUATERNION "}}"
#define THRONG_LIST(name) "\"" name R"(":{"type":"array","items":{"type":"object"}})"

const char* const kFrameTransformsSchema =
    R"({"title":"foxglove.FrameTransforms","type":"object","properties":{"transforms":{"type":"array","items":)"
    R"({"type":"object","title":"foxglove.FrameTransform","properties":{"timestamp":)" THRONG_TIME
    R"(,"parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},"translation":)" THRONG_VECTOR
    R"(,"rotation":)" THRONG_QUATERNION "}}}}}";

const char* const kSceneUpdateSchema =
    R"({"title":"foxglove.SceneUpdate","type":"object","properties":{"deletions":{"type":"array","items":)"
    R"({"type":"object","title":"foxglove.SceneEntityDeletion","properties":{"timestamp":)" THRONG_TIME
    R"(,"type":{"type":"integer"},"id":{"type":"string"}}}},"entities":{"type":"array","items":)"
    R"({"type":"object","title":"foxglove.SceneEntity","properties":{"timestamp":)" THRONG_TIME
    R"(,"frame_id":{"type":"string"},"id":{"type":"string"},"lifetime":)" THRONG_TIME
    R"(,"frame_locked":{"type":"boolean"},)" THRONG_LIST("metadata") "," THRONG_LIST("arrows") "," THRONG_LIST(
        "cubes") R"(,"spheres":{"type":"array","items":{"type":"object","properties":{"pose":)" THRONG_POSE
    R"(,"size":)" THRONG_VECTOR R"(,"color":)" THRONG_COLOUR
    R"(}}},"triangles":{"type":"array","items":{"type":"object","properties":{"pose":)" THRONG_POSE
    R"(,"points":{"type":"array","items":)" THRONG_VECTOR R"(},"color":)" THRONG_COLOUR
    R"(,"colors":{"type":"array","items":)" THRONG_COLOUR
    R"(},"indices":{"type":"array","items":{"type":"integer"}}}}},)" THRONG_LIST(
        "cylinders") "," THRONG_LIST("lines") "," THRONG_LIST("texts") "," THRONG_LIST("models") "}}}}}";

const char* const kContactSchema =
    R"({"title":"throng.Contact","type":"object","properties":{"frame":{"type":"integer"},"time_s":{"type":"number"},)"
    R"("kind":{"type":"string","enum":["begin","end"]},"body_a":{"type":"integer"},"body_b":{"type":"integer"},)"
    R"("name_a":{"type":"string"},"name_b":{"type":"string"},"part_a":{"type":"string"},"part_b":{"type":"string"}}})";

std::string json_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      append(out, "\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + "\"";
}

std::string json_time(int64_t utime_us) {
  return fmt::format(R"({{"sec":{},"nsec":{}}})", utime_us / 1'000'000,
                     utime_us % 1'000'000 * 1000);
}

void add_transform(std::string& json, int64_t utime_us, std::string_view frame,
                   const Eigen::Isometry3d& world_from_frame) {
  const Eigen::Vector3d& t = world_from_frame.translation();
  const Eigen::Quaterniond q(world_from_frame.linear());
  append(
      json,
      R"({}{{"timestamp":{},"parent_frame_id":"world","child_frame_id":{},"translation":{{"x":{:.4f},"y":{:.4f},)"
      R"("z":{:.4f}}},"rotation":{{"x":{:.5f},"y":{:.5f},"z":{:.5f},"w":{:.5f}}}}})",
      json.ends_with('}') ? "," : "", json_time(utime_us), json_text(frame), t.x(), t.y(), t.z(),
      q.x(), q.y(), q.z(), q.w());
}

namespace {

std::string json_colour(const Colour& colour) {
  return fmt::format(R"({{"r":{:g},"g":{:g},"b":{:g},"a":{:g}}})", colour.r, colour.g, colour.b,
                     colour.a);
}

std::string pose_at(const Eigen::Vector3d& at_m) {
  return fmt::format(
      R"({{"position":{{"x":{:.4f},"y":{:.4f},"z":{:.4f}}},"orientation":{{"x":0,"y":0,"z":0,"w":1}}}})",
      at_m.x(), at_m.y(), at_m.z());
}

}  // namespace

std::string entity(int64_t utime_us, std::string_view frame, std::string_view id,
                   const std::string& shapes) {
  std::string out = fmt::format(
      R"({{"timestamp":{},"frame_id":{},"id":{},"lifetime":{{"sec":0,"nsec":0}},"frame_locked":true)",
      json_time(utime_us), json_text(frame), json_text(id));
  for (const char* list : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                           "triangles", "texts", "models"})
    if (!shapes.starts_with(fmt::format("\"{}\"", list))) append(out, ",\"{}\":[]", list);
  return out + "," + shapes + "}";
}

std::string sphere(const Eigen::Vector3d& centre_m, double diameter_m, const Colour& colour) {
  return fmt::format(
      R"("spheres":[{{"pose":{},"size":{{"x":{:g},"y":{:g},"z":{:g}}},"color":{}}}])",
      pose_at(centre_m), diameter_m, diameter_m, diameter_m, json_colour(colour));
}

std::string triangles(const float* coordinates_m, size_t coordinates, const int32_t* indices,
                      size_t index_count, double scale, const Colour& colour) {
  std::string points, order;
  for (size_t i = 0; i + 2 < coordinates; i += 3)
    append(points, R"({}{{"x":{:.4f},"y":{:.4f},"z":{:.4f}}})", i > 0 ? "," : "",
           scale * static_cast<double>(coordinates_m[i]),
           scale * static_cast<double>(coordinates_m[i + 1]),
           scale * static_cast<double>(coordinates_m[i + 2]));
  for (size_t i = 0; i < index_count; ++i) append(order, "{}{}", i > 0 ? "," : "", indices[i]);
  return fmt::format(
      R"("triangles":[{{"pose":{},"points":[{}],"color":{},"colors":[],"indices":[{}]}}])",
      pose_at(Eigen::Vector3d::Zero()), points, json_colour(colour), order);
}

std::string deletion(int64_t utime_us, std::string_view id) {
  return fmt::format(R"({{"timestamp":{},"type":0,"id":{}}})", json_time(utime_us), json_text(id));
}

std::string scene_update(const std::string& deletions, const std::string& entities) {
  return fmt::format(R"({{"deletions":[{}],"entities":[{}]}})", deletions, entities);
}

}  // namespace throng::foxglove
