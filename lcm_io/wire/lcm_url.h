// lcm_url checks an LCM URL before liblcm uses it, because liblcm prints many lines about an
// unusable one.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace lcm {
class LCM;
}

namespace throng {

/// Returns false if the kernel has no route to the multicast group of a udpm:// URL.
bool has_route(const std::string& url);

/// Returns whether messages go to a server over TCP.
bool is_tcpq(const std::string& url);

/// Returns false if no server at a tcpq:// URL answers within 0.2 s. liblcm would print three lines
/// per message and try again with each.
bool has_server(const std::string& url);

/// Returns whether liblcm can use a URL; "" stands for LCM_DEFAULT_URL. Throws InputError for a
/// file:// URL, because liblcm may empty the named file. False for an unreachable server, because
/// liblcm would abort a program that waits for its messages.
bool is_usable(const std::string& url);
std::string_view remedy(const std::string& url);

/// Returns a connection to listen on. Throws EnvironmentError with the remedy if liblcm cannot use
/// the URL. `purpose` and `option` are parts of its text: " for replies" and "--lockstep: ".
std::shared_ptr<lcm::LCM> listening(const std::string& url, std::string_view purpose = "",
                                    std::string_view option = "");

/// Remedy if has_route() is false.
inline constexpr std::string_view kMulticastRemedy =
    "without a multicast route: 'ip route add 224.0.0.0/4 dev lo'";

}  // namespace throng
