// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/first_line/first_line.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::gateways {
namespace {

/// FNV-1a, 64 bits: stable, short, without memory. Not against collisions that somebody makes on purpose: those would
/// need the bound source address, and are what authentication is for.
class Hash {
  public:
    Hash& add(iec61850::Octets octets) {
        for (std::uint8_t const octet : octets) {
            value_ = (value_ ^ octet) * 0x100000001B3ULL;
        }
        return *this;
    }
    Hash& add(std::string_view text) {
        add(iec61850::octets_of(text));
        value_ = (value_ ^ 0xFFU) * 0x100000001B3ULL; // "ab","c" is not "a","bc"
        return *this;
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_{0xCBF29CE484222325ULL};
};

std::uint16_t vlan_of(iec61850::FrameHeader const& header) {
    return header.vlan ? header.vlan->id : 0;
}

ids::SvRuleParams sv_params(double rate_hz, bool accept_test, bool judge_arrival) {
    ids::SvRuleParams out;
    out.rate_hz = static_cast<std::uint32_t>(std::lround(rate_hz));
    out.test_mode = accept_test;
    out.check_arrival = judge_arrival;
    return out;
}

ids::GooseRuleParams goose_params(FirstLineConfig const& config, double min_time_ms, double max_time_ms,
                                  bool accept_test, double longest_live_ms) {
    ids::GooseRuleParams out;
    out.min_time_ms = min_time_ms;
    out.max_time_ms = max_time_ms;
    out.longest_live_ms = longest_live_ms;
    out.test_mode = accept_test;
    out.check_clock = config.check_clock;
    out.accept_in_contest = config.in_contest == FirstLineConfig::InContest::accept;
    return out;
}

} // namespace

std::vector<std::string> first_line_counters(bool sampled_values) {
    std::vector<std::string> out;
    std::size_t const findings = sampled_values ? ids::kSvFindings : ids::kGooseFindings;
    for (std::size_t k = 0; k < findings; ++k) {
        out.push_back(sampled_values ? ids::sv_finding_names(1U << k) : ids::goose_finding_names(1U << k));
    }
    out.emplace_back("refused");
    if (sampled_values) {
        out.emplace_back("contested");
    }
    return out;
}

SvFirstLine::SvFirstLine(FirstLineConfig const& config, double rate_hz, bool accept_test, bool judge_arrival)
    : config_{config}, rate_hz_{rate_hz}, rules_{sv_params(rate_hz, accept_test, judge_arrival)} {}

SvFirstLine::Verdict SvFirstLine::judge(iec61850::FrameHeader const& header, iec61850::Asdu const& asdu,
                                        std::size_t place, std::int64_t arrival_ns) {
    Verdict out;
    if (config_.on_finding == FirstLineConfig::OnFinding::ignore) {
        return out;
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
    facts.behind_another = place > 0;
    // The samples of one frame come together and were taken one after the other.
    facts.arrival_ns = arrival_ns + std::llround(static_cast<double>(place) * 1e9 / rate_hz_);
    ids::SvRules::Verdict const verdict = rules_.judge(facts);
    out.findings = verdict.findings;
    std::uint64_t const value_hash = Hash{}.add(asdu.sample).value();
    if (!verdict.accept && (verdict.findings & ~static_cast<std::uint32_t>(ids::kDuplicate | ids::kOutOfOrder)) == 0) {
        // The address is the stream's own. The same content is a copy (a parallel network, a bad cable); other content
        // is somebody who claims the sample too, and nobody can tell which of the two is real.
        auto const end = said_.begin() + static_cast<std::ptrdiff_t>(remembered_);
        auto const said = std::find_if(said_.begin(), end, [&](Said const& s) { return s.smp_cnt == asdu.smp_cnt; });
        out.contested = said != end && said->value_hash != value_hash;
        contested_ += out.contested ? 1U : 0U;
    }
    if (verdict.accept) {
        said_[next_said_] = {asdu.smp_cnt, value_hash};
        next_said_ = (next_said_ + 1) % said_.size();
        remembered_ = std::max(remembered_, next_said_ == 0 ? said_.size() : next_said_);
    }
    bool const refuse = config_.on_finding == FirstLineConfig::OnFinding::refuse;
    out.use = verdict.accept || !refuse;
    out.contested = out.contested && refuse;
    refused_ += out.use ? 0U : 1U;
    return out;
}

GooseFirstLine::GooseFirstLine(FirstLineConfig const& config, double min_time_ms, double max_time_ms, bool accept_test,
                               double longest_live_ms)
    : config_{config}, rules_{goose_params(config, min_time_ms, max_time_ms, accept_test, longest_live_ms)} {}

GooseFirstLine::Verdict GooseFirstLine::judge(iec61850::GooseFrame const& message, std::int64_t utc_ns) {
    Verdict out;
    if (config_.on_finding == FirstLineConfig::OnFinding::ignore) {
        return out;
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
    ids::GooseRules::Verdict const verdict = rules_.judge(facts);
    out.findings = verdict.findings;
    bool const refuse = config_.on_finding == FirstLineConfig::OnFinding::refuse;
    out.use = verdict.accept || !refuse;
    out.contested = verdict.contested && refuse;
    refused_ += out.use ? 0U : 1U;
    return out;
}

} // namespace gridspace::gateways
