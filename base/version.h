// Which Throng this is: every result names it, so that it can be made again.
// One rule: found while building, in one small file of its own, so that a new commit compiles that
// file and nothing else.
#pragma once

#include <string_view>

namespace throng {

/// "0.1.0".
std::string_view version();

/// The commit that was built, as 12 hexadecimal digits, with "-dirty" where tracked files differed
/// from it; "unknown" where the sources are not a git checkout.
std::string_view commit();

}  // namespace throng
