// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace scl export`: streams as a file of substation engineering.
#include "common/config/merge.hpp"
#include "common/text.hpp"
#include "gateways/scl/scl_export.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/scl_import_verb.hpp"
#include "launcher/cli/verbs.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>

namespace gridspace::cli {
namespace {

struct Arguments {
    std::filesystem::path file, out;
    std::vector<std::string> streams; ///< to export; empty: all
};

int write(std::string const& text, std::filesystem::path const& out) {
    if (out.empty()) {
        fmt::print("{}", text);
        return 0;
    }
    std::ofstream stream{out};
    stream << text << std::flush;
    return stream.good() ? 0 : print_error({ExitCode::environment, fmt::format("cannot write '{}'", out.string()), ""});
}

/// The streams that --stream names, or all; prints the mistake and returns nothing when one does not exist.
std::optional<std::vector<streams::Stream>> chosen(std::vector<streams::Stream> const& all, Arguments const& a) {
    std::vector<std::string> names;
    for (streams::Stream const& s : all) {
        names.push_back(s.name.name);
    }
    for (std::string const& name : a.streams) {
        if (streams::find_stream(all, name) == nullptr) {
            print_error({ExitCode::usage, fmt::format("there is no stream '{}' in '{}'", name, a.file.string()),
                         spelling_hint(name, names)});
            return std::nullopt;
        }
    }
    std::vector<streams::Stream> out;
    std::copy_if(all.begin(), all.end(), std::back_inserter(out), [&](streams::Stream const& s) {
        return a.streams.empty() || std::find(a.streams.begin(), a.streams.end(), s.name.name) != a.streams.end();
    });
    return out;
}

/// Each refused stream at its line, and how to write the others.
int print_refused(std::vector<scl::Refusal> const& refused, std::vector<streams::Stream> const& streams) {
    config::Diagnostics diagnostics;
    std::string others;
    for (scl::Refusal const& one : refused) {
        diagnostics.error(one.stream.where, fmt::format("stream '{}': {}", one.stream.name, one.why.message),
                          one.why.remedy, static_cast<int>(one.stream.name.size()));
    }
    for (streams::Stream const& s : streams) {
        bool const is_refused =
            std::any_of(refused.begin(), refused.end(), [&](scl::Refusal const& one) { return one.stream == s.name; });
        others += is_refused ? "" : fmt::format(" --stream {}", s.name.name);
    }
    fmt::print(stderr, "{}\n", diagnostics.render());
    return print_error(
        {ExitCode::usage,
         fmt::format("{} of {} streams cannot be written as SCL; nothing was written", refused.size(), streams.size()),
         others.empty() ? "" : "to write the others only:" + others});
}

int export_scl(Arguments const& a) {
    config::Diagnostics diagnostics;
    std::vector<streams::Stream> all;
    if (auto root = config::load_extended(a.file, diagnostics)) {
        if (config::Node* const node = root->find("streams")) {
            config::resolve_likes(*node, diagnostics);
            all = streams::read_streams(*node, diagnostics);
        }
    }
    if (diagnostics.errors() + diagnostics.warnings() > 0) {
        fmt::print(stderr, "{}\n", diagnostics.render());
    }
    if (!diagnostics.ok()) {
        return static_cast<int>(ExitCode::usage);
    }
    if (all.empty()) {
        return print_error({ExitCode::usage, fmt::format("'{}' has no `streams:`", a.file.string()),
                            "expected a scenario with GOOSE or SMV streams (docs/reference/streams.md)"});
    }
    auto const streams = chosen(all, a);
    if (!streams) {
        return static_cast<int>(ExitCode::usage);
    }
    auto const exported = scl::export_streams(*streams, a.file.stem().string());
    return exported.refused.empty() ? write(exported.text, a.out) : print_refused(exported.refused, *streams);
}

} // namespace

void add_scl(Command app, Action& action) {
    Command verb = app.add_subcommand("scl", "streams from and to SCL files (IEC 61850-6)");
    verb.require_subcommand();
    auto const a = std::make_shared<Arguments>();
    add_scl_import(verb, action);
    Command exported = verb.add_subcommand("export", "write the streams of a scenario as a CID file");
    exported.add_option("SCENARIO", a->file, "scenario, or a file with `streams:`").required();
    exported.add_option("--stream", a->streams, "only this stream; may be given several times").repeated();
    exported.add_option("--out", a->out, "file (default: standard output)");
    exported.callback([&action, a] { action = [a] { return export_scl(*a); }; });
}

} // namespace gridspace::cli
