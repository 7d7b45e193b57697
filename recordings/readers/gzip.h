// What a gzip file holds.
// One rule: zlib sees it in a child process, behind base/files/foreign.h; a file that claims to
// hold a thousand times what tables compress to is refused.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>

#include "base/files/regular_file.h"

namespace throng {

bool is_gzip(std::string_view head);

/// Gives what it holds piece by piece, at most `most` bytes of it. Throws InputError for a file
/// that is damaged, cut short or a bomb; what was given before that is no part of anything.
void unpack(const RegularFile& file, const std::function<void(std::string_view)>& take,
            uint64_t most = std::numeric_limits<uint64_t>::max());

}  // namespace throng
