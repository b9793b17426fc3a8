// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/cable/tap.hpp"

#include "common/unique_fd.hpp"

#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <netinet/ether.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gridspace::cable {
namespace {

/// Room for the bursts of a tick: what does not fit is lost, and raw frames are not sent again.
constexpr int kQueue = 16384;

ifreq request(std::string const& name) {
    ifreq out{};
    std::snprintf(out.ifr_name, sizeof out.ifr_name, "%s", name.c_str());
    return out;
}

Result<void> set(int socket, unsigned long what, ifreq& values, std::string const& step) {
    if (::ioctl(socket, what, &values) != 0) {
        int const why = errno;
        return fail(ExitCode::environment, "cannot " + step + " '" + values.ifr_name + "': " + std::strerror(why),
                    why == EPERM ? "it needs CAP_NET_ADMIN" : "");
    }
    return {};
}

sockaddr ipv4(std::uint32_t address) {
    sockaddr_in in{};
    in.sin_family = AF_INET;
    in.sin_addr.s_addr = address;
    sockaddr out{};
    std::memcpy(&out, &in, sizeof out);
    return out;
}

} // namespace

Result<Port> parse_port(std::string_view text) {
    std::size_t const first = text.find(','), second = text.find(',', first + 1);
    if (first == std::string_view::npos || second == std::string_view::npos || first == 0 || first >= IFNAMSIZ) {
        return fail(ExitCode::usage, "'" + std::string{text} + "' is not NAME,MAC,ADDRESS");
    }
    return Port{std::string{text.substr(0, first)}, std::string{text.substr(first + 1, second - first - 1)},
                std::string{text.substr(second + 1)}};
}

Result<int> open_tap(std::string const& name) {
    UniqueFd fd{::open("/dev/net/tun", O_RDWR | O_CLOEXEC | O_NONBLOCK)};
    if (fd.get() < 0) {
        return fail(ExitCode::environment, std::string{"cannot open /dev/net/tun: "} + std::strerror(errno),
                    errno == ENOENT || errno == ENODEV ? "modprobe tun"
                                                       : "this user may not: as root, or chmod 666 /dev/net/tun");
    }
    ifreq values = request(name);
    values.ifr_flags = IFF_TAP | IFF_NO_PI;
    if (::ioctl(fd.get(), TUNSETIFF, &values) != 0) {
        int const why = errno;
        return fail(ExitCode::environment, "cannot make the tap device '" + name + "': " + std::strerror(why),
                    why == EPERM ? "it needs the capability CAP_NET_ADMIN" : "");
    }
    return fd.release();
}

Result<void> configure(Port const& port) {
    UniqueFd const socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    if (!port.mac.empty()) {
        ifreq mac = request(port.name);
        ether_addr address{};
        if (::ether_aton_r(port.mac.c_str(), &address) == nullptr) {
            return fail(ExitCode::usage, "'" + port.mac + "' is not a MAC address");
        }
        mac.ifr_hwaddr.sa_family = ARPHRD_ETHER;
        std::memcpy(mac.ifr_hwaddr.sa_data, address.ether_addr_octet, sizeof address.ether_addr_octet);
        ifreq queue = request(port.name);
        queue.ifr_qlen = kQueue;
        if (auto ok = set(socket.get(), SIOCSIFHWADDR, mac, "set the MAC address of"); !ok) {
            return ok;
        }
        if (auto ok = set(socket.get(), SIOCSIFTXQLEN, queue, "set the queue of"); !ok) {
            return ok;
        }
    }
    if (!port.address.empty() && port.address != "-") {
        std::size_t const slash = port.address.find('/');
        in_addr address{};
        int const prefix = slash == std::string::npos
                               ? 0
                               : static_cast<int>(std::strtol(port.address.c_str() + slash + 1, nullptr, 10));
        if (prefix < 1 || prefix > 32 || ::inet_pton(AF_INET, port.address.substr(0, slash).c_str(), &address) != 1) {
            return fail(ExitCode::usage, "'" + port.address + "' is not an IPv4 address with its prefix");
        }
        ifreq values = request(port.name);
        values.ifr_addr = ipv4(address.s_addr);
        if (auto ok = set(socket.get(), SIOCSIFADDR, values, "set the IP address of"); !ok) {
            return ok;
        }
        values.ifr_netmask = ipv4(htonl(~std::uint32_t{0} << static_cast<unsigned>(32 - prefix)));
        if (auto ok = set(socket.get(), SIOCSIFNETMASK, values, "set the netmask of"); !ok) {
            return ok;
        }
    }
    ifreq flags = request(port.name);
    if (auto ok = set(socket.get(), SIOCGIFFLAGS, flags, "look at"); !ok) {
        return ok;
    }
    flags.ifr_flags = static_cast<short>(flags.ifr_flags | IFF_UP);
    return set(socket.get(), SIOCSIFFLAGS, flags, "switch on");
}

} // namespace gridspace::cable
