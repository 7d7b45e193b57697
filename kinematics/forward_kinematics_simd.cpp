// Forward kinematics with 4, 8 or 16 avatars as lanes: the program of
// forward_kinematics_scalar.cpp.
#include <algorithm>
#include <cstddef>

#include "base/simd/dispatch.h"
#include "kinematics/flat_ops.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinematics/forward_kinematics_simd.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace {

using D = Lanes;

struct Row {
  V x, y, z, t;
};

HWY_INLINE V drive_value(const Drive& drive, const float* columns) {
  const D d;
  const V q = hn::Load(d, columns + static_cast<size_t>(drive.column) * kLanes);
  return hn::Add(hn::Mul(q, hn::Set(d, drive.multiplier)), hn::Set(d, drive.offset));
}

HWY_INLINE void rotate(V& i, V& j, V sin, V cos) {
  const V old = i;
  i = hn::Add(hn::Mul(old, cos), hn::Mul(j, sin));
  j = hn::Sub(hn::Mul(j, cos), hn::Mul(old, sin));
}

HWY_INLINE V along(const Row& row, V x, V y, V z) {
  return hn::Add(hn::Add(hn::Mul(row.x, x), hn::Mul(row.y, y)), hn::Mul(row.z, z));
}

HWY_INLINE void reorient(Row& row, const float* f) {
  const D d;
  const V x = along(row, hn::Set(d, f[0]), hn::Set(d, f[3]), hn::Set(d, f[6]));
  const V y = along(row, hn::Set(d, f[1]), hn::Set(d, f[4]), hn::Set(d, f[7]));
  row.z = along(row, hn::Set(d, f[2]), hn::Set(d, f[5]), hn::Set(d, f[8]));
  row.x = x;
  row.y = y;
}

HWY_INLINE void root_pose(V x, V y, V z, V w, Row& a, Row& b, Row& c) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const V x2 = hn::Add(x, x);
  const V y2 = hn::Add(y, y);
  const V z2 = hn::Add(z, z);
  const V xx = hn::Mul(x, x2), xy = hn::Mul(x, y2), xz = hn::Mul(x, z2);
  const V yy = hn::Mul(y, y2), yz = hn::Mul(y, z2), zz = hn::Mul(z, z2);
  const V wx = hn::Mul(w, x2), wy = hn::Mul(w, y2), wz = hn::Mul(w, z2);
  const V zero = hn::Zero(d);
  a = {hn::Sub(one, hn::Add(yy, zz)), hn::Sub(xy, wz), hn::Add(xz, wy), zero};
  b = {hn::Add(xy, wz), hn::Sub(one, hn::Add(xx, zz)), hn::Sub(yz, wx), zero};
  c = {hn::Sub(xz, wy), hn::Add(yz, wx), hn::Sub(one, hn::Add(xx, yy)), zero};
}

/// Writes the poses of one output; the next avatar's is `stride` floats ahead.
HWY_INLINE void emit_row(const Row& row, V scale, float* to, size_t stride) {
  const V pose[4] = {row.x, row.y, row.z, hn::Mul(row.t, scale)};
  store_rows(pose, [to, stride](size_t lane) HWY_ATTR { return to + lane * stride; });
}

/// A lane group: pointers to its avatars' rows and poses.
struct Group {
  const float* postures[kLanes];
  const float* quaternions[kLanes];
  HWY_ALIGN float scales[kLanes];
  PartPose* poses;
  size_t count;  ///< number of avatars; the remaining lanes repeat the last one
};

HWY_INLINE void transpose_postures(const Group& group, size_t column_count, float* to) {
  const D d;
  if (column_count < 4) {
    for (size_t c = 0; c < column_count; ++c)
      for (size_t lane = 0; lane < kLanes; ++lane) to[c * kLanes + lane] = group.postures[lane][c];
    return;
  }
  for (size_t c = 0; c < column_count; c += 4) {
    const size_t first =
        std::min(c, column_count - 4);  // the last block may overlap the one before
    V four[4];
    load_rows([&group, first](size_t lane) HWY_ATTR { return group.postures[lane] + first; }, four);
    for (size_t i = 0; i < 4; ++i) hn::Store(four[i], d, to + (first + i) * kLanes);
  }
}

HWY_INLINE void emit(const Row& a, const Row& b, const Row& c, V scale, const Group& group,
                     size_t output, size_t output_count) {
  constexpr size_t kPoseFloats = sizeof(PartPose) / sizeof(float);
  if (group.count == kLanes) {
    float* to = group.poses[output].rows[0];
    emit_row(a, scale, to, output_count * kPoseFloats);
    emit_row(b, scale, to + 4, output_count * kPoseFloats);
    emit_row(c, scale, to + 8, output_count * kPoseFloats);
    return;
  }
  PartPose all[kLanes];
  emit_row(a, scale, all[0].rows[0], kPoseFloats);
  emit_row(b, scale, all[0].rows[1], kPoseFloats);
  emit_row(c, scale, all[0].rows[2], kPoseFloats);
  for (size_t lane = 0; lane < group.count; ++lane)
    group.poses[lane * output_count + output] = all[lane];
}

void run_program(const FlatModel::Ops& ops, const Group& group, size_t column_count,
                 size_t output_count) {
  const D d;
  HWY_ALIGN float columns[kMaxDrives * kLanes];
  HWY_ALIGN float sines[kMaxDrives * kLanes];
  HWY_ALIGN float cosines[kMaxDrives * kLanes];
  transpose_postures(group, column_count, columns);
  for (size_t i = 0; i < ops.angles.size(); ++i) {
    V sin, cos;
    float_sin_cos(drive_value(ops.angles[i], columns), sin, cos);
    hn::Store(sin, d, sines + i * kLanes);
    hn::Store(cos, d, cosines + i * kLanes);
  }

  V q[4];
  load_rows([&group](size_t lane) HWY_ATTR { return group.quaternions[lane]; }, q);
  const V scale = hn::Load(d, group.scales);
  Row a, b, c;
  root_pose(q[0], q[1], q[2], q[3], a, b, c);
  struct Slot {
    Row a, b, c;
  };
  Slot slots[kMaxSlots];

  for (const Op& op : ops.program) {
    const size_t index = static_cast<size_t>(op.index);
    const float* const f = op.values;
    switch (op.kind) {
      case OpKind::kRotateX: {
        const V sin = hn::Load(d, sines + index * kLanes);
        const V cos = hn::Load(d, cosines + index * kLanes);
        rotate(a.y, a.z, sin, cos);
        rotate(b.y, b.z, sin, cos);
        rotate(c.y, c.z, sin, cos);
        break;
      }
      case OpKind::kRotateY: {
        const V sin = hn::Load(d, sines + index * kLanes);
        const V cos = hn::Load(d, cosines + index * kLanes);
        rotate(a.z, a.x, sin, cos);
        rotate(b.z, b.x, sin, cos);
        rotate(c.z, c.x, sin, cos);
        break;
      }
      case OpKind::kRotateZ: {
        const V sin = hn::Load(d, sines + index * kLanes);
        const V cos = hn::Load(d, cosines + index * kLanes);
        rotate(a.x, a.y, sin, cos);
        rotate(b.x, b.y, sin, cos);
        rotate(c.x, c.y, sin, cos);
        break;
      }
      case OpKind::kSlide: {
        const V x = hn::Set(d, f[0]), y = hn::Set(d, f[1]), z = hn::Set(d, f[2]);
        const V travel = drive_value(ops.travels[index], columns);
        a.t = hn::Add(a.t, hn::Mul(travel, along(a, x, y, z)));
        b.t = hn::Add(b.t, hn::Mul(travel, along(b, x, y, z)));
        c.t = hn::Add(c.t, hn::Mul(travel, along(c, x, y, z)));
        break;
      }
      case OpKind::kMoveX: {
        const V x = hn::Set(d, f[0]);
        a.t = hn::Add(a.t, hn::Mul(a.x, x));
        b.t = hn::Add(b.t, hn::Mul(b.x, x));
        c.t = hn::Add(c.t, hn::Mul(c.x, x));
        break;
      }
      case OpKind::kMoveY: {
        const V y = hn::Set(d, f[1]);
        a.t = hn::Add(a.t, hn::Mul(a.y, y));
        b.t = hn::Add(b.t, hn::Mul(b.y, y));
        c.t = hn::Add(c.t, hn::Mul(c.y, y));
        break;
      }
      case OpKind::kMoveZ: {
        const V z = hn::Set(d, f[2]);
        a.t = hn::Add(a.t, hn::Mul(a.z, z));
        b.t = hn::Add(b.t, hn::Mul(b.z, z));
        c.t = hn::Add(c.t, hn::Mul(c.z, z));
        break;
      }
      case OpKind::kMove: {
        const V x = hn::Set(d, f[0]), y = hn::Set(d, f[1]), z = hn::Set(d, f[2]);
        a.t = hn::Add(a.t, along(a, x, y, z));
        b.t = hn::Add(b.t, along(b, x, y, z));
        c.t = hn::Add(c.t, along(c, x, y, z));
        break;
      }
      case OpKind::kReorient:
        reorient(a, f);
        reorient(b, f);
        reorient(c, f);
        break;
      case OpKind::kSave:
        slots[index] = {a, b, c};
        break;
      case OpKind::kLoad:
        a = slots[index].a;
        b = slots[index].b;
        c = slots[index].c;
        break;
      case OpKind::kEmit:
        emit(a, b, c, scale, group, index, output_count);
        break;
    }
  }
}

}  // namespace

void run_all(const FlatModel& model, const PostureRows& rows, std::span<const RootFrame> roots,
             std::span<PartPose> poses) {
  const size_t columns = static_cast<size_t>(model.column_count());
  const size_t outputs = static_cast<size_t>(model.output_count());
  Group group;
  for (size_t first = 0; first < roots.size(); first += kLanes) {
    group.count = std::min(kLanes, roots.size() - first);
    group.poses = poses.data() + first * outputs;
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const size_t avatar = first + std::min(lane, group.count - 1);
      group.postures[lane] = rows[avatar];
      group.quaternions[lane] = roots[avatar].world_from_root.coeffs().data();  // x y z w
      group.scales[lane] = roots[avatar].scale;
    }
    run_program(model.ops(), group, columns, outputs);
  }
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

void forward_kinematics_simd(const FlatModel& model, const PostureRows& rows,
                             std::span<const RootFrame> roots, std::span<PartPose> poses,
                             SimdTarget target) {
  THRONG_CHOOSE(target, run_all, forward_kinematics_scalar)(model, rows, roots, poses);
}

}  // namespace throng
#endif
