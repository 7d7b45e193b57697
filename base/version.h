// version() and commit() identify this build; every result names them.
#pragma once

#include <string_view>

namespace throng {

/// "0.9.0".
std::string_view version();

/// First 12 hexadecimal digits of the built commit, with "-dirty" if tracked files differed from
/// it; "unknown" outside a git checkout.
std::string_view commit();

}  // namespace throng
