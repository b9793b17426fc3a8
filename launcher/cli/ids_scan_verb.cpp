// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace ids scan`: the detector and the first-line rules on somebody's capture.
#include "common/config/merge.hpp"
#include "common/text.hpp"
#include "ids/forecaster/model_file.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/ids_verbs.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/scl_file.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/ids/scan/scan_output.hpp"
#include "launcher/scenario/installation.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <memory>

namespace gridspace::cli {
namespace {

struct IdsScanArguments {
    std::filesystem::path capture, streams_file, scl_file, model, out;
    std::vector<std::string> streams, lines;
    std::string currents, only;
    double nominal_peak_a{0};
    bool into_line{false}, rules_only{false}, check_clock{false}, json{false};
};

Result<std::vector<streams::Stream>> read_described(IdsScanArguments const& a) {
    config::Diagnostics diagnostics;
    std::vector<streams::Stream> out;
    auto const add = [&](config::Node& all) {
        config::resolve_likes(all, diagnostics);
        auto read = streams::read_streams(all, diagnostics);
        std::move(read.begin(), read.end(), std::back_inserter(out));
    };
    if (!a.streams_file.empty()) {
        if (auto root = config::load_extended(a.streams_file, diagnostics)) {
            if (config::Node* const all = root->find("streams"); all != nullptr && all->is_map()) {
                add(*all);
            } else {
                diagnostics.error({}, fmt::format("'{}' has no `streams:`", a.streams_file.string()),
                                  "expected a scenario, or a file with streams (docs/reference/streams.md)");
            }
        }
    }
    if (!a.scl_file.empty()) {
        auto imported = read_scl_file(a.scl_file, {});
        if (!imported) {
            return std::unexpected{imported.error()};
        }
        add(imported->streams);
    }
    if (!diagnostics.ok()) {
        return fail(ExitCode::usage, diagnostics.render());
    }
    return out;
}

Result<scan::ScanOptions> options_of(IdsScanArguments const& a) {
    scan::ScanOptions out;
    out.file = a.capture;
    out.streams = a.streams;
    out.only = a.only;
    out.check_clock = a.check_clock;
    out.forecast.nominal_peak_a = a.nominal_peak_a;
    out.forecast.into_line = a.into_line;
    auto described = read_described(a);
    if (!described) {
        return std::unexpected{described.error()};
    }
    std::vector<std::string> const currents = a.currents.empty() ? std::vector<std::string>{} : split(a.currents, ',');
    if (!currents.empty() && currents.size() != 3) {
        return fail(ExitCode::usage, fmt::format("--currents '{}' names {} members", a.currents, currents.size()),
                    "expected three, as Ia,Ib,Ic");
    }
    out.known = scan::KnownStreams{std::move(*described), currents};
    for (std::string const& line : a.lines) {
        auto const ends = split(line, ',');
        if (ends.size() != 2 || ends[0].empty() || ends[1].empty() || ends[0] == ends[1]) {
            return fail(ExitCode::usage, fmt::format("--line '{}' does not name two streams", line),
                        "expected FROM,TO, as SMV21,SMV22");
        }
        out.lines.push_back({ends[0], ends[1]});
    }
    if (a.rules_only) {
        return a.lines.empty() ? Result<scan::ScanOptions>{std::move(out)}
                               : fail(ExitCode::usage, "--rules-only says nothing about a line",
                                      "leave out one of --rules-only and --line");
    }
    auto model =
        ids::load_model(a.model.empty() ? launcher::shared_folder("configs") / "models" / "ar_20.json" : a.model);
    if (!model) {
        return std::unexpected{model.error()};
    }
    out.forecast.model = std::move(*model);
    return out;
}

Result<void> write_folder(scan::CaptureScan const& found, IdsScanArguments const& a) {
    std::error_code error;
    std::filesystem::create_directories(a.out, error);
    if (error) {
        return fail(ExitCode::environment, fmt::format("cannot make '{}': {}", a.out.string(), error.message()));
    }
    for (auto const& [name, text] :
         {std::pair{"scan.json", to_json(found, a.capture)}, std::pair{"index.html", to_page(found, a.capture)}}) {
        if (auto ok = launcher::replace_file(a.out / name, text); !ok) {
            return ok;
        }
    }
    return {};
}

/// A capture of a run lies next to the scenario that describes its streams. It is named, not read: the folder may be
/// somebody else's.
void hint_at_streams(IdsScanArguments const& a, scan::CaptureScan const& found) {
    auto const beside = a.capture.parent_path() / "scenario.resolved.yaml";
    std::error_code error;
    bool const unknown = std::ranges::any_of(found.streams, [](auto const& s) { return !s.goose && !s.readable; });
    if (unknown && a.streams_file.empty() && a.scl_file.empty() && std::filesystem::exists(beside, error)) {
        fmt::print("\n--streams {} describes the data sets of this run\n", beside.string());
    }
}

int ids_scan(IdsScanArguments const& a) {
    auto const options = options_of(a);
    if (!options) {
        return print_error(options.error());
    }
    auto const found = scan::scan_capture(*options);
    if (!found) {
        return print_error(found.error());
    }
    if (!a.out.empty()) {
        if (auto ok = write_folder(*found, a); !ok) {
            return print_error(ok.error());
        }
    }
    fmt::print("{}", a.json ? to_json(*found, a.capture) : to_text(*found, a.capture));
    if (!a.json) {
        hint_at_streams(a, *found);
    }
    if (!a.out.empty() && !a.json) {
        fmt::print("\nwritten: {}\n", (a.out / "index.html").string());
    }
    return static_cast<int>(found->has_alarms() ? ExitCode::expectation_failed : ExitCode::ok);
}

} // namespace

void add_ids_scan(Command ids, Action& action) {
    auto const a = std::make_shared<IdsScanArguments>();
    Command verb = ids.add_subcommand(
        "scan", "the detector and the protocol rules on a capture (pcapng, pcap): alarms by stream and rule");
    verb.add_option("CAPTURE", a->capture, "pcapng or pcap; it is read twice").required();
    verb.add_option("--stream", a->streams,
                    "only this stream, by its name in --streams or on the wire; may be repeated")
        .repeated();
    verb.add_option("--only", a->only, "only this interface of the capture, or this link of a run");
    verb.add_option("--streams", a->streams_file,
                    "scenario, or a file with `streams:`, that describes data sets (default: 9-2LE)");
    verb.add_option("--scl", a->scl_file, "SCD, ICD or CID file that describes them");
    verb.add_option("--line", a->lines,
                    "FROM,TO: two streams that are the ends of a line; one relay with our detector watches both; may "
                    "be repeated")
        .repeated();
    verb.add_flag("--into-line", a->into_line,
                  "current transformers of --line count into the line (default: along it)");
    verb.add_option("--currents", a->currents,
                    "members with the phase currents (default: Ia,Ib,Ic, or the first three numbers)");
    verb.add_option("--model", a->model, "forecaster (default: the shipped ar_20.json)");
    verb.add_option("--nominal-peak-a", a->nominal_peak_a,
                    "crest of the nominal current (default: the largest of the first two cycles)")
        .check(positive());
    verb.add_flag("--rules-only", a->rules_only, "no forecaster: only the rules on headers and counters");
    verb.add_flag("--check-clock", a->check_clock,
                  "GOOSE: the time of a new state must be within 2 s of the capture's");
    verb.add_option("--out", a->out, "folder for index.html and scan.json");
    verb.add_flag("--json", a->json, "as JSON");
    verb.callback([a, &action] { action = [a] { return ids_scan(*a); }; });
}

} // namespace gridspace::cli
