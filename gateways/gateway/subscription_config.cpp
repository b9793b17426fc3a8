// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/subscription_config.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::gateways {

void describe(config::Fields& f, std::vector<SubscriptionConfig>& subscriptions) {
    f.map("subscriptions", {.doc = "streams that are heard and supervised (LGOS, LSVS), as signals"},
          [&](Ref const& name, config::Fields& s) {
              SubscriptionConfig out;
              out.name = out.stream = name;
              s.reference("stream", out.stream, {.doc = "stream of `streams:`; the name when not given"});
              s.flag("accept_test", out.accept_test,
                     {.doc = "take messages that are marked as simulated, instead of real ones"});
              s.references("watch", out.watch,
                           {.doc = "members of the data set that are published as signals, "
                                   "subscription.PROCESS.NAME.value.MEMBER"});
              subscriptions.push_back(std::move(out));
          });
}

bool can_be_watched(iec61850::BasicType type) {
    return iec61850::is_number(type) || type == iec61850::BasicType::boolean || type == iec61850::BasicType::position ||
           type == iec61850::BasicType::enumerated;
}

void check_subscriptions(std::vector<SubscriptionConfig> const& subscriptions,
                         std::vector<streams::Stream> const& streams, config::Diagnostics& diagnostics) {
    std::vector<std::string> names;
    for (streams::Stream const& s : streams) {
        names.push_back(s.name.name);
    }
    auto const error = [&](Ref const& at, std::string message, std::string hint) {
        diagnostics.error(at.where, std::move(message), std::move(hint), static_cast<int>(at.name.size()));
    };
    for (SubscriptionConfig const& one : subscriptions) {
        streams::Stream const* const stream = streams::find_stream(streams, one.stream.name);
        if (stream == nullptr) {
            error(one.stream, fmt::format("there is no stream '{}'", one.stream.name),
                  spelling_hint(one.stream.name, names, "`streams:` declares none"));
            continue;
        }
        auto const leaves = stream->broken ? std::vector<iec61850::Leaf>{} : iec61850::leaves_of(stream->data_set);
        for (Ref const& member : stream->broken ? std::vector<Ref>{} : one.watch) {
            auto const found = std::find_if(leaves.begin(), leaves.end(),
                                            [&](iec61850::Leaf const& leaf) { return leaf.name == member.name; });
            if (found == leaves.end()) {
                std::vector<std::string> all;
                for (iec61850::Leaf const& leaf : leaves) {
                    all.push_back(leaf.name);
                }
                error(member, fmt::format("stream '{}' has no member '{}'", stream->name.name, member.name),
                      spelling_hint(member.name, all));
            } else if (!can_be_watched(found->type)) {
                error(member,
                      fmt::format("'{}' is {}: a signal is a number", member.name, iec61850::type_name(found->type)),
                      "its quality is in `quality` already");
            }
        }
    }
}

std::vector<program::Signal> subscription_signals(SubscriptionConfig const& config, streams::Stream const& stream) {
    std::string const prefix = "subscription.{process}." + config.name.name + ".";
    std::vector<program::Signal> out;
    for (char const* name : {"alive", "simulated", "needs_commissioning", "problem", "conf_rev"}) {
        out.push_back({prefix + name, ""});
    }
    out.push_back({prefix + (stream.kind == streams::Kind::goose ? "st_num" : "synch"), ""});
    out.push_back({prefix + "quality", ""});
    for (Ref const& member : config.watch) {
        out.push_back({prefix + "value." + member.name, ""});
    }
    return out;
}

std::vector<std::size_t> watched_leaves(SubscriptionConfig const& config, streams::Stream const& stream) {
    std::vector<std::size_t> out;
    auto const leaves = iec61850::leaves_of(stream.data_set);
    for (Ref const& member : config.watch) {
        auto const found = std::find_if(leaves.begin(), leaves.end(),
                                        [&](iec61850::Leaf const& leaf) { return leaf.name == member.name; });
        out.push_back(static_cast<std::size_t>(found - leaves.begin()));
    }
    return out;
}

} // namespace gridspace::gateways
