// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/current_inputs.hpp"

#include "gateways/port/subscriptions.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace gridspace::relay {
namespace {

Result<CurrentInputs::End> make_end(streams::Stream const& stream, CurrentInputs::Members const& members,
                                    CurrentInputs::Params const& params) {
    auto subscription = gateways::sv_subscription(stream, params.speed);
    subscription.simulation = params.accept_test;
    // One end that is silent is noticed when its partner has waited for it in vain; both, by the same time.
    subscription.silence_periods = std::max(
        subscription.silence_periods, static_cast<double>(params.partner_timeout_ns) * 1e-9 * subscription.rate_hz);
    auto reader = SampleReader::create(stream, members);
    if (!reader) {
        return std::unexpected{reader.error()};
    }
    return CurrentInputs::End{
        iec61850::SvSubscriber{std::move(subscription)}, std::move(*reader),
        gateways::SvFirstLine{params.first_line, stream.rate_hz.to_double(), params.accept_test, params.judge_arrival}};
}

} // namespace

Result<CurrentInputs> CurrentInputs::create(streams::Stream const& from, streams::Stream const& to,
                                            Params const& params) {
    std::vector<End> ends;
    for (auto const& [stream, members] : {std::pair{&from, &params.members[0]}, {&to, &params.members[1]}}) {
        auto end = make_end(*stream, *members, params);
        if (!end) {
            return std::unexpected{end.error()};
        }
        ends.push_back(std::move(*end));
    }
    // Who refuses looks for a second claim to a sample, which comes at most a sample later.
    bool const refuses = params.first_line.on_finding == gateways::FirstLineConfig::OnFinding::refuse;
    // What one frame overtook comes right behind it; what another one did, a frame later.
    double const frame_ns =
        1e9 * static_cast<double>(std::max(from.samples_per_frame, to.samples_per_frame)) / from.rate_hz.to_double();
    CurrentInputs out{std::move(ends),
                      params.partner_timeout_ns,
                      static_cast<std::uint32_t>(from.rate_hz.num()),
                      refuses ? 1 : 0,
                      {static_cast<std::int64_t>(2 * frame_ns), params.max_interpolated}};
    out.same_sv_id_ = from.sv_id == to.sv_id;
    return out;
}

/// Whether the sample may be used, by the rules and by what is configured about them.
bool CurrentInputs::pass_first_line(std::size_t end, iec61850::Asdu const& asdu, std::size_t place,
                                    std::int64_t arrival_ns) {
    auto const verdict = ends_[end].first_line.judge(decoded_.header, asdu, place, arrival_ns);
    if ((verdict.findings & ~gateways::kHarmlessSvFindings) != 0 && on_finding_) {
        on_finding_(end, verdict.findings, decoded_.header.source);
    }
    if (verdict.contested) { // both are questionable: the one that was taken, and this one
        if (EndSample* const taken = alignment_.waiting(end, asdu.smp_cnt)) {
            taken->validity = std::max(taken->validity, Validity::questionable);
        } else {
            ends_[end].contest_next = true;
        }
    }
    return verdict.use;
}

void CurrentInputs::frame(iec61850::Octets octets, std::int64_t arrival_ns, OnPair const& on_pair) {
    if (auto const read_frame = iec61850::decode_sv(octets, decoded_); !read_frame) {
        damaged_.count(read_frame.error().reason);
        return;
    }
    auto const asdus = decoded_.view();
    for (std::size_t place = 0; place < asdus.size(); ++place) {
        iec61850::Asdu const& asdu = asdus[place];
        // Two devices may send the same svID: then the address gives the sender. One that is nobody's is judged
        // by both, as it was.
        bool const has_owner = same_sv_id_ && std::any_of(ends_.begin(), ends_.end(), [&](End const& end) {
                                   return end.subscriber.is_mine(asdu) && end.subscriber.is_addressed(decoded_.header);
                               });
        for (std::size_t i = 0; i < ends_.size(); ++i) {
            End& end = ends_[i];
            bool const mine =
                end.subscriber.is_mine(asdu) && (!has_owner || end.subscriber.is_addressed(decoded_.header));
            if (!mine || !pass_first_line(i, asdu, place, arrival_ns)) {
                continue;
            }
            std::int64_t const last_index = end.subscriber.last_index();
            iec61850::SvArrival const arrival = end.subscriber.receive(decoded_.header, asdu, arrival_ns);
            tell_refusal(i, arrival, asdu);
            if (arrival.accepted || arrival.event == iec61850::SvEvent::late) {
                bool const restarted =
                    arrival.event == iec61850::SvEvent::first || arrival.event == iec61850::SvEvent::restart;
                EndSample sample = end.reader.read(decoded_.header, asdu);
                if (std::exchange(end.contest_next, false)) {
                    sample.validity = std::max(sample.validity, Validity::questionable);
                }
                alignment_.push(i, asdu.smp_cnt, asdu.smp_synch, sample, arrival_ns,
                                {arrival.index - last_index, restarted});
                give_out(arrival_ns, on_pair);
            }
        }
    }
}

void CurrentInputs::tell_refusal(std::size_t end, iec61850::SvArrival const& arrival, iec61850::Asdu const& asdu) {
    using iec61850::SvEvent;
    std::int64_t& taken = ends_[end].taken_since_refusal;
    if (arrival.event == SvEvent::conf_rev_mismatch || arrival.event == SvEvent::size_mismatch) {
        if (taken < 0 && on_refusal_) {
            on_refusal_(end, arrival.event, asdu);
        }
        taken = 0;
    } else if (arrival.accepted && taken >= 0) {
        auto const second = static_cast<std::int64_t>(ends_[end].subscriber.subscription().rate_hz);
        taken = taken + 1 < second ? taken + 1 : -1;
    }
}

void CurrentInputs::give_out(std::int64_t now_ns, OnPair const& on_pair) {
    while (auto const pair = alignment_.pop(now_ns)) {
        LineSample sample;
        sample.index = pair->index;
        sample.from = pair->first.value_or(EndSample{});
        sample.to = pair->second.value_or(EndSample{});
        if (sample.from.present && sample.to.present &&
            !pair->coherent()) { // each may have a clock, but not the same one
            sample.from.synch = sample.to.synch = Synch::none;
        }
        on_pair(sample);
    }
}

std::optional<std::int64_t> CurrentInputs::deadline() const {
    std::optional<std::int64_t> out = alignment_.deadline();
    for (End const& end : ends_) {
        if (auto const silence = end.subscriber.deadline()) {
            out = out ? std::min(*out, *silence) : *silence;
        }
    }
    return out;
}

void CurrentInputs::elapse(std::int64_t now_ns, OnPair const& on_pair) {
    give_out(now_ns, on_pair);
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        if (ends_[i].subscriber.expire(now_ns) && on_silence_) {
            on_silence_(i);
        }
    }
}

} // namespace gridspace::relay
