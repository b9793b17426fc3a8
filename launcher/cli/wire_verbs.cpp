// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace wire ...`: frames of IEC 61850 for people at the bench.
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/wire/capture_statistics.hpp"
#include "launcher/wire/tools.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace gridspace::cli {
namespace {

Check seconds() {
    return number(0, "a number of seconds (0 to 1e9)");
}
Check finite() {
    return number(-1e9, "a number (-1e9 to 1e9)");
}
Check count() {
    return Check{[](std::string const& text) {
        bool const ok = !text.empty() && text.size() <= 18 &&
                        std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
        return ok ? std::string{} : fmt::format("'{}' is not a whole number from 0 on", text);
    }};
}

int finish(Result<void> const& result) {
    return result ? 0 : print_error(result.error());
}

void stream_options(Command verb, wire::StreamArgument& stream) {
    verb.add_option("--file", stream.file, "scenario, or a file with `streams:`");
    verb.add_option("--stream", stream.name, "name of the stream in that file").needs("--file");
    verb.add_option("KEY=VALUE", stream.keys,
                    "keys of `streams:` (docs/reference/streams.md): app_id=0x4021 sv_id=MU01 data_set=9-2LE");
    verb.require([](Command const& given) {
        return given.has("--file") && !given.has("--stream") ? "--stream NAME, with --file," : "";
    });
}

/// A verb with its options, kept alive as long as the command line is.
template <class Options>
std::pair<Command, std::shared_ptr<Options>> verb_of(Command wire, std::function<int()>& action, char const* name,
                                                     char const* description, Result<void> (*run)(Options const&)) {
    Command verb = wire.add_subcommand(name, description);
    auto const options = std::make_shared<Options>();
    verb.final_callback([&action, options, run] { action = [options, run] { return finish(run(*options)); }; });
    return {verb, options};
}

void add_list(Command wire, Action& action) {
    auto const [verb, o] =
        verb_of<wire::ListOptions>(wire, action, "list", "live table of the streams on an interface", wire::list);
    verb.add_option("IF", o->interface, "interface").required();
    verb.add_option("--duration", o->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    verb.add_flag("--json", o->json, "JSON lines");
    verb.add_flag("--once", o->once, "one table, at the end");
}

void add_sv_publish(Command wire, Action& action) {
    auto const [verb, o] = verb_of<wire::SvPublishOptions>(
        wire, action, "sv-pub", "publish sampled values: balanced sinusoids", wire::sv_publish);
    verb.add_option("IF", o->interface, "interface").required();
    stream_options(verb, o->stream);
    verb.add_option("--source", o->source, "source address (default: the interface's)");
    verb.add_option("--duration", o->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    verb.add_option("--amplitude", o->amplitude, "in the units of the data set").check(finite());
    verb.add_option("--frequency", o->frequency_hz, "Hz").check(finite());
    verb.add_option("--streams", o->streams, "publish so many: APPID, address and svID count up")
        .check(in_range(1, 64));
    verb.add_option("--first-smp-cnt", o->first_smp_cnt, "begin with this counter (default: by the time of day)")
        .check(in_range(0, 65535));
}

void add_sv_subscribe(Command wire, Action& action) {
    auto const [verb, o] = verb_of<wire::SvSubscribeOptions>(wire, action, "sv-sub",
                                                             "watch sampled values, as JSON lines", wire::sv_subscribe);
    verb.add_option("IF", o->interface, "interface").required();
    stream_options(verb, o->stream);
    verb.add_option("--duration", o->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    verb.add_option("--count", o->count, "end after so many frames").check(count());
    verb.add_flag("--frames", o->frames, "a line per sample instead of one per second");
}

void add_goose_publish(Command wire, Action& action) {
    auto const [verb, o] =
        verb_of<wire::GoosePublishOptions>(wire, action, "goose-pub", "publish GOOSE", wire::goose_publish);
    verb.add_option("IF", o->interface, "interface").required();
    stream_options(verb, o->stream);
    verb.add_option("--source", o->source, "source address (default: the interface's)");
    verb.add_option("--value", o->values, "NAME=VALUE of a member, at the start (may be repeated)").repeated();
    verb.add_option("--duration", o->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    verb.add_option("--toggle", o->toggle_s, "change the first boolean every so many seconds").check(seconds());
    verb.add_option("--first-st-num", o->first_st_num, "stNum of the first message");
    verb.add_flag("--nds-com", o->nds_com, "say that the control block needs commissioning");
    verb.add_flag("--interactive", o->interactive, "change members by NAME=VALUE lines on standard input");
}

void add_goose_subscribe(Command wire, Action& action) {
    auto const [verb, o] = verb_of<wire::GooseSubscribeOptions>(
        wire, action, "goose-sub", "watch GOOSE messages, as JSON lines", wire::goose_subscribe);
    verb.add_option("IF", o->interface, "interface").required();
    stream_options(verb, o->stream);
    verb.add_option("--duration", o->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    verb.add_option("--count", o->count, "end after so many lines").check(count());
    verb.add_flag("--strict", o->strict, "refuse replayed states");
}

void add_replay(Command wire, Action& action) {
    auto const [verb, o] = verb_of<wire::ReplayOptions>(wire, action, "replay",
                                                        "send the frames of a capture with their timing", wire::replay);
    verb.add_option("FILE", o->file, "pcapng or pcap").required();
    verb.add_option("IF", o->interface, "interface: a virtual cable").required();
    verb.add_option("--speed", o->speed, "times the original; 0: as fast as possible")
        .check(number(0, "a speed (0 to 1e9)"));
    verb.add_option("--loop", o->loops, "so many times; 0: for ever").check(in_range(0, 1'000'000'000));
    verb.add_option("--only", o->only, "only the frames of this interface of the capture");
    verb.add_flag("--all", o->all_protocols, "other protocols too");
    verb.add_option("--allow-attacks-on", o->allow_attacks_on, "an interface that is not a virtual cable");
}

void add_statistics(Command wire, Action& action) {
    Command verb = wire.add_subcommand("stats", "rates, gaps, retransmission curves and delays of a capture");
    struct Stats {
        std::filesystem::path file;
        bool json{false};
    };
    auto const s = std::make_shared<Stats>();
    verb.add_option("FILE", s->file, "pcapng or pcap").required();
    verb.add_flag("--json", s->json, "as JSON");
    verb.final_callback([&action, s] {
        action = [s] {
            auto const statistics = wire::capture_statistics(s->file);
            if (!statistics) {
                return print_error(statistics.error());
            }
            fmt::print("{}", s->json ? to_json(*statistics) : to_text(*statistics));
            return 0;
        };
    });
}

} // namespace

void add_wire(Command app, Action& action) {
    Command wire = app.add_subcommand("wire", "send, receive, list, replay and judge GOOSE and sampled-value frames");
    wire.require_subcommand();
    add_list(wire, action);
    add_sv_publish(wire, action);
    add_sv_subscribe(wire, action);
    add_goose_publish(wire, action);
    add_goose_subscribe(wire, action);
    add_replay(wire, action);
    add_statistics(wire, action);
}

} // namespace gridspace::cli
