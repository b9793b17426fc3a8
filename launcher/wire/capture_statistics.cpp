// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/wire/capture_statistics.hpp"

#include "common/nearest_rank.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unordered_map>

namespace gridspace::wire {
namespace {

using iec61850::Octets;

constexpr std::array<TransferClass, 7> kClasses{{
    {"TT6", 3, "trips, blockings, raw data"},
    {"TT5", 10, "releases, status changes"},
    {"TT4", 20, "fast automatic interactions"},
    {"TT3", 100, "slow automatic interactions"},
    {"TT2", 500, "operator commands"},
    {"TT1", 1000, "events, alarms"},
    {"TT0", 1e12, "files, events, logs"},
}};

/// FNV-1a without the VLAN tag: a switch may take it off.
std::uint64_t identity(Octets frame) {
    std::uint64_t hash = 1469598103934665603ULL;
    auto const mix = [&](Octets part) {
        for (std::uint8_t const octet : part) {
            hash = (hash ^ octet) * 1099511628211ULL;
        }
    };
    bool const tagged =
        frame.size() >= 18 && iec61850::load_be<std::uint16_t>(frame.data() + 12) == iec61850::kVlanEthertype;
    mix(frame.first(std::min<std::size_t>(12, frame.size())));
    mix(frame.subspan(std::min<std::size_t>(tagged ? 16 : 12, frame.size())));
    return hash;
}

/// The same frame at several points, within a second.
struct Sightings {
    static constexpr std::uint32_t kNowhere = UINT32_MAX;
    struct First {
        std::int64_t time_ns;
        std::uint32_t points;
        std::uint32_t interface;
        std::uint32_t counted_at; ///< where it was first seen at an end of a cable
        std::int64_t last_ns;
    };
    std::unordered_map<std::uint64_t, First> frames;

    /// True when the frame is new. What is seen in the middle of a cable may never come out of it, and is not counted.
    bool add(std::uint64_t key, std::uint32_t interface, bool inside, std::int64_t time_ns) {
        First const fresh{time_ns, 1, interface, inside ? kNowhere : interface, time_ns};
        auto const [at, is_first] = frames.try_emplace(key, fresh);
        if (is_first) {
            return !inside;
        }
        First& first = at->second;
        if (interface == first.interface || interface == first.counted_at || time_ns - first.time_ns > 1'000'000'000) {
            first = fresh; // repeated, not seen again
            return !inside;
        }
        ++first.points;
        first.last_ns = std::max(first.last_ns, time_ns);
        if (inside || first.counted_at != kNowhere) {
            return false;
        }
        first.counted_at = interface;
        return true;
    }
};

double median(std::vector<double> values) {
    return percentiles(values).p50;
}

void describe_bursts(StreamStatistics& out) {
    for (std::size_t k = 0; k < ObservedStream::kBurst; ++k) {
        std::vector<double> kth;
        for (auto const& burst : out.stream.bursts) {
            if (burst.size() > k) {
                kth.push_back(burst[k]);
            }
        }
        if (kth.empty()) {
            return;
        }
        out.burst_ms.push_back(median(kth));
    }
}

using Stream = ObservedStream const*;
using StreamsByFrame = std::unordered_map<std::uint64_t, std::vector<Stream>>;

/// From frame to frame of each stream.
struct Intervals {
    std::unordered_map<Stream, std::vector<double>> ms;
    std::unordered_map<Stream, std::int64_t> last_ns;

    void add(Stream stream, std::int64_t time_ns) {
        auto const [last, is_first] = last_ns.try_emplace(stream, time_ns);
        if (!is_first && time_ns >= last->second) {
            ms[stream].push_back(static_cast<double>(time_ns - last->second) * 1e-6);
        }
        last->second = time_ns;
    }
};

/// From the first point that saw a frame to the last, ms.
std::unordered_map<Stream, std::vector<double>> delays_of(Sightings const& sightings, StreamsByFrame const& streams) {
    std::unordered_map<Stream, std::vector<double>> delays;
    for (auto const& [key, seen] : sightings.frames) {
        auto const of_frame = streams.find(key);
        if (seen.points < 2 || of_frame == streams.end()) {
            continue;
        }
        for (Stream const stream : of_frame->second) {
            delays[stream].push_back(static_cast<double>(seen.last_ns - seen.time_ns) * 1e-6);
        }
    }
    return delays;
}

StreamStatistics statistics_of(ObservedStream const& stream, std::vector<double>& intervals_ms,
                               std::vector<double>& delays_ms) {
    StreamStatistics s;
    s.stream = stream;
    s.interval_ms = percentiles(intervals_ms);
    if (!delays_ms.empty()) {
        s.delay_ms = percentiles(delays_ms);
    }
    if (stream.goose) {
        s.steady_ms = steady_interval_ms(stream.intervals);
        describe_bursts(s);
    }
    return s;
}

/// What of the capture could not be used, a line for each reason.
std::string text_of_losses(CaptureStatistics const& c) {
    std::string out;
    if (c.other > 0) {
        out += fmt::format("{} frames of other protocols\n", c.other);
    }
    if (c.no_ethernet > 0) {
        out += fmt::format("{} frames of interfaces that are no Ethernet: not looked at\n", c.no_ethernet);
    }
    if (c.cut > 0) {
        out += fmt::format("{} frames were cut by the capture (its snap length)\n", c.cut);
    }
    if (c.clock_back > 0) {
        out += fmt::format("the capture's clock went back {} time{}: the intervals there are left out\n", c.clock_back,
                           c.clock_back == 1 ? "" : "s");
    }
    for (std::size_t i = 0; i < iec61850::kReasons; ++i) {
        if (c.errors.by_reason[i] > 0) {
            out += fmt::format("{} frames could not be read: {}\n", c.errors.by_reason[i],
                               reason_name(static_cast<iec61850::Reason>(i)));
        }
    }
    return out;
}

std::string text_of(StreamStatistics const& s) {
    ObservedStream const& o = s.stream;
    std::string out =
        fmt::format("\n{} {}  APPID 0x{:04X}  {} -> {}{}\n",
                    o.routed  ? (o.goose ? "R-GOOSE" : "R-SV")
                    : o.goose ? "GOOSE"
                              : "SMV",
                    o.id, o.app_id, o.source.to_string(), o.destination.to_string(), o.simulated ? "  simulated" : "");
    out += fmt::format("  {} frames, lost {}, duplicate {}, out of order {}, restarts {}\n", o.frames, o.lost,
                       o.duplicates, o.out_of_order, o.restarts);
    if (o.goose) {
        out += fmt::format(
            "  {} changes of state; {}; {} came after their time to live\n", o.states,
            s.steady_ms ? fmt::format("steady interval {:.3f} ms", *s.steady_ms) : "never in steady state", o.late);
        if (!s.burst_ms.empty()) {
            out += "  retransmission curve, ms:";
            for (double const ms : s.burst_ms) {
                out += fmt::format(" {:.3f}", ms);
            }
            out += '\n';
        }
    } else {
        out += fmt::format("  {:.3f} samples/s in {} per frame; {} octets of data; synchronised {}{}\n", o.rate_hz(),
                           o.asdus, o.sample_octets,
                           o.smp_synch == 0   ? "no"
                           : o.smp_synch == 1 ? "locally"
                           : o.smp_synch == 2 ? "globally"
                                              : fmt::format("to clock {}", o.smp_synch),
                           o.counter->wrap_known() ? fmt::format("; counter wraps at {}", o.counter->wrap()) : "");
    }
    Percentiles const& i = s.interval_ms;
    out += i.count == 0 ? std::string{"  interval: not measurable, fewer than two frames that are no duplicates\n"}
                        : fmt::format("  interval ms: min {:.3f}  p50 {:.3f}  p99 {:.3f}  p99.9 {:.3f}  max {:.3f}\n",
                                      i.min, i.p50, i.p99, i.p999, i.max);
    if (s.delay_ms) {
        Percentiles const& d = *s.delay_ms;
        TransferClass const* const met = tightest_class(d.p999);
        out += fmt::format(
            "  delay ms: p50 {:.4f}  p99 {:.4f}  p99.9 {:.4f}  max {:.4f}; p99.9 meets {} of IEC 61850-5 ({})\n", d.p50,
            d.p99, d.p999, d.max, met->name, met->use);
    } else {
        out += "  delay: not measurable, the capture saw these frames at one point\n";
    }
    return out;
}

nlohmann::ordered_json json_of(Percentiles const& p) {
    return {{"count", p.count}, {"min", p.min}, {"p50", p.p50},  {"p99", p.p99},
            {"p99.9", p.p999},  {"max", p.max}, {"mean", p.mean}};
}

} // namespace

Percentiles percentiles(std::vector<double>& values) {
    Percentiles out;
    out.count = values.size();
    if (values.empty()) {
        return out;
    }
    std::sort(values.begin(), values.end());
    double sum = 0;
    for (double const v : values) {
        sum += v;
    }
    return {values.size(),
            values.front(),
            nearest_rank(values, 0.5),
            nearest_rank(values, 0.99),
            nearest_rank(values, 0.999),
            values.back(),
            sum / static_cast<double>(values.size())};
}

TransferClass const* tightest_class(double delay_ms) {
    auto const found =
        std::find_if(kClasses.begin(), kClasses.end(), [&](TransferClass const& c) { return delay_ms <= c.limit_ms; });
    return found == kClasses.end() ? nullptr : &*found;
}

Result<CaptureStatistics> capture_statistics(std::filesystem::path const& file) {
    auto reader = pcapng::Reader::open(file);
    if (!reader) {
        return std::unexpected{reader.error()};
    }
    Observer observer;
    Sightings sightings;
    StreamsByFrame streams_by_frame;
    Intervals intervals;
    std::unordered_map<std::uint32_t, std::int64_t> last_of_interface;
    CaptureStatistics out;
    std::int64_t begin = 0, end = 0;
    auto const read = reader->each([&](pcapng::Frame const& frame) {
        Octets const octets{frame.octets};
        std::int64_t const time = frame.time_ns;
        begin = out.frames == 0 ? time : std::min(begin, time);
        end = std::max(end, time);
        ++out.frames;
        auto const [clock, first_of_interface] = last_of_interface.try_emplace(frame.interface, time);
        out.clock_back += !first_of_interface && time < clock->second ? 1 : 0;
        clock->second = time;
        if (reader->interfaces()[frame.interface].link_type != pcapng::kEthernetLink) {
            ++out.no_ethernet;
            return;
        }
        out.cut += frame.original_octets > octets.size() ? 1 : 0;
        std::uint64_t const key = identity(octets);
        bool const inside = pcapng::is_inside_a_cable(reader->interfaces()[frame.interface].name);
        if (!sightings.add(key, frame.interface, inside, time)) {
            return;
        }
        std::vector<Stream>& streams = streams_by_frame[key];
        streams.clear();
        for (auto const& [stream, duplicate] : observer.add(octets, time)) {
            streams.push_back(stream);
            if (!duplicate) {
                intervals.add(stream, time);
            }
        }
    });
    if (!read) {
        return std::unexpected{read.error()};
    }
    out.seconds = static_cast<double>(end - begin) * 1e-9;
    out.truncated = reader->truncated();
    out.other = observer.other();
    out.errors = observer.errors();
    for (pcapng::Interface const& interface : reader->interfaces()) {
        out.points.push_back(visible(interface.name));
    }
    auto delays = delays_of(sightings, streams_by_frame);
    for (Stream const stream : observer.streams()) {
        out.streams.push_back(statistics_of(*stream, intervals.ms[stream], delays[stream]));
    }
    return out;
}

std::string to_text(CaptureStatistics const& c) {
    std::string out =
        fmt::format("{} frames in {:.6f} s, at {} point{}{}\n", c.frames, c.seconds, c.points.size(),
                    c.points.size() == 1 ? "" : "s", c.truncated ? "; the file ends in the middle of a frame" : "");
    out += text_of_losses(c);
    for (StreamStatistics const& s : c.streams) {
        out += text_of(s);
    }
    return out;
}

std::string to_json(CaptureStatistics const& c) {
    nlohmann::ordered_json out{{"frames", c.frames},
                               {"seconds", c.seconds},
                               {"truncated", c.truncated},
                               {"points", c.points},
                               {"other", c.other},
                               {"no_ethernet", c.no_ethernet},
                               {"cut", c.cut},
                               {"clock_back", c.clock_back},
                               {"undecodable", c.errors.total()},
                               {"streams", nlohmann::ordered_json::array()}};
    for (StreamStatistics const& s : c.streams) {
        ObservedStream const& o = s.stream;
        nlohmann::ordered_json j{{"kind", o.goose ? "goose" : "smv"},
                                 {"routed", o.routed},
                                 {"id", o.id},
                                 {"app_id", o.app_id},
                                 {"source", o.source.to_string()},
                                 {"destination", o.destination.to_string()},
                                 {"simulated", o.simulated},
                                 {"conf_rev", o.conf_rev},
                                 {"frames", o.frames},
                                 {"lost", o.lost},
                                 {"duplicates", o.duplicates},
                                 {"out_of_order", o.out_of_order},
                                 {"restarts", o.restarts},
                                 {"interval_ms", json_of(s.interval_ms)}};
        if (o.goose) {
            j["states"] = o.states;
            j["late"] = o.late;
            j["steady_ms"] = s.steady_ms ? nlohmann::ordered_json(*s.steady_ms) : nlohmann::ordered_json(nullptr);
            j["burst_ms"] = s.burst_ms;
        } else {
            j["rate_hz"] = o.rate_hz();
            j["samples_per_frame"] = o.asdus;
            j["sample_octets"] = o.sample_octets;
            j["smp_synch"] = o.smp_synch;
            j["wrap"] =
                o.counter->wrap_known() ? nlohmann::ordered_json(o.counter->wrap()) : nlohmann::ordered_json(nullptr);
        }
        if (s.delay_ms) {
            j["delay_ms"] = json_of(*s.delay_ms);
            j["delay_class"] = tightest_class(s.delay_ms->p999)->name;
        } else {
            j["delay_ms"] = nullptr;
        }
        out["streams"].push_back(std::move(j));
    }
    return out.dump(2) + "\n";
}

} // namespace gridspace::wire
