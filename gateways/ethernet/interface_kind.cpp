// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What an interface is. Route netlink gives the kind of a virtual one, also to a program that runs in emulation
// (qemu-user knows no ethtool); ethtool gives the driver of a real one.
#include "common/unique_fd.hpp"
#include "gateways/ethernet/interface.hpp"

#include <array>
#include <cstring>
#include <linux/ethtool.h>
#include <linux/rtnetlink.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <string_view>
#include <sys/ioctl.h>
#include <sys/socket.h>

namespace gridspace::ethernet {
namespace {

/// The payload of the first attribute of `type` in `octets`, a sequence of struct rtattr; empty when there is none.
std::string_view attribute(std::string_view octets, unsigned type) {
    while (octets.size() >= sizeof(rtattr)) {
        rtattr header;
        std::memcpy(&header, octets.data(), sizeof header);
        if (header.rta_len < sizeof header || header.rta_len > octets.size()) {
            return {};
        }
        if ((header.rta_type & NLA_TYPE_MASK) == type) {
            return octets.substr(sizeof header, header.rta_len - sizeof header);
        }
        octets.remove_prefix(std::min<std::size_t>(octets.size(), RTA_ALIGN(header.rta_len)));
    }
    return {};
}

/// IFLA_INFO_KIND of rtnetlink(7): "veth", "bridge", "tun"; empty for hardware.
std::string kind_of(unsigned index) {
    UniqueFd const socket{::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)};
    struct {
        nlmsghdr header;
        ifinfomsg link;
    } request{};
    request.header.nlmsg_len = sizeof request;
    request.header.nlmsg_type = RTM_GETLINK;
    request.header.nlmsg_flags = NLM_F_REQUEST;
    request.link.ifi_family = AF_UNSPEC;
    request.link.ifi_index = static_cast<int>(index);
    timeval const patience{1, 0};
    if (!socket || ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) != 0 ||
        ::send(socket.get(), &request, sizeof request, 0) != static_cast<ssize_t>(sizeof request)) {
        return {};
    }
    std::array<char, 32768> buffer; // one link with all of its attributes
    ssize_t const size = ::recv(socket.get(), buffer.data(), buffer.size(), 0);
    nlmsghdr answer;
    if (size < static_cast<ssize_t>(sizeof request)) {
        return {};
    }
    std::memcpy(&answer, buffer.data(), sizeof answer);
    if (answer.nlmsg_type != RTM_NEWLINK || answer.nlmsg_len < sizeof request ||
        answer.nlmsg_len > static_cast<std::size_t>(size)) {
        return {};
    }
    std::string_view const attributes{buffer.data() + sizeof request, answer.nlmsg_len - sizeof request};
    std::string_view const kind = attribute(attribute(attributes, IFLA_LINKINFO), IFLA_INFO_KIND);
    return std::string{kind.substr(0, kind.find('\0'))};
}

std::string driver_of(std::string const& interface) {
    ethtool_drvinfo info{};
    info.cmd = ETHTOOL_GDRVINFO;
    ifreq request{};
    std::memcpy(request.ifr_name, interface.c_str(), interface.size() + 1);
    request.ifr_data = reinterpret_cast<char*>(&info);
    UniqueFd const socket{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    if (!socket || ::ioctl(socket.get(), SIOCETHTOOL, &request) != 0) {
        return {};
    }
    return {info.driver, ::strnlen(info.driver, sizeof info.driver)};
}

} // namespace

std::string interface_kind(std::string const& interface) {
    unsigned const index = interface.size() < IFNAMSIZ ? ::if_nametoindex(interface.c_str()) : 0;
    if (index == 0) {
        return {};
    }
    std::string kind = kind_of(index);
    return kind.empty() ? driver_of(interface) : kind;
}

} // namespace gridspace::ethernet
