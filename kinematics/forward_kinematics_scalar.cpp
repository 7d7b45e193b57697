// Scalar reference for forward_kinematics_simd.cpp, which equals it to the bit.
#include <array>

#include "base/portable_math.h"
#include "kinematics/flat_ops.h"

namespace throng {
namespace {

/// A row of the running pose: its three rotation entries and its translation.
struct Row {
  float c[3];
  float t;
};
using RunningPose = std::array<Row, 3>;

float drive_value(const Drive& drive, const float* posture) {
  return posture[drive.column] * drive.multiplier + drive.offset;
}

RunningPose root_pose(const Eigen::Quaternionf& q) {
  const float x2 = q.x() + q.x();
  const float y2 = q.y() + q.y();
  const float z2 = q.z() + q.z();
  const float xx = q.x() * x2, xy = q.x() * y2, xz = q.x() * z2;
  const float yy = q.y() * y2, yz = q.y() * z2, zz = q.z() * z2;
  const float wx = q.w() * x2, wy = q.w() * y2, wz = q.w() * z2;
  return {Row{{1.0f - (yy + zz), xy - wz, xz + wy}, 0.0f},
          Row{{xy + wz, 1.0f - (xx + zz), yz - wx}, 0.0f},
          Row{{xz - wy, yz + wx, 1.0f - (xx + yy)}, 0.0f}};
}

void rotate(Row& row, int i, int j, const FloatSinCos& turn) {
  const float ci = row.c[i];
  const float cj = row.c[j];
  row.c[i] = ci * turn.cos + cj * turn.sin;
  row.c[j] = cj * turn.cos - ci * turn.sin;
}

float along(const Row& row, const float* v) {
  return (row.c[0] * v[0] + row.c[1] * v[1]) + row.c[2] * v[2];
}

void reorient(Row& row, const float* f) {
  const Row old = row;
  for (int c = 0; c < 3; ++c)
    row.c[c] = (old.c[0] * f[c] + old.c[1] * f[3 + c]) + old.c[2] * f[6 + c];
}

void emit(const RunningPose& pose, float scale, PartPose& out) {
  for (size_t r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out.rows[r][c] = pose[r].c[c];
    out.rows[r][3] = pose[r].t * scale;
  }
}

void pose_avatar(const FlatModel::Ops& ops, const float* posture, const RootFrame& root,
                 PartPose* out) {
  RunningPose pose = root_pose(root.world_from_root);
  std::array<RunningPose, kMaxSlots> slots;
  for (const Op& op : ops.program) {
    const size_t index = static_cast<size_t>(op.index);
    switch (op.kind) {
      case OpKind::kRotateX:
      case OpKind::kRotateY:
      case OpKind::kRotateZ: {
        const FloatSinCos turn = float_sin_cos(drive_value(ops.angles[index], posture));
        const int k = static_cast<int>(op.kind) - static_cast<int>(OpKind::kRotateX);
        for (Row& row : pose) rotate(row, (k + 1) % 3, (k + 2) % 3, turn);
        break;
      }
      case OpKind::kSlide:
        for (Row& row : pose)
          row.t += drive_value(ops.travels[index], posture) * along(row, op.values);
        break;
      case OpKind::kMoveX:
        for (Row& row : pose) row.t += row.c[0] * op.values[0];
        break;
      case OpKind::kMoveY:
        for (Row& row : pose) row.t += row.c[1] * op.values[1];
        break;
      case OpKind::kMoveZ:
        for (Row& row : pose) row.t += row.c[2] * op.values[2];
        break;
      case OpKind::kMove:
        for (Row& row : pose) row.t += along(row, op.values);
        break;
      case OpKind::kReorient:
        for (Row& row : pose) reorient(row, op.values);
        break;
      case OpKind::kSave:
        slots[index] = pose;
        break;
      case OpKind::kLoad:
        pose = slots[index];
        break;
      case OpKind::kEmit:
        emit(pose, root.scale, out[index]);
        break;
    }
  }
}

}  // namespace

void forward_kinematics_scalar(const FlatModel& model, const PostureRows& rows,
                               std::span<const RootFrame> roots, std::span<PartPose> poses) {
  const size_t outputs = static_cast<size_t>(model.output_count());
  for (size_t i = 0; i < roots.size(); ++i)
    pose_avatar(model.ops(), rows[i], roots[i], poses.data() + i * outputs);
}

}  // namespace throng
