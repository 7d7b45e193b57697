// What to know of a URL before liblcm sees it.
// One rule: liblcm prints ten lines where multicast has no route; one of ours says how to get on.
#pragma once

#include <string>
#include <string_view>

namespace throng {

/// False if the kernel knows no way to the multicast group of a udpm:// URL.
bool has_route(const std::string& url);

/// The way out where it is false.
inline constexpr std::string_view kMulticastWayOut =
    "where multicast has no route: 'ip route add 224.0.0.0/4 dev lo'";

}  // namespace throng
