// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/intrusion_recording.hpp"

#include "recorder/mcap/mcap_reader.hpp"
#include "recorder/signals/cdr_cursor.hpp"

#include <algorithm>
#include <map>

namespace gridspace::launcher {
namespace {

// idl/intrusion.idl
constexpr std::uint8_t kJudged = 1, kFlagged = 2, kOpenFlagged = 4;

IntrusionRecording::Phase read_phase(CdrCursor& cdr) {
    IntrusionRecording::Phase out;
    out.raw_a = cdr.number<float>();
    out.forecast_a = cdr.number<float>();
    out.accepted_a = cdr.number<float>();
    out.limit_a = cdr.number<float>();
    out.open_forecast_a = cdr.number<float>();
    auto const flags = cdr.number<std::uint8_t>();
    out.judged = (flags & kJudged) != 0;
    out.flagged = (flags & kFlagged) != 0;
    out.open_flagged = (flags & kOpenFlagged) != 0;
    return out;
}

using Tracks = std::map<std::pair<std::string, std::string>, IntrusionRecording::Track>;

void read_verdicts(std::span<std::byte const> data, Tracks& tracks) {
    CdrCursor cdr{data};
    std::string detector = cdr.text(), stream = cdr.text();
    (void)cdr.number<std::int64_t>(); // time of the last sample
    auto index = static_cast<std::int64_t>(cdr.number<std::uint64_t>());
    auto const num = cdr.number<std::uint32_t>(), den = cdr.number<std::uint32_t>();
    auto const count = cdr.number<std::uint32_t>();
    if (!cdr.ok() || num == 0 || den == 0) {
        return;
    }
    IntrusionRecording::Track& track = tracks[{detector, stream}];
    track.rate_hz = static_cast<double>(num) / den;
    for (std::uint32_t i = 0; i < count; ++i) {
        IntrusionRecording::Sample sample;
        sample.index = index++;
        for (auto& phase : sample.phases) {
            phase = read_phase(cdr);
        }
        if (!cdr.ok()) {
            return;
        }
        track.samples.push_back(sample);
    }
}

template <class OnLabel>
void read_labels(std::span<std::byte const> data, OnLabel const& on_label) {
    CdrCursor cdr{data};
    IntrusionRecording::Label label;
    label.attack = cdr.text();
    label.kind = cdr.text();
    label.target = cdr.text();
    label.sent_ns = cdr.number<std::int64_t>();
    auto const count = cdr.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        label.index = static_cast<std::int64_t>(cdr.number<std::uint64_t>());
        label.channel = cdr.number<std::uint8_t>();
        label.true_value = cdr.number<double>();
        label.sent_value = cdr.number<double>();
        if (!cdr.ok()) {
            return;
        }
        on_label(label);
    }
}

} // namespace

IntrusionRecording::Track const* IntrusionRecording::find(std::string const& detector,
                                                          std::string const& stream) const {
    auto const it = std::find_if(tracks.begin(), tracks.end(),
                                 [&](Track const& t) { return t.detector == detector && t.stream == stream; });
    return it == tracks.end() ? nullptr : &*it;
}

Result<IntrusionRecording> read_intrusion_recording(std::filesystem::path const& mcap) {
    IntrusionRecording out;
    Tracks tracks;
    auto const read = mcap::read_messages(mcap, [&](mcap::Message const& message) {
        if (message.schema.name == "IdsVerdict") {
            read_verdicts(message.data, tracks);
        } else if (message.schema.name == "AttackLabel") {
            read_labels(message.data, [&](IntrusionRecording::Label const& label) { out.labels.push_back(label); });
        }
        return true;
    });
    if (!read) {
        return std::unexpected{read.error()};
    }
    for (auto& [key, track] : tracks) {
        track.detector = key.first;
        track.stream = key.second;
        std::stable_sort(track.samples.begin(), track.samples.end(),
                         [](auto const& a, auto const& b) { return a.index < b.index; });
        out.tracks.push_back(std::move(track));
    }
    return out;
}

Result<std::string> read_attack_labels(std::filesystem::path const& mcap,
                                       std::function<void(IntrusionRecording::Label const&)> const& on_label) {
    auto const read = mcap::read_messages(mcap, [&](mcap::Message const& message) {
        if (message.schema.name == "AttackLabel") {
            read_labels(message.data, on_label);
        }
        return true;
    });
    if (!read) {
        return std::unexpected{read.error()};
    }
    return read->complete ? std::string{} : read->note.empty() ? "it was cut" : read->note;
}

} // namespace gridspace::launcher
