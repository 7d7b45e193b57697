#include "lcm_io/wire/lcm_url.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>

#include "base/errors.h"

namespace throng {

namespace {
constexpr std::string_view kTcpq = "tcpq://";
}  // namespace

bool is_tcpq(const std::string& url) { return url.starts_with(kTcpq); }

bool has_route(const std::string& url) {
  constexpr std::string_view kScheme = "udpm://";
  if (!url.starts_with(kScheme)) return true;
  const size_t end = url.find_first_of(":?", kScheme.size());
  std::string group = url.substr(kScheme.size(), end - kScheme.size());
  if (group.empty()) group = "239.255.76.67";  // default of liblcm
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7667);  // any port: connecting a UDP socket only looks up the route
  if (inet_pton(AF_INET, group.c_str(), &address.sin_addr) != 1) return true;
  const int descriptor = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return true;
  const bool is_reachable =
      ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
      errno != ENETUNREACH;
  ::close(descriptor);
  return is_reachable;
}

namespace {

constexpr int kAnswer_ms = 200;

bool answers(const addrinfo& address) {
  const int descriptor = ::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return false;
  bool is_there = ::connect(descriptor, address.ai_addr, address.ai_addrlen) == 0;
  if (!is_there && errno == EINPROGRESS) {
    pollfd waiting{descriptor, POLLOUT, 0};
    int error = 0;
    socklen_t size = sizeof error;
    is_there = ::poll(&waiting, 1, kAnswer_ms) == 1 &&
               ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
  }
  ::close(descriptor);
  return is_there;
}

}  // namespace

bool has_server(const std::string& url) {
  if (!is_tcpq(url)) return true;
  const size_t begin = kTcpq.size();
  const std::string place = url.substr(begin, url.find('?', begin) - begin);
  const size_t colon = place.find(':');
  std::string host = place.substr(0, colon);
  std::string port = colon == std::string::npos ? "" : place.substr(colon + 1);
  if (host.empty()) host = "127.0.0.1";  // defaults of liblcm
  if (port.empty()) port = "7700";
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(host.c_str(), port.c_str(), &hints, &found) != 0) return false;
  bool is_there = false;
  for (const addrinfo* each = found; each != nullptr && !is_there; each = each->ai_next)
    is_there = answers(*each);
  ::freeaddrinfo(found);
  return is_there;
}

bool is_usable(const std::string& url) {
  const char* environment = url.empty() ? std::getenv("LCM_DEFAULT_URL") : nullptr;
  const std::string used = environment == nullptr ? url : environment;
  if (used.starts_with("file:"))
    throw InputError(used, "the URL of a network; logs are named as files", "a file's");
  return has_route(used) && has_server(used);
}

std::string_view remedy(const std::string& url) {
  return is_tcpq(url) ? "start its server first, for example lcm-tcpq-server" : kMulticastRemedy;
}

std::shared_ptr<lcm::LCM> listening(const std::string& url, std::string_view purpose,
                                    std::string_view option) {
  std::shared_ptr<lcm::LCM> lcm = is_usable(url) ? std::make_shared<lcm::LCM>(url) : nullptr;
  if (!lcm || !lcm->good())
    throw EnvironmentError(
        fmt::format("{}LCM cannot listen on {}{}; {}", option, url, purpose, remedy(url)));
  return lcm;
}

}  // namespace throng
