// Headers that nearly every file includes, and common instantiations of their templates. Reading
// Eigen, fmt and the standard library takes longer than most sources, instantiating their templates
// is next.
// Invariant: no header of Throng, so that no change compiles everything again.
#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace throng::precompiled {
/// A class template is instantiated when its size is needed.
template <typename... Types>
inline constexpr size_t kSize = (sizeof(Types) + ...);

template <typename V>
const V& a();
/// Expressions of vector arithmetic.
template <typename V>
inline constexpr size_t kExpressions =
    kSize<decltype(a<V>() + a<V>()), decltype(a<V>() - a<V>()), decltype(-a<V>()),
          decltype(typename V::Scalar{2} * a<V>()), decltype(a<V>() / typename V::Scalar{2}),
          decltype(a<V>().array()), decltype(a<V>().array() <= a<V>().array()),
          decltype(a<V>().cwiseAbs()), decltype(a<V>().cwiseMin(a<V>())),
          decltype(a<V>().cwiseMax(a<V>())), decltype(a<V>().template head<2>()),
          decltype(a<V>().template cast<double>()), decltype(a<V>().transpose()),
          decltype(a<V>()(0)), typename V::ConstantReturnType, typename V::BasisReturnType>;
/// Expressions of poses.
template <typename T>
inline constexpr size_t kPose =
    kSize<T, decltype(a<T>().linear()), decltype(a<T>().translation()),
          decltype(a<T>().matrix()(0, 0)), decltype(a<T>() * a<T>()), typename T::LinearMatrixType,
          typename T::MatrixType::IdentityReturnType,
          typename T::LinearMatrixType::IdentityReturnType,
          decltype(a<typename T::LinearMatrixType>() * a<typename T::VectorType>())>;

static_assert(kExpressions<Eigen::Vector2d> + kExpressions<Eigen::Vector3d> +
                  kExpressions<Eigen::Vector3f> + kPose<Eigen::Isometry3d> +
                  kPose<Eigen::Isometry3f> +
                  kSize<Eigen::Vector4f, Eigen::Vector3i, Eigen::Quaterniond, Eigen::Quaternionf,
                        Eigen::AlignedBox3f> >
              0);
static_assert(
    kSize<std::vector<bool>, std::vector<uint8_t>, std::vector<uint16_t>, std::vector<uint32_t>,
          std::vector<uint64_t>, std::vector<int>, std::vector<float>, std::vector<double>,
          std::vector<std::string>, std::vector<Eigen::Vector2d>, std::vector<Eigen::Vector3f>,
          std::vector<Eigen::Vector3i>, std::span<const uint8_t>, std::span<const uint32_t>,
          std::span<const float>, std::span<float>, std::optional<double>,
          std::optional<std::string>, std::function<void()>, std::filesystem::path> > 0);

}  // namespace throng::precompiled
