// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/play/play_options.hpp"

#include "common/text.hpp"

namespace gridspace::play {

void add_options(command_line::Command app, PlayOptions& o) {
    app.add_option("RUN", o.run, "run folder, its data.mcap, or latest").required();
    app.add_option("--rate", o.rate, "recorded seconds per second; 0: as fast as readers take it")
        .check(command_line::in_range(0.0, 1e6))
        .group("What is played");
    app.add_option("--start", o.start, "begin at this simulated time (10s, 5min, 2h)").group("What is played");
    app.add_option("--until", o.until, "end at this simulated time").group("What is played");
    app.add_option("--topics", o.topics, "only these (patterns)").delimiter(',').group("What is played");
    app.add_option("--loop", o.loops, "so many times; 0: for ever")
        .check(command_line::in_range(0, 1'000'000'000))
        .group("What is played");
    app.add_option("--domain", o.domain, "DDS domain").check(command_line::in_range(0, 232)).group("Where");
    app.add_option("--data-domain", o.data_domain,
                   "another DDS domain for the topics that are studied; those of the framework stay")
        .check(command_line::in_range(0, 232))
        .group("Where");
    app.add_option("--address", o.addresses, "IPv4 addresses of the interfaces to use (default: all)")
        .delimiter(',')
        .group("Where");
    app.add_flag("--wait", o.wait, "begin when every topic has a reader").group("Where");
    app.add_flag("--json", o.json, "what was played, as JSON");
    app.add_option("--frames", o.frames, "send the recorded frames on this interface, too").group("Frames");
    app.add_option("--only", o.only, "of the frames those of this point of the capture")
        .needs("--frames")
        .group("Frames");
    app.add_option("--allow-attacks-on", o.allow_attacks_on, "an interface that is not a virtual cable")
        .needs("--frames")
        .group("Frames");
    app.add_flag("--no-samples", o.no_samples, "frames alone").needs("--frames").group("Frames");
}

std::vector<std::string> to_words(PlayOptions const& o) {
    std::vector<std::string> words{o.run.string(),          "--rate",   shortest(o.rate),        "--loop",
                                   std::to_string(o.loops), "--domain", std::to_string(o.domain)};
    auto const add = [&](char const* name, std::string const& value) {
        if (!value.empty()) {
            words.emplace_back(name);
            words.push_back(value);
        }
    };
    add("--start", o.start);
    add("--until", o.until);
    add("--topics", join(o.topics, ","));
    add("--data-domain", o.data_domain < 0 ? "" : std::to_string(o.data_domain));
    add("--address", join(o.addresses, ","));
    add("--frames", o.frames);
    add("--only", o.only);
    add("--allow-attacks-on", o.allow_attacks_on);
    for (auto const& [flag, name] : {std::pair{o.wait, "--wait"}, {o.json, "--json"}, {o.no_samples, "--no-samples"}}) {
        if (flag) {
            words.emplace_back(name);
        }
    }
    return words;
}

} // namespace gridspace::play
