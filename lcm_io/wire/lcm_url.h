// What to know of a URL before liblcm sees it.
// One rule: liblcm prints many lines where it gets nowhere; one of ours says how to get on.
#pragma once

#include <string>
#include <string_view>

namespace throng {

/// False if the kernel knows no way to the multicast group of a udpm:// URL.
bool has_route(const std::string& url);

/// Whether messages go to a server, over a connection that can break.
bool is_tcpq(const std::string& url);

/// False if nobody answers at the host and port of a tcpq:// URL within a fifth of a second. liblcm
/// would say so in three lines a message, and try again with each.
bool has_server(const std::string& url);

/// Whether liblcm gets anywhere with a URL, "" being that of LCM_DEFAULT_URL. Throws InputError for
/// a file:// URL: liblcm empties the file that a careless mode names. It aborts the program that
/// waits for messages of a server that it did not reach.
bool is_usable(const std::string& url);
/// What to do where it is not.
std::string_view remedy(const std::string& url);

/// The way out where has_route() is false.
inline constexpr std::string_view kMulticastRemedy =
    "where multicast has no route: 'ip route add 224.0.0.0/4 dev lo'";

}  // namespace throng
