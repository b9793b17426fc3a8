// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "gateways/ethernet/port.hpp"
#include "gateways/iec61850/routable.hpp"
#include "launcher/wire/live.hpp"
#include "launcher/wire/tools.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::wire {
namespace {

/// Adds up what is not sent, and why.
struct LeftOut {
    std::uint64_t no_ethernet{0}, cut{0}, too_short{0}, other_protocols{0};
    [[nodiscard]] std::uint64_t total() const { return no_ethernet + cut + too_short + other_protocols; }
};

Result<std::vector<pcapng::Frame>> read_frames(ReplayOptions const& o, LeftOut& left_out) {
    auto reader = pcapng::Reader::open(o.file);
    if (!reader) {
        return std::unexpected{reader.error()};
    }
    std::vector<pcapng::Frame> out;
    auto const read = reader->each([&](pcapng::Frame&& frame) {
        pcapng::Interface const& point = reader->interfaces()[frame.interface];
        if (o.only.empty() ? pcapng::is_inside_a_cable(point.name) : point.name != o.only) {
            return;
        }
        auto const& octets = frame.octets;
        std::uint16_t const ethertype = iec61850::stream_ethertype(octets);
        if (point.link_type != pcapng::kEthernetLink) {
            ++left_out.no_ethernet;
        } else if (frame.original_octets > octets.size()) { // half a frame is another frame
            ++left_out.cut;
        } else if (octets.size() < 14) {
            ++left_out.too_short;
        } else if (!o.all_protocols && ethertype != iec61850::kSvEthertype && ethertype != iec61850::kGooseEthertype) {
            ++left_out.other_protocols;
        } else {
            out.push_back(std::move(frame));
        }
    });
    if (!read) {
        return std::unexpected{read.error()};
    }
    std::vector<std::string> names;
    for (pcapng::Interface const& point : reader->interfaces()) {
        names.push_back(point.name);
    }
    if (!o.only.empty() && std::find(names.begin(), names.end(), o.only) == names.end()) {
        return fail(ExitCode::usage, fmt::format("'{}' has no interface '{}'", o.file.string(), o.only),
                    names.empty() ? "it describes none" : fmt::format("there are: {}", join(names, ", ")));
    }
    if (reader->truncated()) {
        fmt::print(stderr, "note: '{}' ends in the middle of a frame: what is whole is replayed\n", o.file.string());
    }
    if (reader->interfaces().size() > 1 && o.only.empty()) {
        fmt::print(stderr,
                   "note: the capture has {} interfaces; a frame that passed several is replayed several times (--only "
                   "NAME)\n",
                   reader->interfaces().size());
    }
    if (out.empty()) {
        LeftOut const& l = left_out;
        return fail(ExitCode::usage, fmt::format("'{}' holds no frame to replay", o.file.string()),
                    l.no_ethernet > 0 ? "its link type is not Ethernet"
                    : l.cut > 0       ? "its frames were cut by the capture: record them whole"
                                      : "--all replays other protocols than GOOSE and SV too");
    }
    std::stable_sort(out.begin(), out.end(),
                     [](pcapng::Frame const& a, pcapng::Frame const& b) { return a.time_ns < b.time_ns; });
    return out;
}

} // namespace

Result<void> check_attack_allowed(std::string const& interface, std::string const& allowed) {
    if (interface == allowed) {
        return {};
    }
    if (auto const index = ethernet::interface_index(interface); !index) {
        return std::unexpected{index.error()};
    }
    std::string const kind = ethernet::interface_kind(interface);
    if (kind == "veth" || interface == "lo") {
        return {};
    }
    return fail(
        ExitCode::usage,
        fmt::format("'{}' is not a virtual cable{}", interface, kind.empty() ? "" : fmt::format(" ({})", kind)),
        fmt::format("replayed frames can operate real switchgear; if that is meant: --allow-attacks-on {}", interface));
}

Result<void> replay(ReplayOptions const& o) {
    if (auto ok = check_attack_allowed(o.interface, o.allow_attacks_on); !ok) {
        return ok;
    }
    LeftOut left_out;
    auto const frames = read_frames(o, left_out);
    if (!frames) {
        return std::unexpected{frames.error()};
    }
    auto port = ethernet::Port::open({.interface = o.interface, .filter = {}, .receive = false});
    if (!port) {
        return std::unexpected{port.error()};
    }
    catch_signals();
    std::int64_t worst_late = 0;
    std::vector<iec61850::Octets> batch;
    for (int loop = 0; (o.loops == 0 || loop < o.loops) && !stopped(); ++loop) {
        std::int64_t const start = monotonic_ns(), first = frames->front().time_ns;
        auto const due = [&](std::size_t i) {
            return o.speed > 0
                       ? start + static_cast<std::int64_t>(static_cast<double>((*frames)[i].time_ns - first) / o.speed)
                       : start;
        };
        for (std::size_t i = 0; i < frames->size() && !stopped();) {
            sleep_until(due(i));
            std::int64_t const now = monotonic_ns();
            worst_late = o.speed > 0 ? std::max(worst_late, now - due(i)) : 0;
            batch.clear();
            while (i < frames->size() && batch.size() < 64 && due(i) <= now) {
                batch.emplace_back((*frames)[i++].octets);
            }
            port->send(batch);
        }
    }
    fmt::print("{{\"sent\":{},\"not_sent\":{},\"left_out\":{},\"worst_late_us\":{:.1f}}}\n", port->counters().sent,
               port->counters().send_failed, left_out.total(), static_cast<double>(worst_late) / 1e3);
    return check_sent(*port);
}

} // namespace gridspace::wire
