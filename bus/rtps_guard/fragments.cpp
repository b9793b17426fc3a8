// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/rtps_guard/fragments.hpp"

#include "bus/rtps_guard/parameter_guard.hpp"
#include "bus/rtps_guard/submessages.hpp"

#include <algorithm>
#include <map>

namespace gridspace::rtps_guard {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put(Bytes& to, std::uint32_t value, std::size_t octets, bool little) {
    for (std::size_t i = 0; i < octets; ++i) {
        to.push_back(static_cast<std::uint8_t>(value >> (8 * (little ? i : octets - 1 - i))));
    }
}

void put(Bytes& to, std::span<std::uint8_t const> octets) {
    to.insert(to.end(), octets.begin(), octets.end());
}

} // namespace

void Fragments::account(Sample const& sample, bool more) {
    std::size_t const octets = sample.octets.size();
    Held& held = held_[sample.sender];
    held.samples += more ? 1 : -std::size_t{1};
    held.octets += more ? octets : -octets;
    octets_ += more ? octets : -octets;
    if (held.samples == 0) {
        held_.erase(sample.sender);
    }
}

void Fragments::forget(Samples::iterator sample) {
    account(*sample, false);
    waiting_.erase(sample);
}

void Fragments::forget_silent(std::int64_t now_ns) {
    constexpr std::int64_t kLookEveryNs = 1'000'000'000;
    if (looked_ns_ != INT64_MIN && now_ns - looked_ns_ < kLookEveryNs) {
        return; // each new sample would look at all
    }
    looked_ns_ = now_ns;
    for (auto it = waiting_.begin(); it != waiting_.end();) {
        auto const next = std::next(it);
        if (now_ns - it->heard_ns > kForgottenAfterNs) {
            forget(it);
        }
        it = next;
    }
}

void Fragments::make_room(GuidPrefix const& sender, std::size_t octets) {
    auto const drop_oldest_of = [&](GuidPrefix const& who) {
        forget(std::ranges::find(waiting_, who, &Sample::sender));
    };
    for (auto it = held_.find(sender);
         it != held_.end() && (it->second.samples >= kMaxSamplesOfOne || it->second.octets + octets > kMaxOctetsOfOne);
         it = held_.find(sender)) {
        drop_oldest_of(sender);
    }
    auto const most = [&](std::size_t Held::* what) { // who holds most makes room
        return GuidPrefix{
            std::ranges::max_element(held_, {}, [&](auto const& entry) { return entry.second.*what; })->first};
    };
    while (octets_ + octets > kMaxOctets && !waiting_.empty()) {
        drop_oldest_of(most(&Held::octets));
    }
    while (waiting_.size() >= kMaxSamples) {
        drop_oldest_of(most(&Held::samples));
    }
}

Fragments::Samples Fragments::take(GuidPrefix const& sender, GuidPrefix const& source, std::uint8_t flags, Octets body,
                                   std::int64_t now_ns) {
    body.skip(2);
    std::size_t const to_qos = body.u16(), counted_from = body.at();
    Name name{source, body.entity(), body.entity(), 0};
    name.sequence = body.sequence_number();
    std::uint32_t const first = body.u32() - 1, count = body.u16(), size = body.u16(), whole = body.u32();
    body.skip(to_qos - (body.at() - counted_from));
    std::span<std::uint8_t> qos;
    if ((flags & 2U) != 0) {
        Octets list = body;
        qos = body.take(examine_parameters(list, false)->octets);
    }
    auto it = std::ranges::find(waiting_, name, &Sample::name);
    if (it != waiting_.end() && (it->octets.size() != whole || it->fragment != size)) {
        return {}; // another opinion of the same sample: the first one counts
    }
    if (it == waiting_.end()) {
        forget_silent(now_ns);
        make_room(sender, whole);
        std::uint32_t const fragments = (whole + size - 1) / size;
        it = waiting_.insert(
            waiting_.end(),
            {name, sender, size, fragments, std::vector<bool>(fragments), Bytes(whole), {}, body.little(), now_ns});
        account(*it, true);
    }
    it->heard_ns = now_ns;
    if (first == 0) {
        it->qos.assign(qos.begin(), qos.end());
        it->little = body.little();
    }
    for (std::uint32_t i = first; i < first + count; ++i) {
        std::size_t const at = std::size_t{i} * size;
        auto const octets = body.take(std::min<std::size_t>(size, whole - at));
        std::ranges::copy(octets, it->octets.begin() + static_cast<std::ptrdiff_t>(at));
        it->missing -= it->here[i] ? 0 : 1;
        it->here[i] = true;
    }
    Samples out;
    if (it->missing == 0) {
        account(*it, false);
        out.splice(out.end(), waiting_, it);
    }
    return out;
}

void Fragments::put_data(Bytes& message, Sample const& whole) {
    message.push_back(kData);
    message.push_back(static_cast<std::uint8_t>((whole.little ? 1U : 0U) | (whole.qos.empty() ? 0U : 2U) | 4U));
    put(message, 0, 2, true); // as long as the message: a sample may have more octets than this can count
    put(message, 0, 2, true);
    put(message, 16, 2, whole.little); // to the inline QoS
    put(message, whole.name.reader, 4, false);
    put(message, whole.name.writer, 4, false);
    put(message, static_cast<std::uint32_t>(whole.name.sequence >> 32U), 4, whole.little);
    put(message, static_cast<std::uint32_t>(whole.name.sequence), 4, whole.little);
    put(message, whole.qos);
    put(message, whole.octets);
}

std::vector<Bytes> Fragments::take(std::span<std::uint8_t> datagram, std::int64_t now_ns) {
    Bytes const header{datagram.begin(), datagram.begin() + kHeader};
    Octets prefix{datagram};
    prefix.skip(8);
    GuidPrefix const sender = prefix.prefix();
    GuidPrefix source = sender;            // until an INFO_SRC says otherwise
    std::map<std::uint8_t, Bytes> context; // what holds for all that follows in the message, by kind
    auto const begun = [&] {
        Bytes out = header;
        for (std::uint8_t const kind : {kInfoSrc, kInfoDst, kInfoTs}) {
            put(out, context[kind]);
        }
        return out;
    };
    std::vector<Bytes> out;
    Bytes between = header;
    bool says_something = false;
    auto const end_between = [&] {
        if (says_something) {
            out.push_back(std::move(between));
        }
        between = begun();
        says_something = false;
    };
    for (Octets rest{datagram.subspan(kHeader)}; rest.left() > 0;) {
        auto const all = datagram.subspan(kHeader + rest.at());
        Submessage const s = *next_submessage(rest); // examine() has seen that there is one
        auto const octets = all.first(all.size() - rest.left());
        if (s.kind == kDataFrag) {
            for (Sample const& whole : take(sender, source, s.flags, s.body, now_ns)) {
                end_between();
                Bytes message = begun();
                put_data(message, whole);
                out.push_back(std::move(message));
            }
            continue;
        }
        put(between, octets);
        if (s.kind == kInfoSrc || s.kind == kInfoDst || s.kind == kInfoTs) {
            context[s.kind].assign(octets.begin(), octets.end());
            Octets body = s.body;
            body.skip(8);
            source = s.kind == kInfoSrc ? body.prefix() : source;
        } else {
            says_something = true;
        }
    }
    end_between();
    return out;
}

} // namespace gridspace::rtps_guard
