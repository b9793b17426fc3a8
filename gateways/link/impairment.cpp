// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/link/impairment.hpp"

#include "gateways/iec61850/sample_index.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

struct Key {
    std::string_view name;
    double Impairments::* number;
    double min, max;
};
constexpr double kNoBound = 1e12;
constexpr std::array kKeys{
    Key{"loss_percent", &Impairments::loss_percent, 0, 100},
    Key{"loss_burst", &Impairments::loss_burst, 1, 1e6},
    Key{"to_bad_percent", &Impairments::to_bad_percent, 0, 100},
    Key{"to_good_percent", &Impairments::to_good_percent, 0, 100},
    Key{"bad_loss_percent", &Impairments::bad_loss_percent, 0, 100},
    Key{"delay_us", &Impairments::delay_us, 0, 1e9},
    Key{"jitter_us", &Impairments::jitter_us, 0, 1e9},
    Key{"rate_mbps", &Impairments::rate_mbps, 0, kNoBound},
    Key{"queue_ms", &Impairments::queue_ms, 0, 1e6},
    Key{"duplicate_percent", &Impairments::duplicate_percent, 0, 100},
    Key{"duplicate_after_us", &Impairments::duplicate_after_us, 0, 1e9},
    Key{"reorder_percent", &Impairments::reorder_percent, 0, 100},
    Key{"reorder_by", &Impairments::reorder_by, 1, 1000},
    Key{"corrupt_percent", &Impairments::corrupt_percent, 0, 100},
    Key{"corrupt_bits", &Impairments::corrupt_bits, 1, 1000},
};

Key const* find_key(std::string_view name) {
    auto const it = std::find_if(kKeys.begin(), kKeys.end(), [&](Key const& k) { return k.name == name; });
    return it == kKeys.end() ? nullptr : &*it;
}

std::int64_t nanoseconds(double us) {
    return static_cast<std::int64_t>(std::llround(us * 1e3));
}

} // namespace

bool set_impairment(Impairments& impairments, std::string_view key, double value) {
    if (key == "up") {
        impairments.up = value != 0;
        return true;
    }
    Key const* known = find_key(key);
    if (known != nullptr) {
        impairments.*(known->number) = value;
    }
    return known != nullptr;
}

std::string wrong_with_impairment(std::string_view key, double value) {
    if (key == "up") {
        return value == 0 || value == 1 ? "" : "expected true or false";
    }
    Key const* known = find_key(key);
    if (known != nullptr && value >= known->min && value <= known->max) {
        return "";
    }
    return known == nullptr ? "" : fmt::format("expected a number from {} to {}", known->min, known->max);
}

std::vector<std::string> impairment_keys() {
    std::vector<std::string> out{"up"};
    for (Key const& key : kKeys) {
        out.emplace_back(key.name);
    }
    return out;
}

Impairment::Impairment(ImpairmentPlan plan, std::uint64_t seed, std::string_view name)
    : plan_{std::move(plan)}, now_{plan_.first}, loss_{seed, fmt::format("{}.loss", name)},
      line_{seed, fmt::format("{}.line", name)}, jitter_{seed, fmt::format("{}.jitter", name)},
      duplication_{seed, fmt::format("{}.duplication", name)}, reordering_{seed, fmt::format("{}.reordering", name)},
      corruption_{seed, fmt::format("{}.corruption", name)} {
    held_.reserve(iec61850::kMaxLength + 18);
    damaged_.reserve(iec61850::kMaxLength + 18);
}

void Impairment::apply_changes(std::int64_t now_ns) {
    for (; next_change_ < plan_.changes.size() && plan_.changes[next_change_].at_ns <= now_ns; ++next_change_) {
        (void)set_impairment(now_, plan_.changes[next_change_].key, plan_.changes[next_change_].value);
    }
}

/// The first message of what goes over UDP, as an Ethernet frame of its own; every other frame as it is.
iec61850::Octets Impairment::message_of(iec61850::Octets frame) {
    iec61850::Octets const datagram = iec61850::routable_payload(frame);
    if (datagram.empty() || !iec61850::decode_routable(datagram, session_)) {
        return frame;
    }
    iec61850::as_ethernet(frame, session_.payloads[0], message_);
    return message_;
}

std::optional<std::size_t> Impairment::stream_of(std::span<std::uint8_t const> octets) {
    if (plan_.marks.empty() || !iec61850::decode_header(message_of(octets), decoded_.header)) {
        return std::nullopt;
    }
    iec61850::FrameHeader const& header = decoded_.header;
    auto const it = std::find_if(plan_.marks.begin(), plan_.marks.end(), [&](StreamMark const& m) {
        return m.ethertype == header.ethertype && m.app_id == header.app_id && m.destination == header.destination;
    });
    return it == plan_.marks.end() ? std::nullopt : std::optional{static_cast<std::size_t>(it - plan_.marks.begin())};
}

SampleImpairment const* Impairment::impairment_of(std::size_t stream, PassingFrame const& frame) {
    bool const wanted = std::any_of(plan_.samples.begin(), plan_.samples.end(),
                                    [&](SampleImpairment const& d) { return d.stream == stream; });
    if (!wanted || !iec61850::decode_sv(message_of(frame.octets), decoded_) || decoded_.count == 0) {
        return nullptr;
    }
    std::int64_t const first =
        iec61850::absolute_index(decoded_.asdus[0].smp_cnt, plan_.marks[stream].rate_hz, frame.time_ns);
    std::int64_t const last = first + decoded_.count - 1;
    auto const it = std::find_if(plan_.samples.begin(), plan_.samples.end(), [&](SampleImpairment const& d) {
        return d.stream == stream && last >= d.first && first < d.first + d.count;
    });
    return it == plan_.samples.end() ? nullptr : &*it;
}

/// E. N. Gilbert (1960), E. O. Elliott (1963): a line with two states, each with its share of lost frames.
bool Impairment::is_lost() {
    if (now_.to_bad_percent > 0 || bad_) {
        bad_ = line_.chance((bad_ ? 100 - now_.to_good_percent : now_.to_bad_percent) / 100);
        if (bad_ && line_.chance(now_.bad_loss_percent / 100)) {
            return true;
        }
    }
    if (losing_ > 0) {
        --losing_;
        return true;
    }
    if (now_.loss_percent <= 0) {
        return false;
    }
    // So many bursts that their frames are the wanted share of all.
    double const share = now_.loss_percent / 100, burst = std::round(now_.loss_burst);
    if (!loss_.chance(share / (share + burst * (1 - share)))) {
        return false;
    }
    losing_ = static_cast<std::int64_t>(burst) - 1;
    return true;
}

std::span<std::uint8_t const> Impairment::corrupted(std::span<std::uint8_t const> octets) {
    // What a stream is recognised by stays: what no receiver recognises would be a loss.
    constexpr std::size_t kSessionIdentifier = 3; // with the transport header before it
    iec61850::Octets const datagram = iec61850::routable_payload(octets);
    std::size_t const from = datagram.size() > kSessionIdentifier
                                 ? static_cast<std::size_t>(datagram.data() - octets.data()) + kSessionIdentifier
                                 : iec61850::ethernet_header_octets(octets);
    damaged_.assign(octets.begin(), octets.end());
    if (damaged_.size() <= from) {
        return damaged_;
    }
    for (auto n = static_cast<std::int64_t>(std::round(now_.corrupt_bits)); n > 0; --n) {
        std::uint64_t const bit = corruption_.below((damaged_.size() - from) * 8);
        damaged_[from + bit / 8] = static_cast<std::uint8_t>(damaged_[from + bit / 8] ^ (1U << (bit % 8)));
    }
    return damaged_;
}

std::int64_t Impairment::departure(std::int64_t now_ns, std::size_t octets, double extra_us) {
    std::int64_t out = now_ns;
    if (now_.rate_mbps > 0) {
        constexpr std::size_t kPreambleAndGap = 8 + 4 + 12; // with the check sequence
        std::int64_t const start = std::max(now_ns, line_free_ns_);
        if (start - now_ns > static_cast<std::int64_t>(now_.queue_ms * 1e6)) {
            return -1;
        }
        line_free_ns_ = start + static_cast<std::int64_t>(
                                    std::llround(static_cast<double>(octets + kPreambleAndGap) * 8e3 / now_.rate_mbps));
        out = line_free_ns_;
    }
    double const jitter = now_.jitter_us > 0 ? jitter_.uniform(0, now_.jitter_us) : 0;
    out = std::max(out + nanoseconds(now_.delay_us + jitter), last_out_ns_);
    last_out_ns_ = out;
    return out + nanoseconds(extra_us) - now_ns; // a single late frame holds nobody up
}

void Impairment::pass(PassingFrame const& frame, FrameOutput& out) {
    apply_changes(frame.time_ns);
    auto const stream = stream_of(frame.octets);
    bool const meant =
        plan_.only.empty() || (stream && std::find(plan_.only.begin(), plan_.only.end(), *stream) != plan_.only.end());
    SampleImpairment const* impairment = stream ? impairment_of(*stream, frame) : nullptr;
    if (!meant && impairment == nullptr && now_.up) {
        out.send(frame.octets);
        return;
    }
    ++counters_.seen;
    using What = SampleImpairment::What;
    bool const is = impairment != nullptr;
    if (!now_.up || (is && impairment->what == What::lose) || (meant && is_lost())) {
        ++counters_.lost;
        return;
    }
    auto octets = frame.octets;
    if ((is && impairment->what == What::corrupt) ||
        (meant && now_.corrupt_percent > 0 && corruption_.chance(now_.corrupt_percent / 100))) {
        octets = corrupted(octets);
        ++counters_.corrupted;
    }
    std::int64_t const delay =
        departure(frame.time_ns, octets.size(), is && impairment->what == What::delay ? impairment->delay_us : 0);
    if (delay < 0) {
        ++counters_.lost;
        return;
    }
    counters_.delayed += delay > 0 ? 1U : 0U;
    bool const overtaken =
        meant && held_for_ == 0 && now_.reorder_percent > 0 && reordering_.chance(now_.reorder_percent / 100);
    if (overtaken) {
        held_.assign(octets.begin(), octets.end());
        held_for_ = static_cast<std::int64_t>(std::round(now_.reorder_by));
        held_since_ns_ = frame.time_ns;
        ++counters_.reordered;
        return;
    }
    out.send(octets, delay);
    if ((is && impairment->what == What::duplicate) ||
        (meant && now_.duplicate_percent > 0 && duplication_.chance(now_.duplicate_percent / 100))) {
        out.send(octets, delay + nanoseconds(is && impairment->what == What::duplicate ? impairment->delay_us
                                                                                       : now_.duplicate_after_us));
        ++counters_.duplicated;
    }
    if (held_for_ > 0 && --held_for_ == 0) {
        out.send(held_, delay + 1); // the next instant: at equal times a receiver would put them in order again
    }
}

std::optional<std::int64_t> Impairment::due() const {
    return held_for_ > 0 ? std::optional{held_since_ns_ + kLongestHoldNs} : std::nullopt;
}

void Impairment::elapse(std::int64_t, FrameOutput& out) {
    held_for_ = 0; // nobody came to overtake it
    out.send(held_);
}

} // namespace gridspace::gateways
