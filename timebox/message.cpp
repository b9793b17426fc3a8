// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/message.hpp"

#include <algorithm>
#include <sys/syscall.h>

namespace gridspace::timebox {
namespace {

constexpr std::uint64_t kMostParts = 1024, kMostOctets = 1U << 20U;

std::vector<iovec> parts_at(pid_t tid, std::uint64_t address, std::uint64_t count) {
    std::vector<iovec> out(std::min(count, kMostParts));
    if (!out.empty() && !read_memory(tid, address, out.data(), out.size() * sizeof(iovec))) {
        out.clear();
    }
    return out;
}

Message at_header(pid_t tid, std::uint64_t address) {
    Message out;
    out.header = address;
    out.fields = value_at<msghdr>(tid, address);
    out.parts = parts_at(tid, reinterpret_cast<std::uint64_t>(out.fields.msg_iov), out.fields.msg_iovlen);
    out.name = reinterpret_cast<std::uint64_t>(out.fields.msg_name);
    out.name_size = out.fields.msg_namelen;
    return out;
}

iovec part(std::uint64_t address, std::uint64_t octets) {
    return {reinterpret_cast<void*>(address), octets};
}

} // namespace

std::vector<Message> messages_of(pid_t tid, Call const& call) {
    auto const& a = call.arguments;
    Message one;
    switch (call.number) {
    case SYS_readv:
    case SYS_writev:
        one.parts = parts_at(tid, a[1], a[2]);
        return {one};
    case SYS_sendmsg:
    case SYS_recvmsg:
        return {at_header(tid, a[1])};
    case SYS_sendmmsg:
    case SYS_recvmmsg: {
        std::vector<Message> out;
        for (std::uint64_t i = 0; i < std::min(a[2], kMostParts); ++i) {
            std::uint64_t const at = a[1] + i * sizeof(mmsghdr);
            out.push_back(at_header(tid, at));
            out.back().count_at = at + offsetof(mmsghdr, msg_len);
        }
        return out;
    }
    case SYS_sendto:
        one.name = a[4];
        one.name_size = a[5];
        break;
    case SYS_recvfrom:
        one.name = a[4];
        one.name_size_at = a[5];
        one.name_size = a[5] == 0 ? 0 : value_at<socklen_t>(tid, a[5]);
        break;
    default:
        break;
    }
    one.parts = {part(a[1], a[2])};
    return {one};
}

int flags_of(Call const& call) {
    switch (call.number) {
    case SYS_sendto:
    case SYS_recvfrom:
    case SYS_sendmmsg:
    case SYS_recvmmsg:
        return static_cast<int>(call.arguments[3]);
    case SYS_sendmsg:
    case SYS_recvmsg:
        return static_cast<int>(call.arguments[2]);
    default:
        return 0;
    }
}

std::size_t room_of(Message const& message) {
    std::size_t out = 0;
    for (iovec const& part : message.parts) {
        out += std::min<std::uint64_t>(part.iov_len, kMostOctets);
    }
    return out;
}

bool gather(pid_t tid, Message const& message, std::vector<std::uint8_t>& out) {
    std::uint64_t left = kMostOctets;
    for (iovec const& part : message.parts) {
        std::size_t const before = out.size(), octets = std::min<std::uint64_t>(part.iov_len, left);
        left -= octets;
        out.resize(before + octets);
        if (octets > 0 &&
            !read_memory(tid, reinterpret_cast<std::uint64_t>(part.iov_base), out.data() + before, octets)) {
            return false;
        }
        if (octets < part.iov_len) {
            break; // what comes behind is not next to what was cut here
        }
    }
    return true;
}

bool scatter(pid_t tid, Message const& message, std::span<std::uint8_t const> octets) {
    for (iovec const& part : message.parts) {
        std::size_t const here = std::min<std::size_t>(part.iov_len, octets.size());
        if (here > 0 && !write_memory(tid, reinterpret_cast<std::uint64_t>(part.iov_base), octets.data(), here)) {
            return false;
        }
        octets = octets.subspan(here);
    }
    return true;
}

} // namespace gridspace::timebox
