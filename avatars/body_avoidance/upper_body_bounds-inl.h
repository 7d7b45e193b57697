// Boxes around posed parts, one part per lane. Included inside the namespace of the lanes F.

// Single precision in postures and kinematics: ten times the measured error.
inline constexpr float kUpperRoundingMargin_m = 1e-4f;

struct Extent {
  F low, high;
};

THRONG_LANES Extent extent_of(const UpperBodyBounds::Shapes& shapes, size_t i,
                              std::span<const PartPose> poses, size_t axis) {
  F row[4];
  load_rows([&](size_t lane) { return poses[shapes.link[i + lane]].rows[axis]; }, row);
  const auto number = [i](const std::vector<float>& numbers) { return numbers.data() + i; };
  const F middle = row[0] * load(number(shapes.middle_m[0])) +
                   row[1] * load(number(shapes.middle_m[1])) +
                   row[2] * load(number(shapes.middle_m[2])) + row[3];
  const F x = row[0] * load(number(shapes.ellipse_m[0])),
          y = row[1] * load(number(shapes.ellipse_m[1]));
  const F of_box = abs_of(row[0]) * load(number(shapes.half_m[0])) +
                   abs_of(row[1]) * load(number(shapes.half_m[1]));
  const F half = min_of(of_box, sqrt_of(x * x + y * y)) +
                 abs_of(row[2]) * load(number(shapes.half_m[2])) + kUpperRoundingMargin_m;
  return {middle - half, middle + half};
}

THRONG_LANES F max_distance_squared(const Extent& extent, float from) {
  const F maximum = max_of(from - extent.low, extent.high - from);
  return maximum * maximum;
}

THRONG_LANES bool upper_box(const UpperBodyBounds::Shapes& shapes, std::span<const PartPose> poses,
                            const RoundBounds& all, RootBox& box) {
  constexpr float kFar_m = 1e9f;
  F low[3] = {kFar_m, kFar_m, kFar_m}, high[3] = {-kFar_m, -kFar_m, -kFar_m};
  for (size_t i = 0; i < shapes.link.size(); i += kLaneCount) {
    Extent extents[3];
    for (size_t axis = 0; axis < 3; ++axis) {
      extents[axis] = extent_of(shapes, i, poses, axis);
      low[axis] = min_of(low[axis], extents[axis].low);
      high[axis] = max_of(high[axis], extents[axis].high);
    }
    const F across = max_distance_squared(extents[0], 0) + max_distance_squared(extents[1], 0);
    const F from_middle = across + max_distance_squared(extents[2], all.sphere_z_m);
    const M is_inside =
        (across <= all.cylinder_m * all.cylinder_m) & (from_middle <= all.sphere_m * all.sphere_m);
    if (any(!is_inside)) return false;
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    alignas(64) float lows[kLaneCount], highs[kLaneCount];
    store(low[axis], lows);
    store(high[axis], highs);
    box.min_m[axis] = *std::min_element(lows, lows + kLaneCount);
    box.max_m[axis] = *std::max_element(highs, highs + kLaneCount);
  }
  return true;
}
