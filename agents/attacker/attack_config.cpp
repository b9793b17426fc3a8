// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/attack_config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::attacker {
namespace {

using Kind = SampleAttackParams::Kind;

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
    if (v.object("masquerade", {.doc = "a fault that is not there"}, [&](config::Fields& m) {
            m.number("peak_a", s.peak_a, {.doc = "crest of its current", .required = true});
            m.number("angle_deg", s.angle_deg, {.doc = "at its start, phase a"});
            m.number("tau_s", s.tau_s, {.doc = "time constant of the offset", .above = 0});
        })) {
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
                "one of uniform_a, bias_a, factor, ramp_per_cycle, replay_s, freeze, masquerade");
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

void describe_attack(config::Fields& f, AttackConfig& a) {
    using Spacing = SampleAttackParams::Spacing;
    f.reference("by", a.by, {.doc = "the attacker process", .required = true});
    f.object("place", {.doc = "where it sits: between a host and a link, or beside the publisher"},
             [&](config::Fields& p) {
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
             });
    f.object("target", {.doc = "what is attacked", .required = true}, [&](config::Fields& t) {
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
    });
    f.object("window", {.doc = "when", .required = true}, [&](config::Fields& w) {
        w.fraction("from_s", a.from_s, {.doc = "simulated time of its start", .required = true, .min = 0});
        w.fraction("until_s", a.until_s, {.doc = "and of its end", .required = true, .above = 0});
        if (w.has("from_s") && w.has("until_s") && a.until_s <= a.from_s) {
            w.error("until_s", "it must be after from_s");
        }
    });
    f.object("samples", {.doc = "which samples of the window; all when left out"}, [&](config::Fields& s) {
        s.choice<Spacing>("spacing", a.samples.spacing, {{"every", Spacing::every}, {"random", Spacing::random}},
                          {.doc = "every sample, or count single ones"});
        s.integer("count", a.samples.count, {.doc = "random: how many", .min = 1});
        s.integer("min_gap", a.samples.min_gap, {.doc = "random: samples from one to the next at least", .min = 1});
        if (a.samples.spacing == Spacing::random && !s.has("count")) {
            s.error("count", "random spacing needs it");
        }
    });
    bool const value =
        f.object("value", {.doc = "attacks on values"}, [&](config::Fields& v) { describe_value(v, a); });
    bool const goose = f.object("message", {.doc = "attacks on GOOSE messages"}, [&](config::Fields& g) {
        a.goose.emplace();
        describe_goose(g, *a.goose);
    });
    if (value == goose && !(f.has("value") && f.has("message"))) {
        f.error("", "it does not say what is done", "give `value` (samples) or `message` (GOOSE)");
    } else if (value && goose) {
        f.error("message", "an attack has either `value` or `message`");
    }
}

} // namespace

std::string_view kind_name(AttackConfig const& config) {
    if (config.goose) {
        return std::find_if(kGooseKinds.begin(), kGooseKinds.end(),
                            [&](auto const& k) { return k.second == config.goose->kind; })
            ->first;
    }
    constexpr std::array<std::string_view, 7> kNames{"random", "bias",   "scale",     "ramp",
                                                     "replay", "freeze", "masquerade"};
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
    p.delay = std::max<std::int64_t>(std::llround(config.replay_s.to_double() * rate_hz), 1);
    return SampleAttack::create(std::move(p), seed);
}

} // namespace gridspace::attacker
