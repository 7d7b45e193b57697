// The flat program executed by forward kinematics. Internal to the folder.
// Invariant: the scalar and the SIMD interpreter perform all operations in the same order.
//
// The running pose is [c0 c1 c2 | t]: three columns of a rotation and a translation. An op
// multiplies it from the right; its three rows are independent:
//   kRotateZ   (c0, c1) <- (cos c0 + sin c1, cos c1 - sin c0), X and Y alike
//   kSlide     t <- t + d (v0 c0 + v1 c1 + v2 c2)
//   kMove*     the same with constants; kMoveX, kMoveY, kMoveZ where two of them are zero
//   kReorient  (c0, c1, c2) <- (c0, c1, c2) F with a constant rotation F
//   kSave, kLoad  the running pose to or from a slot, where the tree branches
//   kEmit      the running pose is that of an output link
#pragma once

#include <cstdint>
#include <vector>

#include "kinematics/flat_model.h"

namespace throng {

enum class OpKind : uint8_t {
  kRotateX,
  kRotateY,
  kRotateZ,
  kSlide,
  kMoveX,
  kMoveY,
  kMoveZ,
  kMove,
  kReorient,
  kSave,
  kLoad,
  kEmit,
};

struct Op {
  OpKind kind = OpKind::kMove;
  int32_t index = 0;     ///< drive (kRotate*, kSlide), slot (kSave, kLoad) or output (kEmit)
  float values[9] = {};  ///< kMove*, kSlide: a vector; kReorient: F, row by row
};

/// Value of a joint: multiplier * column + offset. Includes the sign of the axis.
struct Drive {
  int32_t column = 0;
  float multiplier = 1;
  float offset = 0;
};

/// At a branch the lightest subtree comes first and the heaviest needs no slot: saved poses nest at
/// most log2(links) deep.
inline constexpr int kMaxSlots = 12;
/// Sines, cosines and travels of a lane group are stored on the stack: 48 kB with 16 lanes.
inline constexpr int kMaxDrives = 256;

struct FlatModel::Ops {
  std::vector<Op> program;
  std::vector<Drive> angles;   ///< angles of kRotate*
  std::vector<Drive> travels;  ///< travels of kSlide
};

/// Posture rows of several avatars: contiguous or scattered.
struct PostureRows {
  const float* first = nullptr;
  size_t row_floats = 0;
  const float* const* each = nullptr;  ///< null: contiguous
  const float* operator[](size_t i) const {
    return each == nullptr ? first + i * row_floats : each[i];
  }
};

void forward_kinematics_scalar(const FlatModel& model, const PostureRows& rows,
                               std::span<const RootFrame> roots, std::span<PartPose> poses);

/// `target` is available on this machine, and neither kBest nor kScalar.
void forward_kinematics_simd(const FlatModel& model, const PostureRows& rows,
                             std::span<const RootFrame> roots, std::span<PartPose> poses,
                             SimdTarget target);

}  // namespace throng
