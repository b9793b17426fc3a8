// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/scan/capture_scan.hpp"

#include "common/text.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <algorithm>
#include <functional>
#include <set>

namespace gridspace::scan {
namespace {

constexpr std::size_t kMostVantages = 64, kMostStreams = 1024;

using OnFrame = std::function<void(std::string const& vantage, iec61850::Octets octets, Place at)>;

/// All Ethernet frames of the interfaces that are wanted.
Result<void> read_frames(ScanOptions const& options, CaptureScan& out, OnFrame const& on_frame) {
    auto reader = pcapng::Reader::open(options.file);
    if (!reader) {
        return std::unexpected{reader.error()};
    }
    out.frames = out.no_ethernet = out.cut = 0;
    std::set<std::string> names;
    bool found = options.only.empty();
    auto const read = reader->each([&](pcapng::Frame const& frame) {
        Place const at{frame.time_ns, ++out.frames};
        out.first_ns = out.frames == 1 ? at.time_ns : std::min(out.first_ns, at.time_ns);
        out.last_ns = out.frames == 1 ? at.time_ns : std::max(out.last_ns, at.time_ns);
        pcapng::Interface const& interface = reader->interfaces()[frame.interface];
        if (interface.link_type != pcapng::kEthernetLink) {
            ++out.no_ethernet;
            return;
        }
        std::string const vantage = vantage_of(interface.name);
        bool const wanted = options.only.empty() || options.only == interface.name || options.only == vantage;
        found = found || wanted;
        if (names.size() < kMostVantages) {
            names.insert(vantage);
        }
        if (wanted) {
            out.cut += frame.original_octets > frame.octets.size() ? 1U : 0U;
            on_frame(vantage, frame.octets, at);
        }
    });
    if (!read) {
        return read;
    }
    out.truncated = reader->truncated();
    return found ? Result<void>{}
                 : fail(ExitCode::usage,
                        fmt::format("'{}' has no frame of an interface '{}'", options.file.string(), options.only),
                        fmt::format("there are: {}", join({names.begin(), names.end()}, ", ")));
}

/// What there is, before it is judged.
struct Survey {
    std::map<std::string, wire::Observer> vantages;

    void add(CaptureScan& scan, std::string const& vantage, iec61850::Octets octets, Place at) {
        if (vantages.size() >= kMostVantages && !vantages.contains(vantage)) {
            ++scan.beyond_table;
            return;
        }
        vantages[vantage].add(octets, at.time_ns);
    }
};

struct Watch {
    std::optional<SvWatch> sv;
    std::optional<GooseWatch> goose;
    StreamScan scan;
};

struct WatchedLine {
    LineWatch watch;
    LineScan scan;
};

/// Everything that is watched at one place.
struct Vantage {
    std::map<std::pair<bool, std::string>, Watch> streams; ///< by kind and name on the wire
    std::vector<WatchedLine> lines;
    std::int64_t last_ns{INT64_MIN};
};

using Senders = std::vector<wire::ObservedStream const*>;

std::map<std::pair<bool, std::string>, Senders> by_name(wire::Observer const& observer) {
    std::map<std::pair<bool, std::string>, Senders> out;
    for (wire::ObservedStream const* stream : observer.streams()) {
        out[{stream->goose, stream->id}].push_back(stream);
    }
    return out;
}

class Scanner {
  public:
    Scanner(ScanOptions const& options, CaptureScan& scan) : options_{options}, scan_{scan} {}

    Result<void> begin(Survey const& survey) {
        std::vector<bool> line_found(options_.lines.size());
        for (auto const& [name, observer] : survey.vantages) {
            auto const streams = by_name(observer);
            Vantage vantage;
            if (auto ok = begin_lines(name, streams, vantage, line_found); !ok) {
                return ok;
            }
            begin_streams(name, streams, vantage);
            for (std::size_t i = 0; i < iec61850::kReasons; ++i) {
                scan_.errors.by_reason[i] += observer.errors().by_reason[i];
            }
            scan_.other += observer.other();
            scan_.beyond_table += observer.beyond_table();
            vantages_.emplace(name, std::move(vantage));
        }
        return check(survey, line_found);
    }

    void frame(std::string const& name, iec61850::Octets octets, Place at) {
        auto const found = vantages_.find(name);
        if (found == vantages_.end()) {
            return;
        }
        Vantage& vantage = found->second;
        vantage.last_ns = std::max(vantage.last_ns, at.time_ns);
        std::uint16_t const ethertype = iec61850::ethertype_of(octets);
        if (ethertype == iec61850::kSvEthertype && iec61850::decode_sv(octets, *sv_)) {
            auto const asdus = sv_->view();
            for (std::size_t i = 0; i < asdus.size(); ++i) {
                if (auto const w = vantage.streams.find({false, wire::visible(asdus[i].sv_id)});
                    w != vantage.streams.end()) {
                    w->second.sv->take(sv_->header, asdus[i], i, at);
                }
            }
            for (WatchedLine& line : vantage.lines) {
                line.watch.frame(octets, at);
            }
        } else if (ethertype == iec61850::kGooseEthertype && iec61850::decode_goose(octets, goose_)) {
            if (auto const w = vantage.streams.find({true, wire::visible(goose_.gocb_ref)});
                w != vantage.streams.end()) {
                w->second.goose->take(goose_, at);
            }
        }
    }

    void finish() {
        for (auto& [name, vantage] : vantages_) {
            for (WatchedLine& line : vantage.lines) {
                line.watch.finish({vantage.last_ns, scan_.frames});
                line.watch.report(line.scan);
                scan_.lines.push_back(std::move(line.scan));
            }
            for (auto& [key, watch] : vantage.streams) {
                bool const alive = std::ranges::any_of(
                    watch.scan.senders, [&](wire::ObservedStream const& s) { return s.alive(vantage.last_ns); });
                if (watch.sv) {
                    watch.sv->finish(vantage.last_ns, alive);
                    watch.sv->report(watch.scan);
                } else {
                    watch.goose->finish(vantage.last_ns, alive);
                    watch.goose->report(watch.scan);
                }
                std::stable_sort(watch.scan.alarms.begin(), watch.scan.alarms.end(),
                                 [](Alarm const& a, Alarm const& b) { return a.first.frame < b.first.frame; });
                scan_.streams.push_back(std::move(watch.scan));
            }
        }
    }

  private:
    using Streams = std::map<std::pair<bool, std::string>, Senders>;

    Result<void> begin_lines(std::string const& name, Streams const& streams, Vantage& vantage,
                             std::vector<bool>& line_found) {
        for (std::size_t i = 0; i < options_.lines.size(); ++i) {
            std::string const from = options_.known.wire_name(options_.lines[i].from),
                              to = options_.known.wire_name(options_.lines[i].to);
            auto const f = streams.find({false, from}), t = streams.find({false, to});
            if (f == streams.end() || t == streams.end()) {
                continue;
            }
            auto watch = LineWatch::create(options_.known.describe(from, f->second),
                                           options_.known.describe(to, t->second), options_.forecast);
            if (!watch) {
                return std::unexpected{watch.error()};
            }
            line_found[i] = true;
            LineScan scan;
            scan.vantage = name;
            scan.from = from;
            scan.to = to;
            vantage.lines.push_back({std::move(*watch), std::move(scan)});
        }
        return {};
    }

    void begin_streams(std::string const& name, Streams const& streams, Vantage& vantage) {
        for (auto const& [key, senders] : streams) {
            auto const& [goose, id] = key;
            if (!is_wanted(id)) {
                continue;
            }
            if (watched_ >= kMostStreams) {
                for (wire::ObservedStream const* s : senders) {
                    scan_.beyond_table += s->frames;
                }
                continue;
            }
            ++watched_;
            Watch watch;
            watch.scan.vantage = name;
            watch.scan.goose = goose;
            watch.scan.id = id;
            for (wire::ObservedStream const* s : senders) {
                watch.scan.senders.push_back(*s);
            }
            std::stable_sort(watch.scan.senders.begin(), watch.scan.senders.end(),
                             [](auto const& a, auto const& b) { return a.frames > b.frames; });
            if (goose) {
                watch.goose.emplace(options_.known.find(streams::Kind::goose, id), options_.check_clock);
            } else {
                bool const alone = std::none_of(vantage.lines.begin(), vantage.lines.end(), [&](WatchedLine const& l) {
                    return l.scan.from == id || l.scan.to == id;
                });
                watch.sv.emplace(options_.known.describe(id, senders), options_.forecast, alone);
            }
            vantage.streams.emplace(key, std::move(watch));
        }
    }

    [[nodiscard]] bool is_wanted(std::string const& id) const {
        return options_.streams.empty() ||
               std::any_of(options_.streams.begin(), options_.streams.end(),
                           [&](std::string const& wanted) { return options_.known.wire_name(wanted) == id; });
    }

    [[nodiscard]] Result<void> check(Survey const& survey, std::vector<bool> const& line_found) const {
        std::set<std::string> there;
        for (auto const& [name, observer] : survey.vantages) {
            for (wire::ObservedStream const* s : observer.streams()) {
                there.insert(s->id);
            }
        }
        std::string const file = options_.file.string();
        if (there.empty()) {
            return fail(ExitCode::usage,
                        fmt::format("'{}' holds no GOOSE and no sampled values that can be read", file),
                        scan_.cut > 0 ? "its frames were cut by the capture: record them whole" : "");
        }
        std::string const names = fmt::format("there are: {}", join({there.begin(), there.end()}, ", "));
        for (std::string const& name : options_.streams) {
            if (!there.contains(options_.known.wire_name(name))) {
                return fail(ExitCode::usage, fmt::format("there is no stream '{}' in '{}'", name, file), names);
            }
        }
        for (std::size_t i = 0; i < line_found.size(); ++i) {
            if (!line_found[i]) {
                return fail(ExitCode::usage,
                            fmt::format("there is no place in '{}' where both '{}' and '{}' were seen", file,
                                        options_.lines[i].from, options_.lines[i].to),
                            names);
            }
        }
        return {};
    }

    ScanOptions const& options_;
    CaptureScan& scan_;
    std::map<std::string, Vantage> vantages_;
    std::size_t watched_{0};
    std::unique_ptr<iec61850::SvFrame> sv_{std::make_unique<iec61850::SvFrame>()};
    iec61850::GooseFrame goose_;
};

} // namespace

bool CaptureScan::has_alarms() const {
    return std::any_of(streams.begin(), streams.end(), [](StreamScan const& s) { return !s.alarms.empty(); }) ||
           std::any_of(lines.begin(), lines.end(), [](LineScan const& l) { return !l.alarms.empty(); });
}

std::string vantage_of(std::string const& interface) {
    std::size_t const slash = interface.find('/');
    bool const is_port = slash != std::string::npos && slash > 0 && !pcapng::is_inside_a_cable(interface);
    return wire::visible(is_port ? interface.substr(0, slash) : interface);
}

Result<CaptureScan> scan_capture(ScanOptions const& options) {
    std::error_code ignored;
    if (std::filesystem::exists(options.file, ignored) && !std::filesystem::is_regular_file(options.file, ignored) &&
        !std::filesystem::is_directory(options.file, ignored)) {
        return fail(ExitCode::usage, fmt::format("'{}' is no regular file", options.file.string()),
                    "a capture is read twice: store it in a file first");
    }
    CaptureScan out;
    Survey survey;
    auto const surveyed = read_frames(options, out, [&](std::string const& vantage, iec61850::Octets octets, Place at) {
        survey.add(out, vantage, octets, at);
    });
    if (!surveyed) {
        return std::unexpected{surveyed.error()};
    }
    Scanner scanner{options, out};
    if (auto ok = scanner.begin(survey); !ok) {
        return std::unexpected{ok.error()};
    }
    auto const judged = read_frames(options, out, [&](std::string const& vantage, iec61850::Octets octets, Place at) {
        scanner.frame(vantage, octets, at);
    });
    if (!judged) {
        return std::unexpected{judged.error()};
    }
    scanner.finish();
    return out;
}

} // namespace gridspace::scan
