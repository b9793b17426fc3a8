// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/link/link_config.hpp"

#include "common/text.hpp"

#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

void describe_impairments(config::Fields& f, Impairments& i) {
    f.flag("up", i.up, {.doc = "false: nothing passes"});
    f.number("loss_percent", i.loss_percent, {.doc = "share of the frames that are lost", .min = 0, .max = 100});
    f.number("loss_burst", i.loss_burst, {.doc = "so many in a row", .min = 1, .max = 1e6});
    f.number("to_bad_percent", i.to_bad_percent,
             {.doc = "Gilbert-Elliott: chance, at each frame, that a good line turns bad", .min = 0, .max = 100});
    f.number("to_good_percent", i.to_good_percent, {.doc = "and that a bad one turns good", .min = 0, .max = 100});
    f.number("bad_loss_percent", i.bad_loss_percent,
             {.doc = "share of the frames that a bad line loses", .min = 0, .max = 100});
    f.number("delay_us", i.delay_us,
             {.doc = "delay of every frame; in lockstep rounded up to the time grid", .min = 0, .max = 1e9});
    f.number("jitter_us", i.jitter_us,
             {.doc = "added to the delay, uniform from 0; the order stays", .min = 0, .max = 1e9});
    f.number("rate_mbps", i.rate_mbps, {.doc = "megabits per second; 0: no limit", .min = 0});
    f.number("queue_ms", i.queue_ms,
             {.doc = "with a rate: frames that would wait for longer are lost", .min = 0, .max = 1e6});
    f.number("duplicate_percent", i.duplicate_percent,
             {.doc = "share of the frames that come twice", .min = 0, .max = 100});
    f.number("duplicate_after_us", i.duplicate_after_us,
             {.doc = "how much later the second one comes", .min = 0, .max = 1e9});
    f.number("reorder_percent", i.reorder_percent,
             {.doc = "share of the frames that are overtaken", .min = 0, .max = 100});
    f.number("reorder_by", i.reorder_by, {.doc = "by so many later ones", .min = 1, .max = 1000});
    f.number("corrupt_percent", i.corrupt_percent,
             {.doc = "share of the frames in which bits are turned over", .min = 0, .max = 100});
    f.number("corrupt_bits", i.corrupt_bits,
             {.doc = "how many bits, anywhere behind the ethertype", .min = 1, .max = 1000});
}

} // namespace

void describe(config::Fields& f, LinkConfig& config) {
    using Direction = LinkConfig::Direction;
    using What = SampleImpairment::What;
    f.object("place", {.doc = "which cable", .required = true}, [&](config::Fields& p) {
        p.references("between", config.between, {.doc = "a host and one of its links", .required = true});
        if (p.has("between") && config.between.size() != 2) {
            p.error("between", "a host and a link expected", "for example between: [mu21, process_bus]");
        }
    });
    f.choice<Direction>(
        "direction", config.direction,
        {{"from_host", Direction::from_host}, {"to_host", Direction::to_host}, {"both", Direction::both}},
        {.doc = "frames that the host sends, those that it receives, or both"});
    f.references("only", config.streams,
                 {.doc = "streams that are impaired; when left out all frames of SMV and GOOSE, and IP of programs "
                         "in simulated time"});
    describe_impairments(f, config.impairments);
    f.map(
        "samples", {.doc = "what happens to single samples of an SMV stream"},
        [&](config::Ref const& name, config::Fields& s) {
            LinkConfig::NamedSample impairment;
            impairment.name = name;
            s.reference("stream", impairment.stream, {.doc = "the stream", .required = true});
            s.integer("index", impairment.impairment.first,
                      {.doc = "number of the first sample, counted from simulated time 0", .required = true, .min = 0});
            s.integer("count", impairment.impairment.count, {.doc = "how many samples", .min = 1});
            s.choice<What>("do", impairment.impairment.what,
                           {{"lose", What::lose},
                            {"delay", What::delay},
                            {"duplicate", What::duplicate},
                            {"corrupt", What::corrupt}},
                           {.doc = "what is done to the frames that hold them"});
            s.number(
                "delay_us", impairment.impairment.delay_us,
                {.doc = "delay: how much later; duplicate: how much later the second one comes", .min = 0, .max = 1e9});
            if (impairment.impairment.what == What::delay && !(impairment.impairment.delay_us > 0)) {
                s.error("delay_us", "it does not say by how much", "delay_us: 3000");
            }
            config.samples.push_back(std::move(impairment));
        });
}

ImpairmentPlan make_plan(LinkConfig const& config, std::vector<streams::Stream> const& declared,
                         config::Diagnostics& diagnostics) {
    ImpairmentPlan plan;
    plan.first = config.impairments;
    std::vector<std::string> names;
    for (streams::Stream const& s : declared) {
        plan.marks.push_back(
            {s.name.name, s.ethertype(), s.address.app_id, s.address.destination, s.rate_hz.to_double()});
        names.push_back(s.name.name);
    }
    auto const find = [&](config::Ref const& ref, bool smv) -> std::optional<std::size_t> {
        for (std::size_t i = 0; i < declared.size(); ++i) {
            if (declared[i].name != ref) {
                continue;
            }
            if (smv && declared[i].kind != streams::Kind::smv) {
                diagnostics.error(ref.where, fmt::format("stream '{}' has no samples", ref.name),
                                  "expected one of kind smv", static_cast<int>(ref.name.size()));
                return std::nullopt;
            }
            return i;
        }
        diagnostics.error(ref.where, fmt::format("there is no stream '{}'", ref.name), spelling_hint(ref.name, names),
                          static_cast<int>(ref.name.size()));
        return std::nullopt;
    };
    for (config::Ref const& ref : config.streams) {
        if (auto const i = find(ref, false)) {
            plan.only.push_back(*i);
        }
    }
    for (LinkConfig::NamedSample const& entry : config.samples) {
        if (auto const i = find(entry.stream, true)) {
            plan.samples.push_back(entry.impairment);
            plan.samples.back().stream = *i;
        }
    }
    return plan;
}

} // namespace gridspace::gateways
