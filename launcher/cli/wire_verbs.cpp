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

} // namespace

void add_wire(Command app, Action& action) {
    Command wire = app.add_subcommand("wire", "send, receive, list, replay and judge GOOSE and sampled-value frames");
    wire.require_subcommand();

    auto const [list, l] =
        verb_of<wire::ListOptions>(wire, action, "list", "live table of the streams on an interface", wire::list);
    list.add_option("IF", l->interface, "interface").required();
    list.add_option("--duration", l->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    list.add_flag("--json", l->json, "JSON lines");
    list.add_flag("--once", l->once, "one table, at the end");

    auto const [sv_pub, sp] = verb_of<wire::SvPublishOptions>(
        wire, action, "sv-pub", "publish sampled values: balanced sinusoids", wire::sv_publish);
    sv_pub.add_option("IF", sp->interface, "interface").required();
    stream_options(sv_pub, sp->stream);
    sv_pub.add_option("--source", sp->source, "source address (default: the interface's)");
    sv_pub.add_option("--duration", sp->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    sv_pub.add_option("--amplitude", sp->amplitude, "in the units of the data set").check(finite());
    sv_pub.add_option("--frequency", sp->frequency_hz, "Hz").check(finite());
    sv_pub.add_option("--streams", sp->streams, "publish so many: APPID, address and svID count up")
        .check(in_range(1, 64));
    sv_pub.add_option("--first-smp-cnt", sp->first_smp_cnt, "begin with this counter (default: by the time of day)")
        .check(in_range(0, 65535));

    auto const [sv_sub, ss] = verb_of<wire::SvSubscribeOptions>(
        wire, action, "sv-sub", "watch sampled values, as JSON lines", wire::sv_subscribe);
    sv_sub.add_option("IF", ss->interface, "interface").required();
    stream_options(sv_sub, ss->stream);
    sv_sub.add_option("--duration", ss->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    sv_sub.add_option("--count", ss->count, "end after so many frames").check(count());
    sv_sub.add_flag("--frames", ss->frames, "a line per sample instead of one per second");

    auto const [goose_pub, gp] =
        verb_of<wire::GoosePublishOptions>(wire, action, "goose-pub", "publish GOOSE", wire::goose_publish);
    goose_pub.add_option("IF", gp->interface, "interface").required();
    stream_options(goose_pub, gp->stream);
    goose_pub.add_option("--source", gp->source, "source address (default: the interface's)");
    goose_pub.add_option("--value", gp->values, "NAME=VALUE of a member, at the start (may be repeated)").repeated();
    goose_pub.add_option("--duration", gp->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    goose_pub.add_option("--toggle", gp->toggle_s, "change the first boolean every so many seconds").check(seconds());
    goose_pub.add_option("--first-st-num", gp->first_st_num, "stNum of the first message");
    goose_pub.add_flag("--nds-com", gp->nds_com, "say that the control block needs commissioning");
    goose_pub.add_flag("--interactive", gp->interactive, "change members by NAME=VALUE lines on standard input");

    auto const [goose_sub, gs] = verb_of<wire::GooseSubscribeOptions>(
        wire, action, "goose-sub", "watch GOOSE messages, as JSON lines", wire::goose_subscribe);
    goose_sub.add_option("IF", gs->interface, "interface").required();
    stream_options(goose_sub, gs->stream);
    goose_sub.add_option("--duration", gs->duration_s, "seconds; 0: until Ctrl-C").check(seconds());
    goose_sub.add_option("--count", gs->count, "end after so many lines").check(count());
    goose_sub.add_flag("--strict", gs->strict, "refuse replayed states");

    auto const [replay, r] = verb_of<wire::ReplayOptions>(
        wire, action, "replay", "send the frames of a capture with their timing", wire::replay);
    replay.add_option("FILE", r->file, "pcapng or pcap").required();
    replay.add_option("IF", r->interface, "interface: a virtual cable").required();
    replay.add_option("--speed", r->speed, "times the original; 0: as fast as possible")
        .check(number(0, "a speed (0 to 1e9)"));
    replay.add_option("--loop", r->loops, "so many times; 0: for ever").check(in_range(0, 1'000'000'000));
    replay.add_option("--only", r->only, "only the frames of this interface of the capture");
    replay.add_flag("--all", r->all_protocols, "other protocols too");
    replay.add_option("--allow-attacks-on", r->allow_attacks_on, "an interface that is not a virtual cable");

    Command stats = wire.add_subcommand("stats", "rates, gaps, retransmission curves and delays of a capture");
    struct Stats {
        std::filesystem::path file;
        bool json{false};
    };
    auto const s = std::make_shared<Stats>();
    stats.add_option("FILE", s->file, "pcapng or pcap").required();
    stats.add_flag("--json", s->json, "as JSON");
    stats.final_callback([&action, s] {
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

} // namespace gridspace::cli
