// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/wire/observer.hpp"

#include "gateways/iec61850/mms_data.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::wire {

using namespace iec61850;

std::string visible(std::string_view text) {
    return to_string(Value::visible(text));
}

std::string data_text(GooseFrame const& message) {
    std::string out;
    std::size_t depth = 0;
    bool first = true;
    DataWalker walker{message.all_data, message.all_data_offset};
    Tlv element;
    while (walker.next(element)) {
        for (; depth > walker.depth(); --depth) {
            out += '}';
            first = false;
        }
        out += first ? "" : ", ";
        first = is_container(element.tag);
        if (first) {
            out += '{';
            ++depth;
        } else if (auto const value = read_any_data_value(element)) {
            out += to_string(*value);
        } else {
            out += fmt::format("<tag 0x{:02X}>", element.tag);
        }
    }
    return out + std::string(depth, '}');
}

double ObservedStream::rate_hz() const {
    if (!goose) {
        return counter ? counter->arrivals().rate_hz() : 0;
    }
    return frame_rate_hz();
}

double ObservedStream::frame_rate_hz() const {
    return last_ns > first_ns ? static_cast<double>(frames - 1) * 1e9 / static_cast<double>(last_ns - first_ns) : 0;
}

bool ObservedStream::alive(std::int64_t now_ns) const {
    if (goose) {
        return now_ns - last_ns <= std::int64_t{live_ms} * 1'000'000;
    }
    constexpr double kUnknownRateNs = 2e9; // of a single frame: twice the longest period
    double const limit_ns = rate_hz() > 0 ? std::max(10e9 * asdus / rate_hz(), 100e6) : kUnknownRateNs;
    return static_cast<double>(now_ns - last_ns) < limit_ns;
}

ObservedStream* Observer::stream_of(bool goose, std::string_view id, FrameHeader const& header, std::int64_t time_ns) {
    Key const key{goose, std::string{id}, header.source, header.app_id, routed_};
    if (streams_.size() >= kMaxStreams && !streams_.contains(key)) {
        ++beyond_table_;
        return nullptr;
    }
    auto const [at, fresh] = streams_.try_emplace(key);
    ObservedStream& s = at->second;
    if (fresh) {
        s.goose = goose;
        s.routed = routed_;
        s.id = visible(id);
        s.source = header.source;
        s.app_id = header.app_id;
        s.first_ns = time_ns;
        if (!goose) {
            SvSubscription subscription;
            subscription.wrap = 0;
            subscription.max_gap = 2400;
            s.counter = std::make_shared<SvSubscriber>(subscription);
        }
    }
    s.destination = header.destination;
    s.vlan = header.vlan;
    if (time_ns < s.last_ns) {
        s.first_ns += time_ns - s.last_ns; // the clock was set back: that is no time that passed
    }
    return &s;
}

void Observer::add_sv(Octets frame, std::int64_t time_ns) {
    if (auto const ok = decode_sv(frame, *sv_); !ok) {
        errors_.count(ok.error().reason);
        return;
    }
    bool wanted = false;
    for (Asdu const& asdu : sv_->view()) {
        if (!sv_id_.empty() && asdu.sv_id != sv_id_) {
            continue;
        }
        wanted = true;
        ObservedStream* const found = stream_of(false, asdu.sv_id, sv_->header, time_ns);
        if (found == nullptr) {
            continue;
        }
        ObservedStream& s = *found;
        if (s.last_frame != frames_) {
            s.last_frame = frames_;
            ++s.frames;
            s.asdus = 0;
            seen_.push_back({&s, true});
        }
        ++s.asdus;
        s.last_ns = time_ns;
        s.simulated = sv_->header.simulated();
        s.conf_rev = asdu.conf_rev;
        s.smp_synch = asdu.smp_synch;
        s.sample_octets = asdu.sample.size();
        if (s.counter->receive(asdu.smp_cnt, time_ns).event != SvEvent::duplicate) {
            std::find_if(seen_.begin(), seen_.end(), [&](Seen const& seen) { return seen.stream == &s; })->duplicate =
                false;
        }
        auto const& c = s.counter->counters();
        s.lost = c.lost;
        s.duplicates = c.of(SvEvent::duplicate);
        s.out_of_order = c.of(SvEvent::late);
        s.restarts = c.of(SvEvent::restart);
    }
    unwanted_ += wanted ? 0 : 1;
}

void Observer::add_goose(Octets frame, std::int64_t time_ns) {
    if (auto const ok = decode_goose(frame, goose_); !ok) {
        errors_.count(ok.error().reason);
        return;
    }
    GooseFrame const& m = goose_;
    ObservedStream* const found = stream_of(true, m.gocb_ref, m.header, time_ns);
    if (found == nullptr) {
        return;
    }
    ObservedStream& s = *found;
    bool const first = s.frames++ == 0;
    std::uint64_t const since = std::uint64_t{m.t.seconds} << 24U | m.t.fraction;
    bool const again = !first && m.st_num == s.st_num && since > s.since; // its number, and it began later: a restart
    bool const same_state = !first && m.st_num == s.st_num && !again;
    double const interval_ms = static_cast<double>(time_ns - s.last_ns) * 1e-6;
    bool const duplicate = same_state && m.sq_num == s.sq_num;
    seen_.push_back({&s, duplicate});
    if (duplicate) {
        ++s.duplicates;
        return;
    }
    if (same_state && m.sq_num < s.sq_num && !(s.sq_num == 0xFFFFFFFF && m.sq_num == 1)) {
        ++s.out_of_order;
        return;
    }
    if (!first) {
        bool const known = interval_ms >= 0; // less: the clock was set back
        if (known && s.intervals.size() < ObservedStream::kIntervals) {
            s.intervals.push_back({interval_ms, same_state});
        }
        s.late += interval_ms > s.live_ms ? 1 : 0;
        if (same_state) {
            s.lost += m.sq_num > s.sq_num ? m.sq_num - s.sq_num - 1 : 0;
            s.burst_whole = s.burst_whole && known;
            if (s.burst_whole && !s.bursts.empty() && s.bursts.back().size() < ObservedStream::kBurst) {
                s.bursts.back().push_back(interval_ms);
            }
        } else {
            ++s.states;
            bool const from_one = m.st_num == 1 && s.st_num != 0xFFFFFFFF; // no wrap
            bool const restarted = again || m.st_num < s.st_num || from_one;
            s.restarts += restarted ? 1 : 0;
            s.lost += m.sq_num - (again && m.sq_num > 0 ? 1 : 0); // the first of a device that starts has sqNum 1
            s.burst_whole = true;
            if (s.bursts.size() < ObservedStream::kBursts) {
                s.bursts.emplace_back();
            }
        }
    }
    s.st_num = m.st_num;
    s.sq_num = m.sq_num;
    s.since = since;
    s.live_ms = m.live_ms;
    s.conf_rev = m.conf_rev;
    s.simulated = m.simulated();
    s.values = data_text(m);
    s.last_ns = time_ns;
}

/// Each message of a datagram as if it had come in a frame of its own, between the same stations.
void Observer::add_routed(Octets frame, Octets datagram, std::int64_t time_ns) {
    if (auto const ok = decode_routable(datagram, *routable_); !ok) {
        errors_.count(ok.error().reason);
        return;
    }
    routed_ = true;
    for (RoutablePayload const& payload : routable_->view()) {
        as_ethernet(frame, payload, rewrapped_);
        payload.goose ? add_goose(rewrapped_, time_ns) : add_sv(rewrapped_, time_ns);
    }
    routed_ = false;
}

std::span<Observer::Seen const> Observer::add(Octets frame, std::int64_t time_ns) {
    ++frames_;
    seen_.clear();
    switch (ethertype_of(frame)) {
    case kSvEthertype:
        add_sv(frame, time_ns);
        break;
    case kGooseEthertype:
        add_goose(frame, time_ns);
        break;
    default:
        if (Octets const datagram = routable_payload(frame); !datagram.empty()) {
            add_routed(frame, datagram, time_ns);
        } else {
            ++other_;
        }
    }
    return seen_;
}

std::vector<ObservedStream const*> Observer::streams() const {
    std::vector<ObservedStream const*> out;
    for (auto const& [key, stream] : streams_) {
        out.push_back(&stream);
    }
    return out;
}

} // namespace gridspace::wire
