// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/scan/known_streams.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::scan {
namespace {

constexpr double kLongestLength = 65536; // of a sample counter

/// Rates that merging units have: IEC 61869-9 (4800, 14400, 96000), 9-2LE (80 and 256 a period of 50 and 60 Hz), and
/// what IEC 61869-9 keeps of older ones. A capture of less than a second is stamped too coarsely to tell.
constexpr std::array<double, 9> kUsualRates{4000, 4800, 5760, 12'800, 14'400, 15'360, 48'000, 57'600, 96'000};

double whole_rate(double seen_hz) {
    constexpr double kNear = 0.01;
    auto const usual = std::find_if(kUsualRates.begin(), kUsualRates.end(),
                                    [&](double rate) { return std::fabs(seen_hz - rate) <= kNear * rate; });
    return usual == kUsualRates.end() ? std::round(seen_hz) : *usual;
}

} // namespace

std::string KnownStreams::wire_name(std::string const& name) const {
    auto const at = std::find_if(described_.begin(), described_.end(),
                                 [&](streams::Stream const& s) { return s.name.name == name; });
    return at == described_.end() ? name : at->kind == streams::Kind::smv ? at->sv_id : at->control_block;
}

streams::Stream const* KnownStreams::find(streams::Kind kind, std::string const& wire_name) const {
    auto const at = std::find_if(described_.begin(), described_.end(), [&](streams::Stream const& s) {
        return s.kind == kind && (kind == streams::Kind::smv ? s.sv_id : s.control_block) == wire_name;
    });
    return at == described_.end() ? nullptr : &*at;
}

SvDescription KnownStreams::describe(std::string const& sv_id,
                                     std::vector<wire::ObservedStream const*> const& seen) const {
    wire::ObservedStream const& most = **std::max_element(
        seen.begin(), seen.end(), [](auto const* a, auto const* b) { return a->frames < b->frames; });
    SvDescription out;
    if (streams::Stream const* const described = find(streams::Kind::smv, sv_id)) {
        out.stream = *described;
        out.rate_known = true;
        out.layout = "described";
    } else {
        out.stream.name.name = out.stream.sv_id = sv_id;
        out.stream.data_set = iec61850::data_set_92le();
        out.layout = "9-2LE";
        bool const wraps = most.counter && most.counter->wrap_known();
        double const rate = wraps ? most.counter->wrap() : whole_rate(most.rate_hz());
        out.rate_known = rate >= 1 && rate <= kLongestLength;
        out.stream.rate_hz = Rational{out.rate_known ? std::lround(rate) : 65'536};
    }
    out.stream.address.destination = most.destination;
    out.stream.address.app_id = most.app_id;
    out.stream.conf_rev = most.conf_rev;
    out.stream.samples_per_frame = std::max<std::int64_t>(most.asdus, 1);
    find_phases(out, most.sample_octets);
    return out;
}

void KnownStreams::find_phases(SvDescription& out, std::size_t octets) const {
    iec61850::SvLayout const layout{out.stream.data_set};
    if (layout.sample_octets() != octets) {
        out.layout = fmt::format("unknown: {} octets, and {} has {}", octets,
                                 out.layout == "described" ? "its description" : "9-2LE", layout.sample_octets());
        return;
    }
    std::vector<std::string> wanted = currents_.empty() ? std::vector<std::string>{"Ia", "Ib", "Ic"} : currents_;
    auto const is_there = [&](std::string const& name) { return layout.index_of(name).has_value(); };
    if (currents_.empty() && !std::all_of(wanted.begin(), wanted.end(), is_there)) {
        wanted.clear();
        for (auto const& slot : layout.slots()) {
            if (iec61850::is_number(slot.leaf.type) && wanted.size() < 3) {
                wanted.push_back(slot.leaf.name);
            }
        }
    }
    wanted.resize(3);
    relay::PhaseMembers phases{std::array<std::string, 3>{wanted[0], wanted[1], wanted[2]}, {}};
    if (auto const reader = relay::SampleReader::create(out.stream, phases); !reader) {
        out.layout = "no three currents: " + reader.error().message;
        return;
    }
    out.phases = std::move(phases);
}

} // namespace gridspace::scan
