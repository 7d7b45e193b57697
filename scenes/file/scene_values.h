// Scene values are values that several keys share: areas, distributions, shares, files.
#pragma once

#include <string>

#include "base/limits.h"
#include "scenes/file/key.h"

namespace throng {

inline constexpr Range kPositionRange{-kMaxCoordinate_m, kMaxCoordinate_m};

/// Reads {min_m: [x, y], max_m: [x, y]} with min below max. `what` names the value in messages:
/// "ground".
Rectangle read_rectangle(const Fields& fields, const std::string& what);
/// A number with at most `decimals` digits behind the point, without zeros at the end.
std::string decimal_text(double value, int decimals);
/// "[0, 0] to [8, 5]", to a micrometre.
std::string to_text(const Rectangle& area);

/// Reads {mean, std_dev, min, max}, each optional, or one number for all agents.
Distribution read_distribution(const std::string& file, const YamlNode& node,
                               const std::string& what, const Distribution& fallback,
                               const Range& range);

/// Shares of a group's ages (default: adults only) and gait styles.
AgeShares read_ages(const Fields& group);
StyleShares read_styles(const Fields& group, const YamlNode& node);

/// URDF file: of the bundled adult, or relative to the scene file.
std::filesystem::path read_model_file(const ReadContext& context, const Fields& fields);
/// Regular file with a name relative to the scene file; `expected` describes it in messages.
std::filesystem::path existing_file(const ReadContext& context, const Fields& fields,
                                    const YamlNode& node, const std::string& expected);

void require_few(const std::string& where, int64_t people_and_obstacles);
/// Throws InputError if `name` is among `earlier`; adds it otherwise.
void require_new(const Fields& fields, const std::string& name, std::set<std::string>& earlier);

MapText distribution_text();
MapText ages_text();
MapText styles_text();

}  // namespace throng
