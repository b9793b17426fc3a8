// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/first_line/first_line.hpp"

#include <cmath>

namespace gridspace::gateways {
namespace {

/// Fowler, Noll and Vo's hash (FNV-1a, 64 bits) of octets that stand in pieces.
class Hash {
  public:
    Hash& add(std::string_view text) {
        for (char const c : text) {
            put(static_cast<std::uint8_t>(c));
        }
        put(0); // "ab" + "c" is not "a" + "bc"
        return *this;
    }
    Hash& add(iec61850::Octets octets) {
        for (std::uint8_t const octet : octets) {
            put(octet);
        }
        return *this;
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

  private:
    void put(std::uint8_t octet) { value_ = (value_ ^ octet) * 0x100000001B3ULL; }
    std::uint64_t value_{0xCBF29CE484222325ULL};
};

std::uint16_t vlan_of(iec61850::FrameHeader const& header) {
    return header.vlan ? header.vlan->id : 0;
}

ids::SvRuleParams sv_params(FirstLineConfig const& config, streams::Stream const& stream, bool lockstep) {
    ids::SvRuleParams out;
    out.rate_hz = static_cast<std::uint32_t>(std::lround(stream.rate_hz.to_double()));
    out.check_arrival = config.check_arrival && !lockstep;
    return out;
}

ids::GooseRuleParams goose_params(FirstLineConfig const& config, streams::Stream const& stream) {
    ids::GooseRuleParams out;
    out.min_time_ms = stream.timing.min_time_ms;
    out.max_time_ms = stream.timing.max_time_ms;
    out.check_clock = config.check_clock;
    return out;
}

/// Findings that are no alarm: lost samples are counted by the subscriber, odd arrivals on their own.
constexpr std::uint32_t kNoAlarm = ids::kGap | ids::kBadArrival;

} // namespace

std::uint32_t FindingNews::fresh(std::uint32_t findings, std::int64_t now_ns) {
    std::uint32_t out = 0;
    for (std::size_t bit = 0; bit < last_ns_.size() && findings >> bit != 0; ++bit) {
        std::uint32_t const mask = 1U << bit;
        if ((findings & mask) != 0) {
            out |= (seen_ & mask) == 0 || now_ns - last_ns_[bit] > 1'000'000'000 ? mask : 0U;
            seen_ |= mask;
            last_ns_[bit] = now_ns;
        }
    }
    return out;
}

SvFirstLine::SvFirstLine(FirstLineConfig const& config, streams::Stream const& stream, bool lockstep)
    : config_{config}, rules_{sv_params(config, stream, lockstep)} {}

FirstLineVerdict SvFirstLine::judge(iec61850::FrameHeader const& header, iec61850::Asdu const& asdu, bool first,
                                    std::int64_t arrival_ns) {
    if (config_.action == FirstLineConfig::Action::off) {
        return {};
    }
    ids::SvFacts facts;
    facts.source = header.source.octets;
    facts.app_id = header.app_id;
    facts.vlan = vlan_of(header);
    facts.sv_id_hash = Hash{}.add(asdu.sv_id).add(asdu.dat_set).value();
    facts.conf_rev = asdu.conf_rev;
    facts.smp_cnt = asdu.smp_cnt;
    facts.smp_synch = asdu.smp_synch;
    facts.simulated = header.simulated();
    facts.arrival_ns = arrival_ns;
    facts.first_of_frame = first;
    auto const verdict = rules_.judge(facts);
    FirstLineVerdict out;
    out.findings = verdict.findings & ~kNoAlarm;
    out.news = news_.fresh(out.findings, arrival_ns);
    out.pass = verdict.accept || config_.action != FirstLineConfig::Action::drop;
    counters_.suspicious += out.findings != 0 ? 1U : 0U;
    counters_.refused += out.pass ? 0U : 1U;
    counters_.odd_arrivals += (verdict.findings & ids::kBadArrival) != 0 ? 1U : 0U;
    return out;
}

GooseFirstLine::GooseFirstLine(FirstLineConfig const& config, streams::Stream const& stream)
    : config_{config}, rules_{goose_params(config, stream)} {}

FirstLineVerdict GooseFirstLine::judge(iec61850::GooseFrame const& message, std::int64_t utc_ns) {
    if (config_.action == FirstLineConfig::Action::off) {
        return {};
    }
    ids::GooseFacts facts;
    facts.source = message.header.source.octets;
    facts.app_id = message.header.app_id;
    facts.vlan = vlan_of(message.header);
    facts.identity_hash = Hash{}.add(message.gocb_ref).add(message.dat_set).add(message.go_id).value();
    facts.conf_rev = message.conf_rev;
    facts.entries = message.entries;
    facts.st_num = message.st_num;
    facts.sq_num = message.sq_num;
    facts.live_ms = message.live_ms;
    facts.t_ns = message.t.nanoseconds();
    facts.simulated = message.simulated();
    facts.needs_commissioning = message.nds_com;
    facts.value_hash = Hash{}.add(message.all_data).value();
    facts.arrival_ns = utc_ns;
    auto const verdict = rules_.judge(facts);
    FirstLineVerdict out;
    out.findings = verdict.findings;
    out.news = news_.fresh(out.findings, utc_ns);
    out.pass = verdict.accept || config_.action != FirstLineConfig::Action::drop;
    if (out.pass && (verdict.findings & ids::kGooseOld) != 0) {
        rules_.expired(); // the subscriber goes along with it, so the rules do: said once, not for every message
    }
    counters_.suspicious += out.findings != 0 ? 1U : 0U;
    counters_.refused += out.pass ? 0U : 1U;
    return out;
}

} // namespace gridspace::gateways
