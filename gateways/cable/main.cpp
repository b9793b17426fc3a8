// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Carries the Ethernet frames of a scenario's host to a board over ssh, and starts the board's program: both ends of
// it. Started by scripts/board/start_ssh.sh and, on the board, over ssh. It is linked statically: a board needs nothing
// to run it.
#include "common/version.hpp"
#include "gateways/cable/ends.hpp"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <span>

namespace {

constexpr std::string_view kSeparator = "---"; // ssh's own words have a "--"

constexpr char const* kUsage =
    "the cable of `run_on: ssh:HOST`: carries Ethernet frames over ssh; started by `gridspace run`\n"
    "Usage: gridspace-cable far BUNDLE | check\n"
    "       gridspace-cable near --place HOST --patience SECONDS --files FOLDER [--outer FILE]\n"
    "                            [--port NAME,MAC,ADDRESS:TAP]... --- SSH ARGUMENT... --- PROGRAM ARGUMENT...\n";

int usage() {
    std::fputs(kUsage, stderr);
    return static_cast<int>(gridspace::ExitCode::usage);
}

int near(std::span<char*> words) {
    gridspace::cable::NearEnd options;
    std::size_t i = 0;
    for (; i + 1 < words.size() && std::string_view{words[i]} != kSeparator; i += 2) {
        std::string_view const name = words[i];
        std::string const value = words[i + 1];
        if (name == "--place") {
            options.place = value;
        } else if (name == "--patience") {
            auto const [end, error] = std::from_chars(value.data(), value.data() + value.size(), options.patience_s);
            if (error != std::errc{} || end != value.data() + value.size()) {
                return usage();
            }
        } else if (name == "--files") {
            options.folder = value;
        } else if (name == "--outer") {
            options.outer_network = value;
        } else if (name == "--port") {
            options.ports.push_back(value);
        } else {
            return usage();
        }
    }
    std::vector<std::string>* list = nullptr;
    for (; i < words.size(); ++i) {
        if (std::string_view{words[i]} == kSeparator && list != &options.program) {
            list = list == nullptr ? &options.ssh : &options.program;
        } else if (list != nullptr) {
            list->emplace_back(words[i]);
        }
    }
    return options.ssh.empty() || options.program.empty() ? usage() : gridspace::cable::near_end(options);
}

} // namespace

int main(int argc, char** argv) {
    std::span<char*> const words{argv + 1, static_cast<std::size_t>(argc > 0 ? argc - 1 : 0)};
    std::string_view const verb = words.empty() ? "" : words.front();
    if (verb == "far" && words.size() == 2) {
        return gridspace::cable::far_end(words[1]);
    }
    if (verb == "check") {
        return gridspace::cable::check_far_end();
    }
    if (verb == "near") {
        return near(words.subspan(1));
    }
    if (verb == "--version") {
        std::puts(gridspace::version_text("gridspace-cable").c_str());
        return 0;
    }
    if (verb == "--help" || verb == "-h") {
        std::fputs(kUsage, stdout);
        return 0;
    }
    return usage();
}
