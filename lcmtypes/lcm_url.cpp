#include "lcmtypes/lcm_url.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

namespace throng {

bool has_route(const std::string& url) {
  constexpr std::string_view kScheme = "udpm://";
  if (!url.starts_with(kScheme)) return true;
  const size_t end = url.find_first_of(":?", kScheme.size());
  std::string group = url.substr(kScheme.size(), end - kScheme.size());
  if (group.empty()) group = "239.255.76.67";  // what liblcm uses
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7667);  // any: connecting a UDP socket only looks the route up
  if (inet_pton(AF_INET, group.c_str(), &address.sin_addr) != 1) return true;
  const int descriptor = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return true;
  const bool is_reachable =
      ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
      errno != ENETUNREACH;
  ::close(descriptor);
  return is_reachable;
}

}  // namespace throng
