// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ethernet/frame_filter.hpp"

#include "gateways/iec61850/routable.hpp"

#include <algorithm>
#include <linux/filter.h>

namespace gridspace::ethernet {
namespace {

constexpr std::uint32_t kWhole = 0x40000; // octets of a frame that are given: all
constexpr std::size_t kLongestList = 60;  // a conditional jump reaches 255 instructions; a destination takes four

template <class T>
bool in(std::vector<T> const& list, T const& value) {
    return list.empty() || std::find(list.begin(), list.end(), value) != list.end();
}

sock_filter load(std::uint16_t mode, std::uint32_t at) {
    return {static_cast<std::uint16_t>(BPF_LD | mode), 0, 0, at};
}
sock_filter equal(std::uint32_t value, std::size_t if_true, std::size_t if_false) {
    return {BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint8_t>(if_true), static_cast<std::uint8_t>(if_false), value};
}
sock_filter give(std::uint32_t octets) {
    return {BPF_RET | BPF_K, 0, 0, octets};
}

/// The loaded half word must be one of `values`, else the frame is dropped.
void one_of(std::vector<sock_filter>& out, std::vector<std::uint16_t> const& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        out.push_back(equal(values[i], values.size() - i, 0)); // over the rest of the list and over the drop
    }
    out.push_back(give(0));
}

/// Takes UDP over IPv4 to the port of R-GOOSE and R-SV; the rest of the program decides about all else. X holds the
/// octets of VLAN tags, before and after.
void take_routable(std::vector<sock_filter>& out) {
    constexpr std::uint32_t kIpv4 = 0x0800, kUdp = 17;
    std::vector<sock_filter> const ip{load(BPF_B | BPF_IND, 23), // protocol
                                      equal(kUdp, 0, 8),
                                      load(BPF_B | BPF_IND, 14), // octets of the header, in words
                                      {BPF_ALU | BPF_AND | BPF_K, 0, 0, 0xF},
                                      {BPF_ALU | BPF_LSH | BPF_K, 0, 0, 2},
                                      {BPF_ALU | BPF_ADD | BPF_X, 0, 0, 0},
                                      {BPF_MISC | BPF_TAX, 0, 0, 0},
                                      load(BPF_H | BPF_IND, 16), // destination port
                                      equal(iec61850::kRoutablePort, 0, 1),
                                      give(kWhole),
                                      {BPF_LDX | BPF_MEM, 0, 0, 0}};
    out.push_back({BPF_STX, 0, 0, 0});
    out.push_back(load(BPF_H | BPF_IND, 12));
    out.push_back(equal(kIpv4, 0, ip.size()));
    out.insert(out.end(), ip.begin(), ip.end());
}

} // namespace

bool FrameFilter::kernel_decides() const noexcept {
    return ethertypes.size() <= kLongestList && app_ids.size() <= kLongestList && destinations.size() <= kLongestList;
}

bool FrameFilter::matches(Octets frame) const noexcept {
    if (frame.size() < 14) {
        return empty();
    }
    if (sources && std::equal(sources->prefix.begin(), sources->prefix.end(), frame.begin() + 6) == sources->others) {
        return false;
    }
    if (routable && !iec61850::routable_payload(frame).empty()) {
        return true;
    }
    std::size_t const header = iec61850::ethernet_header_octets(frame);
    auto const has = [&](std::vector<std::uint16_t> const& list, std::size_t at) {
        return list.empty() ||
               (frame.size() >= at + 2 && in(list, iec61850::load_be<std::uint16_t>(frame.data() + at)));
    };
    if (!has(ethertypes, header - 2) || !has(app_ids, header)) {
        return false;
    }
    Mac destination;
    std::copy_n(frame.begin(), 6, destination.octets.begin());
    return in(destinations, destination);
}

std::vector<sock_filter> FrameFilter::program() const {
    std::vector<sock_filter> out;
    if (sources) {
        auto const& p = sources->prefix;
        std::uint32_t const prefix = std::uint32_t{p[0]} << 16U | std::uint32_t{p[1]} << 8U | p[2];
        out.push_back(load(BPF_W | BPF_ABS, 6));
        out.push_back({BPF_ALU | BPF_RSH | BPF_K, 0, 0, 8});
        out.push_back(sources->others ? equal(prefix, 0, 1) : equal(prefix, 1, 0));
        out.push_back(give(0));
    }
    // X: octets of VLAN tags that are still in the frame. The kernel has taken the outer one off and put it into
    // auxiliary data.
    out.push_back({BPF_LDX | BPF_IMM, 0, 0, 0});
    out.push_back(load(BPF_H | BPF_ABS, 12));
    out.push_back(equal(0x8100, 1, 0));
    out.push_back(equal(0x88A8, 0, 1));
    out.push_back({BPF_LDX | BPF_IMM, 0, 0, 4});
    if (routable && !(ethertypes.empty() && app_ids.empty() && destinations.empty())) {
        take_routable(out);
    }
    if (!ethertypes.empty() && ethertypes.size() <= kLongestList) {
        out.push_back(load(BPF_H | BPF_IND, 12));
        one_of(out, ethertypes);
    }
    if (!app_ids.empty() && app_ids.size() <= kLongestList) {
        out.push_back(load(BPF_H | BPF_IND, 14));
        one_of(out, app_ids);
    }
    if (!destinations.empty() && destinations.size() <= kLongestList) {
        for (std::size_t i = 0; i < destinations.size(); ++i) {
            std::uint8_t const* const mac = destinations[i].octets.data();
            out.push_back(load(BPF_W | BPF_ABS, 2));
            out.push_back(equal(iec61850::load_be<std::uint32_t>(mac + 2), 0, 2));
            out.push_back(load(BPF_H | BPF_ABS, 0));
            out.push_back(equal(iec61850::load_be<std::uint16_t>(mac), (destinations.size() - 1 - i) * 4 + 1, 0));
        }
        out.push_back(give(0));
    }
    out.push_back(give(kWhole));
    return out;
}

} // namespace gridspace::ethernet
