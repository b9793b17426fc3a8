// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/attack_config.hpp"

#include "ids/data/recording_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::attacker {
namespace {

using Kind = SampleAttackParams::Kind;

void describe_clock(config::Fields& c, SampleAttackParams& s) {
    double offset_us = 0, drift_us_per_s = 0;
    c.number("offset_us", offset_us, {.doc = "at the start of the window", .min = 0});
    c.number("drift_us_per_s", drift_us_per_s, {.doc = "more of it, from then on"});
    s.offset_s = offset_us * 1e-6;
    s.drift = drift_us_per_s * 1e-6;
    if (offset_us == 0 && drift_us_per_s == 0) {
        c.error("", "it does not say how far the clock is off", "e.g. clock: {offset_us: 200}");
    }
}

void describe_recording(config::Fields& r, AttackConfig& a) {
    enum class End : std::uint8_t { from, to } end{End::from};
    r.file("file", a.recording,
           {.doc = "CSV (time, 3 or 6 currents) or npy, at the rate of the stream", .required = true});
    r.number("rate_hz", a.recording_rate_hz, {.doc = "npy: its rate", .above = 0});
    r.choice<End>("end", end, {{"from", End::from}, {"to", End::to}}, {.doc = "of 6 currents, which three"});
    a.recording_of_to = end == End::to;
}

void describe_masquerade(config::Fields& m, SampleAttackParams& s) {
    m.number("peak_a", s.peak_a, {.doc = "crest of its current", .required = true});
    m.number("angle_deg", s.angle_deg, {.doc = "at its start, phase a"});
    m.number("tau_s", s.tau_s, {.doc = "time constant of the offset", .above = 0});
}

/// `value:` says by its key what happens to the samples.
void describe_value(config::Fields& v, AttackConfig& a) {
    SampleAttackParams& s = a.samples;
    int kinds = 0;
    auto const is = [&](std::string_view key, Kind kind) {
        if (v.has(key)) {
            s.kind = kind;
            ++kinds;
        }
    };
    std::vector<double> uniform;
    bool freeze = false;
    v.numbers("uniform_a", uniform, {.doc = "random: each sample from this range"});
    v.number("min_error_a", s.min_error_a, {.doc = "random: how far from the truth at least", .min = 0});
    v.number("bias_a", s.bias_a, {.doc = "added"});
    v.number("factor", s.factor, {.doc = "multiplied"});
    v.number("ramp_per_cycle", s.ramp_per_cycle, {.doc = "multiplied by 1 + this a cycle"});
    v.fraction("replay_s", a.replay_s, {.doc = "samples of so long ago", .above = 0});
    v.flag("freeze", freeze, {.doc = "the last true sample again and again"});
    is("uniform_a", Kind::random);
    is("bias_a", Kind::bias);
    is("factor", Kind::scale);
    is("ramp_per_cycle", Kind::ramp);
    is("replay_s", Kind::replay);
    is("freeze", Kind::freeze);
    if (v.object("clock", {.doc = "the clock of the merging unit runs behind, and says that it does not"},
                 [&](config::Fields& c) { describe_clock(c, s); })) {
        is("clock", Kind::clock);
    }
    if (v.object("recording", {.doc = "currents that were recorded elsewhere, again and again"},
                 [&](config::Fields& r) { describe_recording(r, a); })) {
        is("recording", Kind::recording);
    }
    if (v.object("masquerade", {.doc = "a fault that is not there"},
                 [&](config::Fields& m) { describe_masquerade(m, s); })) {
        is("masquerade", Kind::masquerade);
    }
    if (v.has("uniform_a")) {
        if (uniform.size() != 2 || !(uniform[0] < uniform[1])) {
            v.error("uniform_a", "two numbers expected, the smaller first", "e.g. uniform_a: [-20, 20]");
        } else {
            s.low_a = uniform[0];
            s.high_a = uniform[1];
        }
    }
    if (kinds != 1) {
        v.error("", kinds == 0 ? "it does not say what happens to the samples" : "it says more than one thing",
                "one of uniform_a, bias_a, factor, ramp_per_cycle, replay_s, freeze, masquerade, clock, recording");
    }
}

using GooseKind = GooseAttackParams::Kind;
const std::initializer_list<std::pair<std::string_view, GooseKind>> kGooseKinds{
    {"random_replay", GooseKind::random_replay},
    {"inverse_replay", GooseKind::inverse_replay},
    {"masquerade_trip", GooseKind::masquerade_trip},
    {"masquerade_normal", GooseKind::masquerade_normal},
    {"injection", GooseKind::injection},
    {"high_st_num", GooseKind::high_st_num},
    {"flooding", GooseKind::flooding},
    {"grayhole", GooseKind::grayhole},
    {"simulation", GooseKind::simulation},
    {"stretch", GooseKind::stretch}};

void describe_goose(config::Fields& g, GooseAttackParams& p) {
    g.choice<GooseKind>("kind", p.kind, kGooseKinds, {.doc = "what is sent, or dropped", .required = true});
    g.number("interval_ms", p.interval_ms, {.doc = "between forged messages", .above = 0});
    g.number("drop_percent", p.drop_percent,
             {.doc = "grayhole: share of messages that are dropped", .min = 0, .max = 100});
    std::int64_t jump = p.jump;
    g.integer("jump", jump, {.doc = "high_st_num: added to the state number", .min = 2, .max = 4'000'000'000});
    p.jump = static_cast<std::uint32_t>(jump);
}

using FrameKind = FrameAttackParams::Kind;
const std::initializer_list<std::pair<std::string_view, FrameKind>> kFrameKinds{
    {"counter_jump", FrameKind::counter_jump},
    {"delay", FrameKind::delay},
    {"drop", FrameKind::drop},
    {"flood", FrameKind::flood},
    {"synch", FrameKind::synch}};

void describe_frames(config::Fields& g, FrameAttackParams& p) {
    g.choice<FrameKind>("kind", p.kind, kFrameKinds, {.doc = "what becomes of them", .required = true});
    g.integer("jump", p.jump, {.doc = "counter_jump: samples added to smpCnt"});
    g.number("delay_us", p.delay_us, {.doc = "delay: how much later they go on, in order", .min = 0, .max = 1e7});
    g.number("drop_percent", p.drop_percent, {.doc = "drop: share of the frames", .max = 100, .above = 0});
    g.integer("burst", p.burst, {.doc = "drop: so many in a row", .min = 1, .max = 1'000'000});
    g.number("interval_us", p.interval_us, {.doc = "flood: between copies of the newest frame", .min = 1});
    g.integer("smp_synch", p.smp_synch, {.doc = "synch: what smpSynch says", .min = 0, .max = 255});
    auto const needs = [&](FrameKind kind, std::string_view key) {
        if (p.kind == kind && !g.has(key)) {
            g.error(key, "this kind needs it");
        }
    };
    needs(FrameKind::counter_jump, "jump");
    needs(FrameKind::delay, "delay_us");
    needs(FrameKind::synch, "smp_synch");
}

void describe_condition(config::Fields& c, AttackConfig::Condition& condition) {
    double above_a = 0;
    bool said = false;
    std::vector<config::Ref> channels;
    c.number("above_a", above_a, {.doc = "sampled values: the magnitude of a current", .min = 0});
    c.flag("said", said, {.doc = "GOOSE: what the real publisher says of a Boolean"});
    c.reference("stream", condition.stream,
                {.doc = "another stream that passes the attacker; the target when left out"});
    c.references("channels", channels, {.doc = "members of that stream: any of the currents, or the Boolean"});
    for (config::Ref const& channel : channels) {
        condition.channels.push_back(channel.name);
    }
    if (c.has("said") == c.has("above_a")) {
        c.error("", "one condition expected", "above_a: 30, or said: true");
    } else if (c.has("said")) {
        condition.said = said;
    } else {
        condition.above_a = above_a;
    }
    if (condition.stream.empty() && !channels.empty()) {
        c.error("channels", "those of the target are in `target`", "leave it out, or name a stream");
    } else if (condition.said && channels.size() > 1) {
        c.error("channels", "one Boolean expected");
    }
}

void describe_window(config::Fields& w, AttackConfig& a) {
    w.fraction("from_s", a.from_s, {.doc = "simulated time of its start", .required = true, .min = 0});
    w.fraction("until_s", a.until_s, {.doc = "and of its end", .required = true, .above = 0});
    if (w.has("from_s") && w.has("until_s") && a.until_s <= a.from_s) {
        w.error("until_s", "it must be after from_s");
    }
    w.object("repeat", {.doc = "the window again"}, [&](config::Fields& r) {
        r.fraction("every_s", a.every_s, {.doc = "from one start to the next", .required = true, .above = 0});
        r.integer("times", a.times, {.doc = "how many windows in all", .required = true, .min = 2, .max = 100'000});
        if (r.has("every_s") && a.every_s < a.until_s - a.from_s) {
            r.error("every_s", "the windows overlap", "at least until_s - from_s");
        }
    });
    w.fraction("ramp_s", a.ramp_s, {.doc = "values and delays: from nothing to the full attack", .above = 0});
    AttackConfig::Condition when;
    if (w.object("when", {.doc = "it begins in the window when the attacker sees this"},
                 [&](config::Fields& c) { describe_condition(c, when); }) &&
        (when.above_a || when.said)) {
        a.when = std::move(when);
    }
}

void describe_place(config::Fields& p, AttackConfig& a) {
    p.references("between", a.between, {.doc = "man in the middle: a host and one of its links"});
    bool second = false;
    p.flag("second_publisher", second, {.doc = "true: sends beside the real publisher"});
    p.flag("spoof_source", a.spoof, {.doc = "second publisher: take the source address of the real one"});
    a.place = p.has("between") ? AttackConfig::Place::between : AttackConfig::Place::second_publisher;
    if (p.has("between") == second) {
        p.error("", "one place expected", "between: [HOST, LINK], or second_publisher: true");
    } else if (p.has("between") && a.between.size() != 2) {
        p.error("between", "a host and a link expected");
    }
}

void describe_target(config::Fields& t, AttackConfig& a) {
    std::vector<config::Ref> channels;
    t.reference("stream", a.stream, {.doc = "SMV or GOOSE stream"});
    t.reference("topic", a.topic, {.doc = "DDS topic"});
    t.references("channels", channels, {.doc = "members of the data set; all when left out"});
    for (config::Ref const& c : channels) {
        a.channels.push_back(c.name);
    }
    if (a.stream.empty() == a.topic.empty()) {
        t.error("", "a stream or a topic expected");
    }
}

void describe_spacing(config::Fields& f, AttackConfig& a) {
    using Spacing = SampleAttackParams::Spacing;
    f.choice<Spacing>("spacing", a.samples.spacing, {{"every", Spacing::every}, {"random", Spacing::random}},
                      {.doc = "every sample, or count single ones"});
    f.integer("count", a.samples.count, {.doc = "random: how many", .min = 1});
    f.integer("min_gap", a.samples.min_gap, {.doc = "random: samples from one to the next at least", .min = 1});
    if (a.samples.spacing == Spacing::random && !f.has("count")) {
        f.error("count", "random spacing needs it");
    }
}

/// What the window says goes with what is done in it.
void check_window(config::Fields& f, AttackConfig& a) {
    bool const of_target = a.when && a.when->stream.empty();
    if (a.frames && f.has("samples")) {
        f.error("samples", "an attack on frames acts on all of its window",
                "leave it out; `frames: {kind: drop}` has a share");
    }
    if (a.waits_for_other() && !a.topic.empty()) {
        f.error("window", "an attack on a topic does not hear a stream", "its condition is on the topic itself");
    } else if (of_target && a.when->above_a && a.goose) {
        f.error("window", "messages have no currents", "when: {said: true}");
        a.when.reset(); // nothing else is to be said about it
    } else if (of_target && a.when->said && !a.goose) {
        f.error("window", "samples say nothing that is true or false", "when: {above_a: 30}");
        a.when.reset();
    } else if (f.has("window") && a.ramp_s > Rational{0} &&
               (a.goose || (a.frames && a.frames->kind != FrameKind::delay))) {
        f.error("window", "what it does has no strength that could grow",
                "ramp_s goes with `value`, and with `kind: delay`");
    }
}

void describe_attack(config::Fields& f, AttackConfig& a) {
    f.reference("by", a.by, {.doc = "the attacker process", .required = true});
    f.object("place", {.doc = "where it sits: between a host and a link, or beside the publisher"},
             [&](config::Fields& p) { describe_place(p, a); });
    f.object("target", {.doc = "what is attacked", .required = true},
             [&](config::Fields& t) { describe_target(t, a); });
    f.object("window", {.doc = "when", .required = true}, [&](config::Fields& w) { describe_window(w, a); });
    f.object("samples", {.doc = "which samples of the window; all when left out"},
             [&](config::Fields& s) { describe_spacing(s, a); });
    bool const value =
        f.object("value", {.doc = "attacks on values"}, [&](config::Fields& v) { describe_value(v, a); });
    bool const goose = f.object("message", {.doc = "attacks on GOOSE messages"}, [&](config::Fields& g) {
        a.goose.emplace();
        describe_goose(g, *a.goose);
    });
    bool const frames = f.object("frames", {.doc = "attacks on frames of sampled values"}, [&](config::Fields& g) {
        a.frames.emplace();
        describe_frames(g, *a.frames);
    });
    switch (int{value} + int{goose} + int{frames}) {
    case 0:
        if (!f.has("value") && !f.has("message") && !f.has("frames")) {
            f.error("", "it does not say what is done",
                    "give `value` or `frames` (sampled values), or `message` (GOOSE)");
        }
        return;
    case 1:
        break;
    default:
        f.error(goose ? "message" : "frames", "an attack has one of `value`, `frames` and `message`");
        return;
    }
    if (a.goose && a.when && a.when->stream.empty()) {
        a.goose->said = a.when->said;
    }
    check_window(f, a);
}

} // namespace

std::string_view kind_name(AttackConfig const& config) {
    if (config.goose) {
        return std::find_if(kGooseKinds.begin(), kGooseKinds.end(),
                            [&](auto const& k) { return k.second == config.goose->kind; })
            ->first;
    }
    if (config.frames) {
        return std::find_if(kFrameKinds.begin(), kFrameKinds.end(),
                            [&](auto const& k) { return k.second == config.frames->kind; })
            ->first;
    }
    constexpr std::array<std::string_view, 9> kNames{"random", "bias",       "scale", "ramp",     "replay",
                                                     "freeze", "masquerade", "clock", "recording"};
    return kNames.at(static_cast<std::size_t>(config.samples.kind));
}

void describe_attacks(config::Fields& parent, std::vector<AttackConfig>& attacks) {
    parent.map("attacks", {.doc = "attacks, each labelled sample by sample"},
               [&](config::Ref const& name, config::Fields& f) {
                   AttackConfig a;
                   a.name = name;
                   a.samples.name = name.name;
                   describe_attack(f, a);
                   attacks.push_back(std::move(a));
               });
}

AttackTimes times_in_ns(AttackConfig const& config) {
    auto const ns = [](Rational s) { return std::llround(s.to_double() * 1e9); };
    return {ns(config.from_s), ns(config.until_s), ns(config.every_s),
            config.times,      ns(config.ramp_s),  config.when.has_value()};
}

namespace {

/// The currents of a file, which must have the rate of the stream.
Result<std::vector<Abc>> read_currents(AttackConfig const& config, double rate_hz) {
    ids::RecordingOptions options;
    options.rate_hz = config.recording_rate_hz;
    auto read = ids::read_recording(config.recording, options);
    if (!read) {
        return std::unexpected{read.error()};
    }
    if (std::fabs(read->rate_hz - rate_hz) > 0.01 * rate_hz) {
        return fail(ExitCode::usage, fmt::format("attack '{}': '{}' has {:.6g} samples a second, and the target {:.6g}",
                                                 config.name.name, config.recording.string(), read->rate_hz, rate_hz));
    }
    auto& currents = config.recording_of_to ? read->to : read->from;
    bool const finite = std::all_of(currents.begin(), currents.end(), [](Abc const& i) {
        return std::isfinite(i[0]) && std::isfinite(i[1]) && std::isfinite(i[2]);
    });
    if (!finite) {
        return fail(ExitCode::usage, fmt::format("attack '{}': '{}' has samples that are no numbers", config.name.name,
                                                 config.recording.string()));
    }
    return std::move(currents);
}

} // namespace

Result<SampleAttack> make_sample_attack(AttackConfig const& config, std::vector<std::string> const& phases,
                                        double rate_hz, double frequency_hz, std::uint64_t seed) {
    SampleAttackParams p = config.samples;
    p.rate_hz = rate_hz;
    p.frequency_hz = frequency_hz;
    p.channels = 0;
    for (std::string const& channel : config.channels) {
        auto const at = std::find(phases.begin(), phases.end(), channel);
        if (at == phases.end() || at - phases.begin() >= 3) {
            return fail(ExitCode::usage,
                        fmt::format("attack '{}': the target has no current '{}'", config.name.name, channel));
        }
        p.channels = static_cast<std::uint8_t>(p.channels | (1U << static_cast<unsigned>(at - phases.begin())));
    }
    if (config.channels.empty()) {
        p.channels = 7;
    }
    // Sample n is taken at n / rate: the window holds those with from <= n / rate < until. The margin undoes rounding.
    auto const index = [&](Rational s) { return static_cast<std::int64_t>(std::ceil(s.to_double() * rate_hz - 1e-6)); };
    p.from = index(config.from_s);
    p.until = index(config.until_s);
    p.every = std::llround(config.every_s.to_double() * rate_hz);
    p.times = config.times;
    p.ramp = std::llround(config.ramp_s.to_double() * rate_hz);
    p.above_a = config.when && !config.waits_for_other() ? config.when->above_a : std::nullopt;
    p.waits = config.waits_for_other();
    if (p.kind == SampleAttackParams::Kind::recording) {
        auto currents = read_currents(config, rate_hz);
        if (!currents) {
            return std::unexpected{currents.error()};
        }
        p.recording = std::move(*currents);
    }
    p.delay = std::max<std::int64_t>(std::llround(config.replay_s.to_double() * rate_hz), 1);
    return SampleAttack::create(std::move(p), seed);
}

} // namespace gridspace::attacker
